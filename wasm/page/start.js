// Puts a damper wherever the page has a place for one, as [data-damper], whose value is {parameters, amplitude} as JSON. The
// address may carry parameters: #mass_ratio=0.1&x0=3, where a page has several behind the place's id, #damper-1&x0=3.
// The worker is made of what the page holds: nothing is asked for outside, so it works from a folder.

function startSimulating() {
  const text = (id) => document.getElementById(id).textContent;
  const worker = new Worker(URL.createObjectURL(new Blob([text("damper-worker")], { type: "text/javascript" })));
  worker.postMessage({ module: Uint8Array.from(atob(text("damper-module")), (letter) => letter.charCodeAt(0)) });
  const asked = []; // answers come in the order of what was asked
  worker.onmessage = ({ data }) => {
    const { resolve, reject } = asked.shift();
    if (data.run) resolve(data.run);
    else reject(new Error(data.error));
  };
  worker.onerror = (event) => asked.splice(0).forEach(({ reject }) => reject(new Error(event.message)));
  return (scene, options) =>
    new Promise((resolve, reject) => {
      asked.push({ resolve, reject });
      worker.postMessage({ scene, options });
    });
}

let simulateHere; // one worker, when it is first needed
const linked = Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
const isLinked = (place) => place.id === "" || place.id in linked;
function open(place) {
  const begin = JSON.parse(place.dataset.damper);
  const given = isLinked(place) ? linked : {};
  mountDamper(place, (simulateHere ??= startSimulating()), { ...begin, parameters: { ...begin.parameters, ...given } });
}

for (const place of document.querySelectorAll("[data-damper]")) {
  if (document.getElementById("damper-module").textContent.trim() === "") place.remove(); // made without the module
  else if (place.matches("main")) open(place);
  else if (isLinked(place)) {
    open(place);
    place.scrollIntoView();
  } else {
    const button = make("button", { type: "button", class: "open-damper" }, place.dataset.words);
    button.addEventListener("click", () => open(place));
    place.append(button);
  }
}
