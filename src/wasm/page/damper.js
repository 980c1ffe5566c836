// An impact damper to play with: sliders, the decay, the loss factor, and the mass as it rattles in its cavity.
// Drawn with SVG by the few lines below: four drawings of one kind each need no library.

// Lengths are divided by the clearance, times by 1/Omega_n; a period is 2 pi.
const period = 2 * Math.PI;
const windowLength = 4 * period;
const samplesPerPeriod = 200;
const untilTime = 2000;
const untilAmplitude = 0.01;
const untilTimeForced = 150 * period;

const parameters = [
  { name: "mass_ratio", symbol: "ν", words: "mass ratio", from: 0.001, to: 1, logarithmic: true },
  { name: "restitution", symbol: "e", words: "restitution", from: 0.05, to: 0.95 },
  { name: "damping_ratio", symbol: "ζ", words: "damping ratio", from: 0, to: 0.05 },
  { name: "wall_stiffness", symbol: "k", words: "wall stiffness", from: 100, to: 100000, logarithmic: true },
  { name: "force_amplitude", symbol: "f₀", words: "force", from: 0, to: 0.05 },
  { name: "force_frequency", symbol: "ω", words: "its frequency", from: 0.5, to: 2, logarithmic: true },
  { name: "x0", symbol: "x₀", words: "release", from: 0.5, to: 20, logarithmic: true },
  // Those of the cavity, which a scene does not have where they are 0.
  { name: "friction", symbol: "φ", words: "friction", from: 0, to: 1, component: true },
  { name: "weight", symbol: "γ", words: "weight", from: 0, to: 1, component: true },
  { name: "drag", symbol: "d", words: "drag", from: 0, to: 2, component: true },
];

const presets = [
  { words: "ν = 2 %, e = 0.6", mass_ratio: 0.02, restitution: 0.6 },
  { words: "ν = 2 %, e = 0.4", mass_ratio: 0.02, restitution: 0.4 },
  { words: "ν = 2 %, e = 0.8", mass_ratio: 0.02, restitution: 0.8 },
  { words: "ν = 10 %, e = 0.6", mass_ratio: 0.1, restitution: 0.6 },
  { words: "ν = 2 %, e = 0.6, ζ = 0.8 %", mass_ratio: 0.02, restitution: 0.6, damping_ratio: 0.008 },
];
const usual = {
  mass_ratio: 0.02, restitution: 0.6, damping_ratio: 0, wall_stiffness: 10000, force_amplitude: 0, force_frequency: 1, x0: 6,
  friction: 0, weight: 0, drag: 0,
};

const rounded = (value, digits = 3) => String(Number(value.toPrecision(digits))).replace("-", "−");

const counted = (count, what) => `${count} ${what}${count === 1 ? "" : "s"}`;

// The last index with column[index] <= value, of an ascending column; -1 if there is none.
function lastAtMost(column, value) {
  let low = -1;
  let high = column.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (column[middle] <= value) low = middle;
    else high = middle;
  }
  return low;
}

// Axes with a curve and a mark. A logarithmic axis leaves out what is not positive.
class Plot {
  constructor({ title, x, y }) {
    Object.assign(this, { x, y, left: 52, right: 348, top: 12, bottom: 190 });
    this.curve = make("path", { class: "curve" });
    this.line = make("line", { class: "rule" });
    this.mark = make("circle", { class: "mark", r: 5 });
    this.ticks = make("g", { class: "ticks" });
    this.svg = make("svg", { viewBox: "0 0 360 230", role: "img", "aria-label": title }, this.ticks, this.line, this.curve, this.mark,
      make("text", { class: "axis", x: 200, y: 226, "text-anchor": "middle" }, x.words),
      make("text", { class: "axis", x: -101, y: 12, "text-anchor": "middle", transform: "rotate(-90)" }, y.words));
    this.element = make("figure", {}, make("figcaption", {}, title), this.svg);
  }

  part({ logarithmic, from, to }, value) {
    return logarithmic ? Math.log(value / from) / Math.log(to / from) : (value - from) / (to - from);
  }
  at(x, y) {
    return [this.left + this.part(this.x, x) * (this.right - this.left), this.bottom - this.part(this.y, y) * (this.bottom - this.top)];
  }
  valueAt(part) {
    const { logarithmic, from, to } = this.x;
    return logarithmic ? from * (to / from) ** part : from + part * (to - from);
  }

