// The form for one's own damper, and the page that the program writes about it (impact-damper report), made in the reader's
// browser.

const ownFields = [
  { key: "description", words: "description" },
  { key: "mass", words: "primary mass", unit: "kg" },
  { key: "stiffness", words: "stiffness of its spring", unit: "N/m" },
  { key: "damping_ratio", words: "damping ratio", unit: "" },
  { key: "secondary_mass", words: "secondary mass", unit: "kg" },
  { key: "clearance", words: "clearance, both sides together", unit: "mm" },
  { key: "restitution", words: "coefficient of restitution", unit: "" },
  { key: "contact_stiffness", words: "stiffness of a wall", unit: "N/m" },
  { key: "initial_displacement", words: "released at", unit: "mm" },
  { key: "exciting_force", words: "exciting force", unit: "N" },
  { key: "exciting_frequency", words: "its frequency", unit: "Hz" },
  { key: "until_millimetres", words: "ends below amplitude", unit: "mm" },
  { key: "until_seconds", words: "ends after", unit: "s" },
];

/**
 * Puts the form and the page about its scene into `place`. start() gives a function ask({ report: { name, scene } }) with a
 * promise of { page }, and ask.end(), as startWorker does. The form begins with `scene`, a scene file's content.
 */
function mountOwn(place, start, { name: firstName, scene: firstScene }) {
  const name = make("input", { value: firstName, "aria-label": "name" });
  const fields = ownFields.map(({ key, words, unit }) => {
    const number = unit !== undefined;
    const input = make("input", { "aria-label": words + (unit ? `, ${unit}` : ""), ...(number && { inputmode: "decimal" }) });
    return { key, words, number, input, element: make("label", number ? {} : { class: "text" }, make("span", {}, words), input, ...(number ? [make("small", {}, unit)] : [])) };
  });
  const chosen = make("input", { type: "file", accept: ".json", "aria-label": "open a scene file" });
  const sceneLink = make("a", {}, "Save the scene");
  const pageLink = make("a", {}, "Save the page");
  const further = make("p", { class: "pale" });
  const status = make("p", { role: "status" });
  const problem = make("p", { role: "alert", class: "problem" });
  const frame = make("iframe", { title: "The page about this scene" });
  place.classList.add("own");
  place.replaceChildren(
    make("div", { class: "fields" }, make("label", { class: "text" }, make("span", {}, "name"), name), ...fields.map(({ element }) => element)),
    further,
    make("p", {}, make("label", {}, "Open a scene file: ", chosen), " ", sceneLink, " ", pageLink),
    problem, status, frame);

  let scene; // what the scene's file says, as an object
  let text; // the file itself
  let ask = start();
  let working = false;
  let newest = 0; // number of the newest request

  const offer = (link, file, type, content) => {
    URL.revokeObjectURL(link.href);
    link.href = URL.createObjectURL(new Blob([content], { type }));
    link.download = file;
    link.hidden = false;
  };
  const mark = (input, wrong) => (wrong ? input.setAttribute("aria-invalid", "true") : input.removeAttribute("aria-invalid"));

  // The name of the scene's file, or what is wrong with it.
  function fileName() {
    const stem = name.value.trim().replace(/\.json$/, "") || "my damper";
    const wrong = /[/\\\x00-\x1f]/.test(stem) || stem.startsWith(".");
    mark(name, wrong);
    return wrong ? { wrong: `name: must be that of a file, without a slash, got '${stem}'` } : { stem };
  }

  // The page below is not of the scene in the form any more, and nothing else is offered as such.
  function becomeStale() {
    if (frame.srcdoc) place.dataset.stale = "";
    pageLink.hidden = true;
  }

  function reject(words) {
    working = false;
    ++newest;
    becomeStale();
    problem.textContent = words;
    status.textContent = frame.srcdoc ? "The page below is that of the scene before the last change." : "";
    place.removeAttribute("aria-busy");
  }

  // The program's message, with the fields' words in place of the file's keys; marks the fields that it is about.
  function inWordsOfForm(message, file) {
    return message.split("\n").map((line) => {
      const field = fields.find(({ key }) => line.startsWith(`${file}: /${key}: `));
      if (!field) return line;
      mark(field.input, true);
      return line.replace(`${file}: /${field.key}: `, `${field.words} (${field.key}): `);
    }).join("\n");
  }

  async function renew() {
    const { stem, wrong } = fileName();
    if (wrong) return reject(wrong);
    offer(sceneLink, `${stem}.json`, "application/json", text);
    if (working) { // with what nobody wants any more
      ask.end();
      ask = start();
    }
    const number = ++newest;
    working = true;
    becomeStale();
    problem.textContent = "";
    place.setAttribute("aria-busy", "true");
    const begin = performance.now();
    const what = Number(scene.exciting_force) ? "its response over frequency, some ten seconds" : "fifteen scenes like it";
    const tell = () => {
      if (number === newest && working) status.textContent = `Simulating the scene and ${what}: ${Math.round((performance.now() - begin) / 1000)} s`;
    };
    tell();
    const clock = setInterval(tell, 1000);
    try {
      const { page } = await ask({ report: { name: `${stem}.json`, scene: text } });
      if (number !== newest) return;
      const shown = new Promise((resolve) => frame.addEventListener("load", resolve, { once: true }));
      frame.srcdoc = page;
      await shown;
      if (number !== newest) return;
      delete place.dataset.stale;
      offer(pageLink, `${stem}.html`, "text/html", page);
      status.textContent = "Simulated by the program itself. Save the scene, and impact-damper report --scene writes the same page, with figures.";
      working = false;
      place.removeAttribute("aria-busy");
    } catch (error) {
      if (number === newest) reject(inWordsOfForm(error.message, `${stem}.json`));
    } finally {
      clearInterval(clock);
    }
  }

  function edited({ key, words, number, input }) {
    const given = input.value.trim();
    const value = number ? Number(given) : given;
    const wrong = number && !Number.isFinite(value);
    mark(input, wrong);
    if (wrong) return reject(`${words}: must be a number such as 0.002, got '${given}'`);
    if (given === "") delete scene[key];
    else scene[key] = value;
    text = `${JSON.stringify(scene, null, 2)}\n`;
    show();
  }

  // The form shows the scene's file as far as it has fields for it.
  function show() {
    for (const { key, input } of fields) {
      mark(input, false);
      if (document.activeElement !== input) input.value = scene[key] ?? "";
    }
    const others = Object.keys(scene).filter((key) => !ownFields.some((field) => field.key === key));
    further.textContent = others.length ? `Also in the scene's file, and without a field here: ${others.join(", ")}.` : "";
    renew();
  }

  function open(content) {
    text = content;
    try {
      const read = JSON.parse(content);
      scene = read && typeof read === "object" && !Array.isArray(read) ? read : {};
    } catch {
      scene = {}; // the program says what is wrong with it
    }
    show();
  }

  fields.forEach((field) => field.input.addEventListener("change", () => edited(field)));
  name.addEventListener("change", renew);
  chosen.addEventListener("change", async () => {
    const file = chosen.files[0];
    if (!file) return;
    name.value = file.name.replace(/\.json$/, "");
    open(await file.text());
    chosen.value = ""; // the same file may be opened again
  });
  frame.addEventListener("load", () => {
    const { body } = frame.contentDocument;
    // As a document within this one its links to itself would lead to this page.
    body.addEventListener("click", (event) => {
      const link = event.target.closest?.('a[href^="#"]');
      if (!link) return;
      event.preventDefault();
      frame.contentDocument.getElementById(link.getAttribute("href").slice(1))?.scrollIntoView();
    });
    new ResizeObserver(() => (frame.style.height = `${Math.ceil(body.getBoundingClientRect().height) + 40}px`)).observe(body);
  });
  open(`${JSON.stringify(firstScene, null, 2)}\n`);
}
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
