// Makes the figures of a page answer: values under the cursor, curves to switch on and off. A figure is drawn by
// gnuplot and stands inline in <figure class="plot">; what its axes measure it says itself, in its <metadata>
// (figures/draw). Everything is read off the drawing, so a value is as fine as the picture: hundredths of a pixel.
"use strict";

// A stretch of x and y that the axes of one plot span: from the SVG's units to values and back.
function frame_of(axes, height) {
  const value = ([, low, high, from, to], at, logarithmic) => {
    const part = (at - from) / (to - from);
    return logarithmic ? low * (high / low) ** part : low + (high - low) * part;
  };
  const [left, right] = axes.x.slice(3), [bottom, top] = axes.y.slice(3).map(y => height - y);
  return {
    left, right, top, bottom,
    holds: ([x, y]) => left - 1 <= x && x <= right + 1 && top - 1 <= y && y <= bottom + 1,
    told: ([x, y]) => [
      [axes.x[0], value(axes.x, x, axes.log.includes("x"))],
      [axes.y[0], value(axes.y, height - y, axes.log.includes("y"))],
    ].map(([name, number]) => `${name} = ${rounded(number)}`).join(", "),
  };
}

function rounded(number) {
  return (Math.abs(number) < 1e-12 ? 0 : Number(number.toPrecision(3))).toString().replace("-", "−");
}

// What gnuplot draws of a curve: lines as chains of points, marks as chains of one. In a group with a legend entry
// the first line and the last mark are the legend's sample, which is no value.
function chains_of(element) {
  if (element.tagName === "use") {
    const place = element.getAttribute("transform")?.match(/translate\(([-\d.]+),([-\d.]+)\)/);
    return place ? [[[Number(place[1]), Number(place[2])]]] : [];
  }
  const text = element.getAttribute("d") ?? "";
  return text.split("M").slice(1).map(part => part.split("L").map(point => point.split(",").map(parseFloat)));
}

const colour_of = element => (element.getAttribute("color") ?? element.getAttribute("stroke") ??
                              element.getAttribute("fill") ?? "").replace(/\s/g, "");

// The curves by colour, in the order of the legend; a colour without an entry has no name and is not switched.
function curves_of(svg) {
  const curves = new Map();
  for (const group of svg.querySelectorAll("g[id*=gnuplot_plot_]")) {
    const name = group.querySelector(":scope > title")?.textContent;
    group.querySelector(":scope > title")?.remove();  // or the browser shows it beside the value
    const has_legend = Boolean(group.querySelector("text"));
    const samples = has_legend ? [group.querySelector("path"), [...group.querySelectorAll("use")].at(-1)] : [];
    for (const element of group.querySelectorAll("path, use, polygon")) {
      const colour = colour_of(element);
      if (!curves.has(colour)) curves.set(colour, {colour, name: "", elements: [], chains: []});
      const curve = curves.get(colour);
      curve.name ||= name ?? "";
      curve.elements.push(element);
      const chains = chains_of(element);
      if (samples.includes(element)) chains.shift();
      curve.chains.push(...chains);
    }
  }
  return [...curves.values()];
}

// The point of a chain nearest to `to`, and how far it is.
function nearest_on(chain, to) {
  let best = {distance: Infinity};
  chain.forEach((end, i) => {
    const begin = chain[Math.max(i - 1, 0)];
    const along = [end[0] - begin[0], end[1] - begin[1]], length = along[0] ** 2 + along[1] ** 2;
    const part = length ? ((to[0] - begin[0]) * along[0] + (to[1] - begin[1]) * along[1]) / length : 0;
    const at = Math.min(Math.max(part, 0), 1), point = [begin[0] + at * along[0], begin[1] + at * along[1]];
    const distance = Math.hypot(to[0] - point[0], to[1] - point[1]);
    if (distance < best.distance) best = {distance, point};
  });
  return best;
}

// A table in CSV, whole: in the page a row lacks its block and its curve where they are those of the row before, and its
// x where it is that of the same row of the block's first curve. A gap has no number at all.
function whole(table) {
  const row = /^("(?:[^"]|"")*"|[^",\n]*),("(?:[^"]|"")*"|[^",\n]*),([^,\n]*),(.*)$/gm;
  let block = "", curve = "", first = [], at = 0;
  return table.replace(row, (_, its_block, its_curve, x, rest) => {
    if (its_block && its_block !== block) first = [];
    if (its_block) [block, curve, at] = [its_block, its_curve, 0];
    if (at === first.length) first.push(x);
    const its_x = x || (rest === ",," ? "" : first[at]);
    ++at;
    return [block, curve, its_x, rest].join(",");
  });
}