  ticksOf({ logarithmic, from, to }) {
    if (logarithmic) {
      const all = [];
      for (let power = Math.floor(Math.log10(from)); 10 ** power <= to; ++power) all.push(...[1, 2, 5].map((each) => each * 10 ** power));
      const inside = all.filter((each) => each >= from && each <= to * (1 + 1e-9));
      return inside.length > 6 ? inside.filter((each) => Math.log10(each) % 1 === 0) : inside;
    }
    const step = [1, 2, 5, 10].map((each) => each * 10 ** Math.floor(Math.log10((to - from) / 4))).find((each) => (to - from) / each <= 5);
    const all = [];
    for (let n = Math.ceil(from / step); n * step <= to * (1 + 1e-9); ++n) all.push(n * step);
    return all;
  }

  scale(x, y) {
    Object.assign(this.x, x);
    Object.assign(this.y, y);
    this.ticks.replaceChildren(
      make("rect", { x: this.left, y: this.top, width: this.right - this.left, height: this.bottom - this.top }),
      ...this.ticksOf(this.x).map((value) => make("text", { x: this.at(value, this.y.from)[0], y: this.bottom + 14, "text-anchor": "middle" }, rounded(value))),
      ...this.ticksOf(this.y).map((value) => make("text", { x: this.left - 5, y: this.at(this.x.from, value)[1] + 4, "text-anchor": "end" }, rounded(value))));
  }

  draw(xs, ys) {
    let path = "";
    let pen = "M";
    for (let i = 0; i < xs.length; ++i) {
      const inside = (!this.x.logarithmic || xs[i] > 0) && (!this.y.logarithmic || ys[i] > 0);
      if (inside) path += pen + this.at(xs[i], ys[i]).map((each) => each.toFixed(1)).join(" ");
      pen = inside ? "L" : "M";
    }
    this.curve.setAttribute("d", path);
  }

  show(element, attributes) {
    const valid = Object.values(attributes).every(Number.isFinite);
    element.style.display = valid ? "" : "none";
    if (valid) for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  }
  markAt(x, y) {
    const [cx, cy] = this.at(x, y);
    this.show(this.mark, { cx, cy });
  }
  ruleAt(y) {
    const height = this.at(this.x.from, y)[1];
    this.show(this.line, { x1: this.left, x2: this.right, y1: height, y2: height });
  }
}

// The primary mass on its spring, with the secondary mass in its cavity.
class Drawing {
  constructor() {
    this.spring = make("path", { class: "spring" });
    this.secondary = make("rect", { class: "secondary", y: 62, width: 24, height: 36, rx: 4 });
    this.walls = [-1, 1].map((side) => make("rect", { class: "wall", x: side < 0 ? -66 : 52, y: 48, width: 14, height: 64 }));
    this.primary = make("g", {}, make("rect", { class: "primary", x: -66, y: 34, width: 132, height: 92, rx: 3 }),
      make("rect", { class: "cavity", x: -52, y: 48, width: 104, height: 64 }), ...this.walls, this.secondary);
    this.svg = make("svg", { viewBox: "0 0 720 140", role: "img", "aria-label": "The primary mass on its spring, the secondary mass in its cavity" },
      make("line", { class: "ground", x1: 6, x2: 6, y1: 20, y2: 136 }), make("line", { class: "ground", x1: 6, x2: 714, y1: 130, y2: 130 }),
      this.spring, this.primary);
    this.note = make("figcaption");
    this.element = make("figure", { class: "motion" }, this.svg, this.note);
  }

  scale(amplitude) {
    this.unit = 230 / amplitude; // of x; of y it is the cavity's
    this.note.textContent = `Displacements are drawn at ${rounded(this.unit / 80, 2)} times the cavity's scale.`;
  }

