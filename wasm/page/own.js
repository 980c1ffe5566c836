// "My damper": the page that the program writes about one's own scene (impact-damper report), made in the reader's browser.

const ownFields = [
  ["mass", "vibrating mass", "kg"],
  ["stiffness", "stiffness of its spring", "N/m"],
  ["damping_ratio", "damping ratio", ""],
  ["secondary_mass", "loose mass", "kg"],
  ["clearance", "clearance, both sides together", "mm"],
  ["restitution", "coefficient of restitution", ""],
  ["contact_stiffness", "stiffness of a wall", "N/m"],
  ["initial_displacement", "released at", "mm"],
  ["exciting_force", "exciting force", "N"],
  ["exciting_frequency", "its frequency", "Hz"],
  ["until_millimetres", "ends below amplitude", "mm"],
  ["until_seconds", "ends after", "s"],
];

/**
 * Puts a form and the page about its scene into `place`. `ask({ report: { name, scene } })` gives a promise of { page }.
 * It begins with `scene`, a scene file's content.
 */
function mountOwn(place, ask, { name: begun, scene: given }) {
  let scene = { ...given };
  let text = ""; // of the scene's file
  const name = make("input", { value: begun, "aria-label": "name" });
  const fields = ownFields.map(([key, words, unit]) => {
    const input = make("input", { type: "number", step: "any", "aria-label": words + (unit && `, ${unit}`) });
    input.addEventListener("change", () => {
      if (input.value === "") delete scene[key];
      else scene[key] = Number(input.value);
      written();
    });
    return { key, input, element: make("label", {}, make("span", {}, words), input, make("small", {}, unit)) };
  });
  const chosen = make("input", { type: "file", accept: ".json", "aria-label": "open a scene file" });
  const sceneLink = make("a", {}, "Save the scene");
  const pageLink = make("a", {}, "Save the page");
  const told = make("p", { role: "status" });
  const problem = make("p", { role: "alert", class: "problem" });
  const frame = make("iframe", { title: "The page about this scene" });
  place.classList.add("own");
  place.replaceChildren(
    make("div", { class: "fields" }, make("label", {}, make("span", {}, "name"), name), ...fields.map(({ element }) => element)),
    make("p", {}, make("label", {}, "Open a scene file: ", chosen), " ", sceneLink, " ", pageLink),
    problem, told, frame);

  const offer = (link, file, type, content) => {
    URL.revokeObjectURL(link.href);
    link.href = URL.createObjectURL(new Blob([content], { type }));
    link.download = file;
  };

  // The last request counts: what is asked for while the worker works waits, and only the newest of it.
  let asked = false;
  let waiting;
  async function renew() {
    waiting = { name: `${name.value}.json`, scene: text };
    if (asked) return;
    asked = true;
    place.setAttribute("aria-busy", "true");
    while (waiting) {
      const report = waiting;
      waiting = undefined;
      told.textContent = "simulating the scene and fifteen others like it";
      try {
        const { page } = await ask({ report });
        problem.textContent = "";
        frame.srcdoc = page;
        offer(pageLink, `${name.value}.html`, "text/html", page);
        told.textContent = "The page below is the one that impact-damper report --without-figures writes, to the last byte.";
      } catch (error) {
        problem.textContent = error.message;
        told.textContent = "";
      }
    }
    place.removeAttribute("aria-busy");
    asked = false;
  }

  function opened(content) {
    text = content;
    try {
      scene = JSON.parse(content);
    } catch {
      scene = {}; // the program says what is wrong with it
    }
    fields.forEach(({ key, input }) => (input.value = scene[key] ?? ""));
    offer(sceneLink, `${name.value}.json`, "application/json", text);
    renew();
  }
  const written = () => opened(`${JSON.stringify(scene, null, 2)}\n`);

  name.addEventListener("change", () => opened(text));
  chosen.addEventListener("change", async () => {
    name.value = chosen.files[0].name.replace(/\.json$/, "");
    opened(await chosen.files[0].text());
  });
  frame.addEventListener("load", () => (frame.style.height = `${frame.contentDocument.documentElement.scrollHeight + 20}px`));
  written();
}