// Below a figure that says its file's name: the drawing as it was made, and the table that stands in the page, to keep.
function offer(figure) {
  if (!figure.dataset.file) return;
  const links = document.createElement("p");
  links.className = "files";
  const link = (name, type, text) => {
    const a = links.appendChild(document.createElement("a"));
    a.download = a.textContent = name;
    a.href = URL.createObjectURL(new Blob([text], {type}));
  };
  const drawing = figure.querySelector("svg").cloneNode(true);
  const {width, height} = drawing.viewBox.baseVal;
  drawing.setAttribute("width", width);
  drawing.setAttribute("height", height);
  link(figure.dataset.file, "image/svg+xml", new XMLSerializer().serializeToString(drawing));
  const table = figure.querySelector("script[data-file]");
  if (table) link(table.dataset.file, table.type, whole(table.textContent.replace(/^\n/, "")));
  figure.querySelector("figcaption").append(links);
}

function enliven(figure) {
  const svg = figure.querySelector("svg");
  const {axes} = JSON.parse(svg.querySelector("metadata").textContent);
  if (!axes.length) return;
  const frames = axes.map(each => frame_of(each, svg.viewBox.baseVal.height));
  const curves = curves_of(svg);
  const off = new Set();
  const shown = () => curves.filter(curve => !off.has(curve));

  const make = (name, attributes) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return svg.appendChild(element);
  };
  const mark = make("circle", {r: 6, class: "mark", visibility: "hidden"});
  const reading = figure.querySelector(".drawing").appendChild(document.createElement("output"));
  reading.className = "reading";

  const tell = (text, point) => {
    mark.setAttribute("visibility", point ? "visible" : "hidden");
    if (point) {
      mark.setAttribute("cx", point[0]);
      mark.setAttribute("cy", point[1]);
      const {width, height} = svg.viewBox.baseVal;
      // On that side of the point where there is more room of what is in sight: a narrow window shows a part.
      const box = svg.parentNode, at = point[0] / width * svg.clientWidth;
      const right = at - box.scrollLeft > box.clientWidth / 2;
      reading.style.left = `${right ? at - 8 : at + 8}px`;
      reading.style.top = `${point[1] / height * svg.clientHeight}px`;
      reading.style.transform = `translate(${right ? "-100%" : "0"}, -50%)`;
    }
    reading.textContent = text;
  };

  const tell_near = to => {
    const frame = frames.find(each => each.holds(to));
    if (!frame) return tell("");
    let best = {distance: 24};
    for (const curve of shown()) {
      for (const chain of curve.chains) {
        const near = nearest_on(chain, to);
        if (near.distance < best.distance && frame.holds(near.point)) best = {...near, curve};
      }
    }
    if (best.curve) tell([best.curve.name, frame.told(best.point)].filter(Boolean).join(": "), best.point);
    else tell(frame.told(to), to);
  };
  svg.addEventListener("pointermove", event => {
    const {x, y} = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    tell_near([x, y]);
  });
  svg.addEventListener("pointerleave", () => tell(""));

  // The keyboard goes along a curve with left and right, from curve to curve with up and down.
  svg.tabIndex = 0;
  let chosen = 0, at = null;
  svg.addEventListener("keydown", event => {
    const step = {ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0]}[event.key];
    if (event.key === "Escape") tell("");
    if (!step) return;
    event.preventDefault();
    const followed = shown().filter(curve => curve.chains.some(chain => chain.some(p => frames.some(f => f.holds(p)))));
    if (!followed.length) return;
    chosen = (chosen + step[0] + followed.length) % followed.length;
    const points = followed[chosen].chains.flat().filter(p => frames.some(f => f.holds(p)))
                                   .sort((a, b) => a[0] - b[0]);
    const {left, right} = frames[0];
    at = Math.min(Math.max((at ?? left) + step[1] * (right - left) / 60, points[0][0]), points.at(-1)[0]);
    const point = points.reduce((best, p) => Math.abs(p[0] - at) < Math.abs(best[0] - at) ? p : best);
    const frame = frames.find(each => each.holds(point));
    tell([followed[chosen].name, frame.told(point)].filter(Boolean).join(": "), point);
  });
  svg.addEventListener("blur", () => tell(""));

  const named = curves.filter(curve => curve.name);
  if (named.length < 2) return;
  const switches = document.createElement("div");
  switches.className = "switches";
  switches.setAttribute("role", "group");
  switches.setAttribute("aria-label", "Curves shown");
  for (const curve of named) {
    const button = switches.appendChild(document.createElement("button"));
    button.type = "button";
    button.textContent = curve.name;
    button.style.setProperty("--curve", curve.colour);
    button.setAttribute("aria-pressed", "true");
    button.addEventListener("click", () => {
      if (off.has(curve)) off.delete(curve);
      else off.add(curve);
      button.setAttribute("aria-pressed", String(!off.has(curve)));
      for (const element of curve.elements) element.classList.toggle("off", off.has(curve));
      tell("");
    });
  }
  figure.querySelector(".drawing").after(switches);
}

document.querySelectorAll("figure.plot").forEach(figure => {
  offer(figure);
  enliven(figure);
});
