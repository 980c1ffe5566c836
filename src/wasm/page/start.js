// Puts a damper wherever the page has a place for one, as [data-damper], whose value is {parameters, amplitude} as JSON. The
// address may carry parameters: #mass_ratio=0.1&x0=3, where a page has several behind the place's id, #damper-1&x0=3.
// The worker is made of what the page holds: nothing is asked for outside, so it works from a folder.
let simulator; // one worker, when it is first needed
function simulate(scene, options) {
  simulator ??= startWorker("damper-worker", () => ({ module: bytesOf("damper-module") }));
  return simulator({ scene, options });
}

const linked = Object.fromEntries(new URLSearchParams(location.hash.slice(1)));
const isLinked = (place) => place.id === "" || place.id in linked;
function openDamper(place) {
  const begin = JSON.parse(place.dataset.damper);
  const given = isLinked(place) ? linked : {};
  mountDamper(place, simulate, { ...begin, parameters: { ...begin.parameters, ...given } });
}

for (const place of document.querySelectorAll("[data-damper]")) {
  if (textOf("damper-module") === "") place.remove(); // made without the module
  else if (place.matches("main")) openDamper(place);
  else if (isLinked(place)) {
    openDamper(place);
    place.scrollIntoView();
  } else openByButton(place, openDamper);
}
