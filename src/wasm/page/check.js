// "Check": tables and verdicts are made anew in the reader's browser (project.js), and their SHA-256 stands beside the
// cited one. A figure names its table and its hash in data-table and data-sha256, a claim's row in data-sha256.

/** Puts a button below each such figure, in each such row, and for all of them into [data-check-all]. ask: of startWorker. */
function offerChecks(ask) {
  // While it works it is no button, but keeps the focus.
  const button = (words, press) => {
    const made = make("button", { type: "button" }, words);
    made.addEventListener("click", async () => {
      if (made.ariaDisabled === "true") return;
      made.ariaDisabled = "true";
      await press();
      made.ariaDisabled = "false";
    });
    return made;
  };
  // state: working, equal, different, failed
  const say = (output, state, words) => {
    output.dataset.state = state;
    output.textContent = words;
    output.removeAttribute("title");
  };
  // Under a figure the hashes have all their digits, in the table of claims their first ones.
  const compare = (output, here, cited, digits = 64) => {
    const state = here === cited ? "equal" : "different";
    say(output, state, `${state}: SHA-256 here ${here.slice(0, digits)}, cited ${cited.slice(0, digits)}`);
    output.title = `SHA-256 here ${here}, cited ${cited}`;
  };
  const working = ({ done, count, command }) => {
    const words = `command ${done + 1} of ${count}: impact-damper ${command}`;
    return words.length > 90 ? `${words.slice(0, 89)}…` : words;
  };

  // check(tell, request) compares what is made for the request, and returns what went wrong, if anything did.
  const figures = [...document.querySelectorAll("figure[data-table]")].map((figure) => {
    const { table, sha256 } = figure.dataset;
    const output = make("output");
    const check = async (tell, { anew }) => {
      say(output, "working", "waiting");
      try {
        compare(output, (await ask({ table, anew }, (progress) => tell(working(progress)))).sha256, sha256);
      } catch (error) {
        say(output, "failed", error.message);
      }
    };
    const alone = button("Make this table anew here", () => check((words) => say(output, "working", words), { anew: true }));
    figure.querySelector("figcaption").append(make("p", { class: "check" }, alone, " ", output));
    return { name: `table of ${figure.id.replace("figure-", "Figure ")}`, output, check };
  });

  const claims = [...document.querySelectorAll("tr[data-sha256]")].map((row) => ({ row, id: row.id.replace("claim-", ""), output: make("output") }));
  const checkClaims = async (some, tell, { anew }) => {
    some.forEach(({ output }) => say(output, "working", "waiting"));
    try {
      const { sha256 } = await ask({ claims: some.map(({ id }) => id), anew }, (progress) => tell(working(progress)));
      some.forEach(({ id, output, row }) => compare(output, sha256[id], row.dataset.sha256, 8));
    } catch (error) {
      some.forEach(({ output }) => say(output, "failed", error.message));
    }
  };
  for (const claim of claims) {
    const alone = button("check", () => checkClaims([claim], (words) => say(claim.output, "working", words), { anew: true }));
    alone.setAttribute("aria-label", `check ${claim.id}`);
    claim.row.lastElementChild.append(make("span", { class: "check" }, alone, " ", claim.output));
  }

  for (const place of document.querySelectorAll("[data-check-all]")) {
    const bar = make("progress", { max: figures.length + 1, value: 0, "aria-label": "checked" });
    const output = make("output");
    const all = async () => {
      const begin = performance.now();
      for (const [done, { name, check }] of figures.entries()) {
        bar.value = done;
        await check((words) => say(output, "working", `${name}, ${words}`), { anew: done === 0 });
      }
      bar.value = figures.length;
      await checkClaims(claims, (words) => say(output, "working", `verdicts, ${words}`), { anew: false });
      bar.value = figures.length + 1;
      const equal = (list) => list.filter((each) => each.output.dataset.state === "equal").length;
      const whole = equal(figures) === figures.length && equal(claims) === claims.length;
      say(output, whole ? "equal" : "different", `${equal(figures)} of ${figures.length} tables and ${equal(claims)} of ` +
        `${claims.length} verdicts are the cited ones, byte for byte; made here in ${Math.round((performance.now() - begin) / 1000)} s`);
    };
    place.append(button(`Check all: ${figures.length} tables and ${claims.length} verdicts`, all), " ", bar, " ", output);
  }
}
