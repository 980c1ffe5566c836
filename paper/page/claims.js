// The table of claims: sorted by a click on a column's head, filtered by verdict.
"use strict";

for (const table of document.querySelectorAll(".claims table")) {
  const body = table.tBodies[0], rows = [...body.rows];
  const key_of = (row, column) => {
    const {textContent: text, dataset: {value}} = row.cells[column];
    const number = parseFloat(value ?? (/^[-−.\d]/.test(text) ? text.replace("−", "-") : ""));
    return Number.isNaN(number) ? [1, 0, text] : [0, number, text];
  };
  const compare = (a, b) => a[0] - b[0] || a[1] - b[1] || a[2].localeCompare(b[2], "en");
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = head.textContent;
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      for (const each of table.tHead.rows[0].cells) each.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const sorted = rows.map(row => [key_of(row, column), row]).sort((a, b) => compare(a[0], b[0]));
      body.append(...(down ? sorted.reverse() : sorted).map(([, row]) => row));
    });
  });

  const buttons = table.closest(".claims").querySelectorAll(".switches button");
  const show = chosen => {
    for (const each of buttons) each.setAttribute("aria-pressed", String(each === chosen));
    for (const row of rows) {
      row.hidden = Boolean(chosen.dataset.verdict) && !row.querySelector(`td.${chosen.dataset.verdict}`);
    }
  };
  for (const button of buttons) button.addEventListener("click", () => show(button));
  // A link to a claim that is filtered away shows it.
  addEventListener("hashchange", () => {
    if (document.querySelector(":target")?.hidden) show(buttons[0]);
  });
}
