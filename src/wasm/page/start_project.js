// Puts checks and the form for one's own damper, [data-own] with its first scene as JSON, where the page has places for them;
// a page that was made without the program has none.
const startProgram = () =>
  startWorker("project-worker", () => ({ program: bytesOf("project-program"), archive: bytesOf("project-archive") }));

const isThere = textOf("project-program") !== "";
if (isThere) {
  let checking; // one worker, when it is first needed
  offerChecks((request, tell) => (checking ??= startProgram())(request, tell));
}
for (const place of document.querySelectorAll("[data-own]")) {
  const openOwn = () => mountOwn(place, startProgram, JSON.parse(place.dataset.own));
  if (!isThere) place.remove();
  else if (place.matches("main")) openOwn();
  else openByButton(place, openOwn);
}