  // y is 0 at the left wall and 1 at the right one.
  draw(x, y, struck) {
    const place = 390 + x * this.unit;
    this.primary.setAttribute("transform", `translate(${place.toFixed(2)} 0)`);
    this.secondary.setAttribute("x", (80 * (y - 0.5) - 12).toFixed(2));
    this.walls.forEach((wall, i) => wall.classList.toggle("struck", struck === i));
    const end = place - 66;
    let path = "M6 80";
    for (let i = 0; i <= 12; ++i) path += `L${(6 + 18 + ((end - 6 - 36) * i) / 12).toFixed(1)} ${i % 12 === 0 ? 80 : i % 2 ? 66 : 94}`;
    this.spring.setAttribute("d", `${path}L${end.toFixed(1)} 80`);
  }
}

// A slider and a number field for one parameter.
class Control {
  constructor(parameter, changed) {
    Object.assign(this, { parameter });
    const { symbol, words, from, to } = parameter;
    this.slider = make("input", { type: "range", min: 0, max: 1000, "aria-label": `${words} ${symbol}` });
    this.field = make("input", { type: "number", step: "any", min: from, max: to, "aria-label": `${words} ${symbol}, as a number` });
    this.element = make("div", { class: "control" }, make("span", {}, `${symbol} `, make("small", {}, words)), this.slider, this.field);
    this.slider.addEventListener("input", () => {
      this.set(this.ofPart(this.slider.value / 1000));
      changed();
    });
    this.field.addEventListener("change", () => {
      // What is no number is not taken for one.
      if (!Number.isFinite(this.field.valueAsNumber)) return this.set(this.value);
      this.set(this.field.valueAsNumber);
      changed();
    });
  }
  ofPart(part) {
    const { from, to, logarithmic } = this.parameter;
    return Number((logarithmic ? from * (to / from) ** part : from + part * (to - from)).toPrecision(3));
  }
  set(value) {
    const { from, to, logarithmic } = this.parameter;
    this.value = value;
    this.field.value = value;
    this.slider.value = 1000 * (logarithmic ? Math.log(value / from) / Math.log(to / from) : (value - from) / (to - from));
    this.slider.setAttribute("aria-valuetext", String(value));
  }
}

/**
 * Puts a damper into `place`. `simulate(scene, options)` gives a promise of a run, as core.js has it. It begins with
 * `parameters`, at the first half cycle whose amplitude is at most `amplitude`. The page's address carries the parameters if
 * the page is the damper's `own`, as in #mass_ratio=0.02&restitution=0.4; else a link does, which begins with the place's id.
 * Only such a page has friction, weight and drag: it has the module that knows them.
 */
