// Puts checks and the form for one's own damper, [data-own] with its first scene as JSON, where the page has places for them;
// a page that was made without the program has none.
if (document.getElementById("project-program").textContent.trim() !== "") {
  let started; // one worker, when it is first needed
  const ask = (request, tell) => (started ??= startProject())(request, tell);
  offerChecks(ask);
  for (const place of document.querySelectorAll("[data-own]")) {
    const open = () => mountOwn(place, ask, JSON.parse(place.dataset.own));
    if (place.matches("main")) open();
    else {
      const button = make("button", { type: "button", class: "open-damper" }, place.dataset.words);
      button.addEventListener("click", open);
      place.append(button);
    }
  }
} else document.querySelectorAll("[data-own]").forEach((place) => place.remove());
