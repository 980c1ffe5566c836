// "Check": tables and verdicts are made anew in the reader's browser (project.js), and their SHA-256 stands beside the
// cited one. A figure names its table and its hash in data-table and data-sha256, a claim's row in data-sha256.

/** Starts the worker; returns ask(request, tell), a promise of the answer. One request is worked on at a time. */
function startProject() {
  const text = (id) => document.getElementById(id).textContent;
  const bytes = (id) => Uint8Array.from(atob(text(id)), (letter) => letter.charCodeAt(0));
  const worker = new Worker(URL.createObjectURL(new Blob([text("project-worker")], { type: "text/javascript" })));
  worker.postMessage({ program: bytes("project-program"), archive: bytes("project-archive") });
  const asked = [];
  worker.onmessage = ({ data }) => {
    if (data.progress) asked[0].tell(data.progress);
    else if (data.error) asked.shift().reject(new Error(data.error));
    else asked.shift().resolve(data);
  };
  worker.onerror = (event) => asked.splice(0).forEach(({ reject }) => reject(new Error(event.message)));
  return (request, tell = () => {}) =>
    new Promise((resolve, reject) => {
      asked.push({ tell, resolve, reject });
      worker.postMessage(request);
    });
}

function offerChecks(ask) {
  const button = (words, press) => {
    const made = make("button", { type: "button" }, words);
    made.addEventListener("click", () => {
      made.disabled = true;
      press().finally(() => (made.disabled = false));
    });
    return made;
  };
  const say = (place, state, words) => {
    place.dataset.state = state;
    place.textContent = words;
  };
  // Under a figure the hashes have all their digits, in the table of claims their first ones.
  const compare = (place, here, cited, digits = 64) => {
    const state = here === cited ? "equal" : "different";
    place.title = `SHA-256 here ${here}, cited ${cited}`;
    say(place, state, `${state}: SHA-256 here ${here.slice(0, digits)}, cited ${cited.slice(0, digits)}`);
  };
  const working = ({ done, count, command }) => `command ${done + 1} of ${count}: impact-damper ${command}`.slice(0, 90);
  // What went wrong is told there, and is no equal hash.
  const failing = (places, work) => work.catch((error) => places.forEach((place) => say(place, "different", error.message)));

  const figures = [...document.querySelectorAll("figure[data-table]")].map((figure) => {
    const { table, sha256 } = figure.dataset;
    const told = make("output");
    const check = (tell) => failing([told], ask({ table }, (progress) => tell(working(progress)))
      .then((answer) => compare(told, answer.sha256, sha256)));
    const alone = button("Make this table anew here", () => check((words) => say(told, "working", words)));
    figure.querySelector("figcaption").append(make("p", { class: "check" }, alone, " ", told));
    return { name: `table of ${figure.id.replace("figure-", "Figure ")}`, told, check };
  });

  const claims = [...document.querySelectorAll("tr[data-sha256]")].map((row) => ({ row, id: row.id.replace("claim-", ""), told: make("output") }));
  const checkClaims = (some, tell) => failing(some.map(({ told }) => told), ask({ claims: some.map(({ id }) => id) }, (progress) => tell(working(progress)))
    .then(({ sha256 }) => some.forEach(({ id, told, row }) => compare(told, sha256[id], row.dataset.sha256, 8))));
  for (const claim of claims) {
    const alone = button("check", () => checkClaims([claim], (words) => say(claim.told, "working", words)));
    alone.setAttribute("aria-label", `check ${claim.id}`);
    claim.row.lastElementChild.append(make("span", { class: "check" }, alone, " ", claim.told));
  }

  for (const place of document.querySelectorAll("[data-check-all]")) {
    const bar = make("progress", { max: figures.length + 1, value: 0, "aria-label": "checked" });
    const told = make("output");
    const all = async () => {
      const begin = performance.now();
      for (const [done, { name, check }] of figures.entries()) {
        bar.value = done;
        await check((words) => say(told, "working", `${name}, ${words}`));
      }
      bar.value = figures.length;
      await checkClaims(claims, (words) => say(told, "working", `verdicts, ${words}`));
      bar.value = figures.length + 1;
      const equal = (list) => list.filter((each) => each.told.dataset.state === "equal").length;
      const whole = equal(figures) === figures.length && equal(claims) === claims.length;
      say(told, whole ? "equal" : "different", `${equal(figures)} of ${figures.length} tables and ${equal(claims)} of ` +
        `${claims.length} verdicts are the cited ones, byte for byte; made here in ${Math.round((performance.now() - begin) / 1000)} s`);
    };
    place.append(button(`Check all: ${figures.length} tables and ${claims.length} verdicts`, all), " ", bar, " ", told);
  }
}
