// Puts a damper wherever the page has a place for one, as [data-damper], whose value is {parameters, amplitude} as JSON.
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
const open = (place) => mountDamper(place, (simulateHere ??= startSimulating()), JSON.parse(place.dataset.damper));

for (const place of document.querySelectorAll("[data-damper]")) {
  if (document.getElementById("damper-module").textContent.trim() === "") place.remove(); // made without the module
  else if (place.matches("main")) open(place);
  else {
    const button = make("button", { type: "button", class: "open-damper" }, place.dataset.words);
    button.addEventListener("click", () => open(place));
    place.append(button);
  }
}