function mountDamper(place, simulate, { parameters: given = {}, amplitude: begun, own = false } = {}) {
  const decay = new Plot({ title: "Decay: drag along it", x: { words: "periods" }, y: { words: "amplitude", logarithmic: true } });
  const loss = new Plot({ title: "Loss factor over amplitude", x: { words: "amplitude", logarithmic: true }, y: { words: "η", logarithmic: true } });
  const phase = new Plot({ title: "The secondary mass in its cavity", x: { words: "place y" }, y: { words: "velocity" } });
  const drawing = new Drawing();
  const controls = parameters.filter(({ component }) => own || !component).map((parameter) => new Control(parameter, () => {
    preset.value = "";
    renew();
  }));
  const engine = make("select", { "aria-label": "engine" }, make("option", { value: "exact" }, "compliant walls"), make("option", { value: "restitution" }, "rigid walls"));
  const preset = make("select", { "aria-label": "a case of the paper" }, make("option", { value: "" }, "a case of the paper"),
    ...presets.map(({ words }, i) => make("option", { value: i }, words)));
  const play = make("button", { type: "button" }, "Play");
  const slow = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const speed = make("input", { type: "range", min: -2, max: 2, step: 0.1, value: slow ? -1 : 0, "aria-label": "speed" });
  const time = make("input", { type: "range", min: 0, max: 1, step: "any", value: 0, class: "time", "aria-label": "time" });
  const link = make("a", {}, "link to this damper");
  const summary = make("p", { role: "status" });
  const problem = make("p", { role: "alert", class: "problem" });
  place.classList.add("damper");
  place.replaceChildren(
    make("div", { class: "controls" }, make("div", { class: "choices" }, preset, engine), ...controls.map(({ element }) => element)),
    drawing.element,
    make("div", { class: "player" }, play, make("label", {}, "speed ", speed), time, ...(own ? [] : [link])),
    problem, summary,
    make("div", { class: "plots" }, decay.element, loss.element, phase.element));

  let run; // the decay that is shown
  let motion; // the stretch of it around `now`
  let now = 0;
  let playing = false;

  const valueOf = (name) => controls.find(({ parameter }) => parameter.name === name).value;
  const isForced = () => valueOf("force_amplitude") !== 0;
  const values = () => controls.filter(({ parameter, value }) => value !== 0 || !parameter.component).map(({ parameter, value }) => [parameter.name, value]);
  const scene = () => ({
    ...Object.fromEntries(values()),
    ...(isForced() ? { until_time: untilTimeForced } : { until_time: untilTime, until_amplitude: Math.min(untilAmplitude, valueOf("x0") / 10) }),
  });

  // What is asked for while the worker works waits, and is asked for once: a new decay, if any of it was, and the stretch of
  // it that is wanted by then.
  let asked = false;
  let waiting;
  async function ask({ fresh: isFresh = false }) {
    waiting = { fresh: isFresh || waiting?.fresh };
    if (asked) return;
    asked = true;
    while (waiting) {
      const { fresh } = waiting;
      waiting = undefined;
      const forced = isForced();
      const begin = Math.max(0, Math.min(now, (run?.end_time ?? now) - windowLength));
      const history = { begin, end: begin + windowLength, count: 4 * samplesPerPeriod + 1 };
      try {
        // Of a forced motion there is no loss factor to measure: its amplitude does not fall by losses alone.
        const record = ["half_cycles", "impacts", "contacts", "history", ...(forced ? [] : ["loss"])];
        const simulated = scene();
        const result = await simulate(simulated, { engine: engine.value, record, history });
        problem.textContent = "";
        delete place.dataset.stale;
        motion = result;
        const first = !run;
        if (fresh || first) show(result, simulated);
        const row = first ? run.half_cycles.amplitude.findIndex((each) => each <= begun) : -1;
        if (row >= 0) goTo(run.half_cycles.peak_time[row]);
        else showMoment();
      } catch (error) {
        problem.textContent = `${error.message}\nWhat is shown is the decay before the last change.`;
        place.dataset.stale = "";
        place.removeAttribute("aria-busy");
      }
    }
    asked = false;
  }

  function renew() {
    const parts = new URLSearchParams(values());
    parts.set("engine", engine.value);
    if (own) globalThis.history.replaceState(null, "", `#${parts}`);
    else link.href = `#${place.id}&${parts}`;
    place.setAttribute("aria-busy", "true");
    ask({ fresh: true });
  }

  // The largest amplitude at which friction and weight keep the mass at rest.
  function lockingAmplitude({ mass_ratio, force_amplitude, force_frequency, friction = 0, weight = 0 }) {
    return (friction + weight) * (force_amplitude ? force_frequency ** -2 : 1 + mass_ratio);
  }

  function show(result, simulated) {
    run = result;
    now = Math.min(now, run.end_time);
    time.max = run.end_time;
    const { peak_time, amplitude } = run.half_cycles;
    const largest = amplitude.reduce((most, each) => Math.max(most, each), 0);
    const least = amplitude.reduce((most, each) => (each > 0 ? Math.min(most, each) : most), largest);
    const periods = Math.max(1, run.end_time / period);
    decay.scale({ from: 0, to: periods }, { from: Math.min(least, largest / 10), to: largest });
    decay.draw(peak_time.map((each) => each / period), amplitude);
    decay.ruleAt(run.bounce_down_end);
    run.loss ??= { time: [], amplitude: [], eta: [] };
    const eta = run.loss.eta.filter((each) => each > 0);
    loss.scale({ from: Math.min(least, largest / 10), to: largest },
      { from: eta.reduce((least, each) => Math.min(least, each), 1) * 0.8, to: eta.reduce((most, each) => Math.max(most, each), 1e-6) * 1.25 });
    loss.draw(run.loss.amplitude, run.loss.eta);
    const words = simulated.force_amplitude ? "under a force" : Number.isFinite(run.bounce_down_end) ? `bounce-down ends at amplitude ${rounded(run.bounce_down_end)}` : "no bounce-down that ends";
    summary.dataset.run = `${rounded(run.end_time / period)} periods to amplitude ${rounded(amplitude.at(-1) ?? 0)}, ${counted(run.impacts.time.length, "impact")}; ${words}`;
    const locking = lockingAmplitude(simulated);
    if (locking > 0) summary.dataset.run += `; held at rest up to amplitude ${rounded(locking)}`;
    place.removeAttribute("aria-busy");
  }

  // Values at `now`, between two samples.
  function sampled(column) {
    const times = motion.history.time;
    const i = Math.max(0, Math.min(lastAtMost(times, now), times.length - 2));
    const part = Math.max(0, Math.min((now - times[i]) / (times[i + 1] - times[i]), 1));
    return column[i] + part * (column[i + 1] - column[i]);
  }

  function struckWall() {
    const last = lastAtMost(motion.impacts.time, now);
    return last >= 0 && now - motion.impacts.time[last] < 0.25 ? motion.impacts.wall[last] : undefined;
  }

  function showMoment() {
    const { history } = motion;
    if (history.time.length < 2) return;
    const row = Math.max(0, lastAtMost(run.half_cycles.peak_time, now));
    const amplitude = run.half_cycles.amplitude[row];
    const widest = history.x.reduce((most, each) => Math.max(most, Math.abs(each)), 1e-9);
    const fastest = history.w.reduce((most, each) => Math.max(most, Math.abs(each)), 1e-9);
    drawing.scale(widest);
    drawing.draw(sampled(history.x), sampled(history.y), struckWall());
    phase.scale({ from: -0.05, to: 1.05 }, { from: -fastest, to: fastest });
    phase.draw(history.y, history.w);
    phase.markAt(sampled(history.y), sampled(history.w));
    decay.markAt(now / period, amplitude);
    const eta = run.loss.eta[Math.max(0, lastAtMost(run.loss.time, now))];
    loss.markAt(amplitude, eta);
    time.value = now;
    time.setAttribute("aria-valuetext", `period ${rounded(now / period)}`);
    summary.textContent = `${summary.dataset.run}. At period ${rounded(now / period)}: amplitude ${rounded(amplitude)}, ` +
      `${counted(run.half_cycles.impacts[row], "impact")} in the half cycle${eta > 0 ? `, loss factor ${rounded(eta, 2)}` : ""}.`;
  }

  const isHere = () => motion && now >= motion.history.time[0] && now <= motion.history.time.at(-1);
  function goTo(moment) {
    now = Math.max(0, Math.min(moment, run?.end_time ?? 0));
    if (isHere()) showMoment();
    else ask({});
  }

  let before;
  function step(stamp) {
    if (!playing) return;
    const passed = before === undefined ? 0 : (stamp - before) / 1000;
    before = stamp;
    if (run && now >= run.end_time) stopPlaying();
    else if (run) goTo(now + passed * 10 ** Number(speed.value) * 3);
    requestAnimationFrame(step);
  }
  function stopPlaying() {
    playing = false;
    play.textContent = "Play";
  }
  play.addEventListener("click", () => {
    if (playing) return stopPlaying();
    playing = true;
    before = undefined;
    play.textContent = "Pause";
    if (run && now >= run.end_time) now = 0;
    requestAnimationFrame(step);
  });

  function dragTo(event) {
    const box = decay.svg.getBoundingClientRect();
    const part = (((event.clientX - box.left) / box.width) * 360 - decay.left) / (decay.right - decay.left);
    goTo(decay.valueAt(Math.max(0, Math.min(part, 1))) * period);
  }
  decay.svg.classList.add("dragged");
  decay.svg.addEventListener("pointerdown", (event) => {
    decay.svg.setPointerCapture(event.pointerId);
    dragTo(event);
  });
  decay.svg.addEventListener("pointermove", (event) => event.buttons && dragTo(event));
  time.addEventListener("input", () => goTo(Number(time.value)));
  engine.addEventListener("change", () => {
    preset.value = "";
    renew();
  });
  preset.addEventListener("change", () => {
    if (preset.value === "") return;
    setAll({ ...usual, ...presets[preset.value] });
    engine.value = "exact";
    renew();
  });

  function setAll(values) {
    controls.forEach((control) => control.set(Number(values[control.parameter.name])));
  }
  setAll({ ...usual, ...given });
  if (given.engine === "restitution") engine.value = given.engine;
  renew();
}
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
