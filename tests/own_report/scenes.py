"""Pages about very different scenes: each is whole, says what is not there, and its numbers are those that an independent
reading of a run of the same scene gives.

    scenes.py PROGRAM FOLDER [SCENE...]      all of SCENES, or those named
"""
import html
import json
import math
import re
from html.parser import HTMLParser

import trial
from trial import demand, faults, finish, folder, program, source, write

example = source / "data/examples/mast.json"
SECTIONS = ["header", "scene", "decay", "loss", "regimes", "phase", "motion", "loads", "energy", "prediction", "made"]
MEMBERS = "4"

# Options of a scene, and what its page must say, by section; a figure's name stands for the figure.
SCENES = {
    "in units": (["--scene", str(example)], {"scene": "in brackets", "loss": "damped there as by|closed form"},
                 ["decay", "loss", "phase", "begin", "best", "prediction"]),
    "the paper's": (["--until-amplitude", "0.03"], {"regimes": "sticking ends", "prediction": "agree within"},
                    ["decay", "loss", "phase", "begin", "best", "prediction"]),
    "no impact": (["--x0", "0.3", "--damping-ratio", "0.01", "--until-time", "200"], {"regimes": "never strikes a wall",
                  "phase": "no impact lies between", "loads": "no impact", "energy": "There are no impacts", "loss": "viscous damping alone"},
                  ["decay", "begin", "prediction"]),
    "forced from rest": (["--x0", "0", "--force-amplitude", "0.05", "--until-time", "600"],
                         {"response": "without bound|locked to its box|not steady yet", "header": "At its worst frequency"},
                         ["decay", "response", "phase", "begin", "best", "prediction"]),
    "forced in units": (["--scene", "forced.json"], {"header": "locked to its box", "response": "Hz|the same amplitudes", "loads": "in an hour|an assumption"},
                        ["decay", "response", "phase", "begin", "best", "prediction"]),
    "forced, given up": (["--x0", "0.3", "--force-amplitude", "0.01", "--damping-ratio", "0.01", "--until-time", "100", "--max-impacts", "20"],
                         {"response": "were given up, because of too many impacts|not in this comparison"}, ["decay", "response", "begin", "best", "prediction"]),
    "two motions": (["--scene", "wind.json"], {"header": "Two steady motions are possible", "response": "depends on how one arrives|do not repeat"},
                    ["decay", "response", "phase", "begin", "best", "prediction"]),
    "worst not periodic": (["--scene", "gale.json"], {"response": "At its worst frequency the motion does not repeat"},
                           ["decay", "response", "phase", "begin", "best", "prediction"]),
    "overdamped": (["--damping-ratio", "3", "--until-time", "50"], {"decay": "not one whole half cycle",
                   "loss": "Without half cycles", "prediction": "no amplitude", "header": "times critically"}, ["begin"]),
    "creeping": (["--damping-ratio", "2", "--x0", "3", "--until-time", "200"], {"header": "falls to a tenth within|times critically"}, ["phase", "begin"]),
    "plastic": (["--restitution", "0", "--until-amplitude", "0.3", "--engine", "restitution"], {"loss": "no rebound", "loads": "rigid"},
                ["decay", "loss", "phase", "begin", "best", "prediction"]),
    "lossless": (["--restitution", "1", "--until-time", "100"], {"loss": "nothing is ever lost"},
                 ["decay", "phase", "begin", "prediction"]),
    "three half cycles": (["--until-time", "10"], {"loss": "too short for that"}, ["decay", "phase", "begin", "prediction"]),
    "slip of the units": (["--scene", "slip.json"], {"header": "is the clearance given in millimetres?"},
                          ["decay", "loss", "phase", "begin", "best", "prediction"]),
    "small and quick": (["--scene", "blade.json"], {"decay": "µm"}, ["decay", "loss", "phase", "begin", "best", "prediction"]),
    "at rest": (["--x0", "0", "--until-time", "5"], {"regimes": "Without half cycles"}, ["begin"]),
    "begins in a wall": (["--x0", "1", "--y0", "1.2", "--until-time", "80"], {"energy": "impacts were counted", "header": "outside its cavity", "loads": "in which the run begins"},
                         ["decay", "loss", "phase", "begin", "prediction"]),
    "released by w0": (["--x0", "0", "--w0", "3", "--until-time", "400"], {"prediction": "releases that differ"},
                       ["decay", "phase", "begin", "prediction"]),
    "several": (["--scene", "boxes.json"], {"scene": "of the first damper|power series", "dampers": "Failed at|an assumption", "motion": "strikes most often then"},
                ["decay", "loss", "phase", "begin", "best", "prediction"]),
    "several, rigid": (["--scene", "pair.json", "--engine", "restitution"], {"scene": "rigid", "dampers": "closed form"},
                       ["decay", "loss", "phase", "begin", "best", "prediction"]),
    "several, forced": (["--scene", "pushed.json"], {"header": "locked to their boxes", "response": "the boxes empty|With the dampers", "dampers": "an assumption"},
                        ["decay", "response", "phase", "begin", "best", "prediction"]),
    "budget": (["--until-amplitude", "0.1", "--max-impacts", "40"], {"scene": "--max-impacts"},
               ["decay", "phase", "begin", "prediction"]),
}

VOID = {"meta", "br", "hr", "img", "input", "link"}


class Page(HTMLParser):
    """Holds what every page must be; what is not is in `faults`."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.faults, self.open, self.ids, self.headings, self.links = [], [], [], [], []
        self.sections, self.tables, self.figures, self.svgs = {}, [], [], []
        self.section, self.numbers, self.words = None, {}, {}
        self.value = None
        if not text.startswith("<!DOCTYPE html>\n"):
            self.faults.append("no doctype")
        self.feed(text)
        self.close()
        if self.open:
            self.faults.append(f"not closed: {self.open}")
        self.look()

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        if len(given) != len(attributes):
            self.faults.append(f"<{tag}> has an attribute twice")
        if tag not in VOID:
            self.open.append(tag)
        self.ids += [given["id"]] if "id" in given else []
        if tag in ("h1", "h2", "h3"):
            self.headings.append(int(tag[1]))
        if tag == "html" and not given.get("lang"):
            self.faults.append("no language")
        if tag in ("section", "header"):
            self.section = given.get("id", tag)
            self.numbers[self.section], self.words[self.section] = [], ""
        if tag == "table":
            self.tables.append({"caption": False})
        if tag == "caption":
            self.tables[-1]["caption"] = True
        if tag == "th" and given.get("scope") not in ("row", "col"):
            self.faults.append("a <th> without scope")
        if tag == "figure":
            self.figures.append(given.get("id"))
        if tag == "svg":
            self.svgs.append(given)
        if tag == "data":
            self.value = given["value"]
            float(self.value)
            if self.section:
                self.numbers[self.section].append(float(self.value))
        for name in ("href", "src", "xlink:href"):
            if name in given:
                self.links.append(given[name])

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.handle_endtag(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open[-1] != tag:
            self.faults.append(f"</{tag}> closes {self.open[-1:]}")
            return
        self.open.pop()
        if tag in ("section", "header"):
            self.section = None
        if tag == "data":
            self.value = None

    def handle_data(self, text):
        if self.section and "svg" not in self.open and "style" not in self.open:
            self.words[self.section] += text
        if self.value is not None and not self.reads_as(text, float(self.value)):
            self.faults.append(f"{text!r} is shown for {self.value}")

    def reads_as(self, text, value):
        """What is shown is the number rounded; a power of ten comes apart from it, in <sup>."""
        text = text.replace("−", "-")
        if self.open[-1] == "sup":
            return abs(float(text)) < 400
        if text.endswith("×10"):
            return float(text[:-3]) != 0
        return abs(float(text) - value) <= 0.006 * abs(value)

    def look(self):
        if self.headings[:1] != [1] or any(b > a + 1 for a, b in zip(self.headings, self.headings[1:])):
            self.faults.append(f"headings out of order: {self.headings}")
        if len(set(self.ids)) != len(self.ids):
            self.faults.append(f"an id twice: {sorted(i for i in self.ids if self.ids.count(i) > 1)[:3]}")
        if not all(table["caption"] for table in self.tables):
            self.faults.append("a table without caption")
        for svg in self.svgs:
            if svg.get("role") != "img" or not svg.get("aria-label"):
                self.faults.append("an <svg> without role or description")
        for link in self.links:
            if not link.startswith("#") or link[1:] not in self.ids:
                self.faults.append(f"a link to elsewhere or nowhere: {link}")


def near(a, b, digits=1e-9):
    return abs(a - b) <= digits * max(abs(a), abs(b), 1e-300)


def call(*words):
    return trial.run(program, *words)


def line(times, values):
    """Mean and slope of a least-squares line, by the normal equations as they stand."""
    n, t0 = len(times), times[0]
    times = [t - t0 for t in times]
    t, tt, v, tv = sum(times), sum(t * t for t in times), sum(values), sum(t * v for t, v in zip(times, values))
    return v / n, (n * tv - t * v) / (n * tt - t * t)


def failure(rows):
    """The row of impact failure, or how many rows there are."""
    impacts = rows["impacts"]
    short = [i for i in range(1, len(impacts) - 1) if sum(impacts[i - 1:i + 2]) < 3]  # with its neighbours
    regular = [last for first in range(1, len(impacts)) for last in [first + 7]
               if impacts[first] and len(set(impacts[first:last + 1])) == 1 and last < len(impacts)]
    missed = [i for i in short if not impacts[i] and i > max([1] + regular)]
    if missed:
        return missed[0]
    row, for_good = len(impacts) - 3, len(impacts)
    while row >= 1 and row + 1 in short:
        for_good = for_good if impacts[row] else row
        row -= 1
    return for_good


def best_damping(rows):
    """The largest loss factor before impact failure, and its amplitude: lines through the logarithm of the amplitude over
    3 to 11 peaks, the outer ones within a factor of 2 of each other."""
    end, fits = failure(rows), []
    times, amplitudes = rows["peak_time"][1:end], rows["amplitude"][1:end]
    for i in range(1, len(times) - 1):
        m = 1
        while m < 5 and m < i and i + m + 1 < len(times) and 0.5 <= amplitudes[i - m - 1] / amplitudes[i + m + 1] <= 2:
            m += 1
        mean, slope = line(times[i - m:i + m + 1], [math.log(a) for a in amplitudes[i - m:i + m + 1]])
        if end == len(rows["impacts"]) or math.exp(mean) > rows["amplitude"][end]:
            fits.append((-2 * slope, math.exp(mean)))
    return max(fits)


def windows(impacts):
    """The longest series of at least 8 half cycles with as many impacts each, 1 to 6, from the first whole one on."""
    series, first = {}, 1
    for row in range(1, len(impacts) + 1):
        if row == len(impacts) or impacts[row] != impacts[first]:
            if row - first >= 8 and 1 <= impacts[first] <= 6:
                series.setdefault(impacts[first], []).append((first, row - 1))
            first = row
    return {count: max(each, key=lambda ends: ends[1] - ends[0]) for count, each in series.items()}


MOVING = ["x0", "v0", "w0", "force_amplitude", "y0"]  # what can set a scene moving


def shifted(scene):
    """Options of the other releases: splitmix64 from 1, up to a thousand steps of 1e-9 either way of all that sets the
    scene moving; y0 of how deep it is in a wall."""
    state, mask = 1, 2 ** 64 - 1
    for _ in range(int(MEMBERS) - 1):
        state = (state + 0x9e3779b97f4a7c15) & mask
        z = ((state ^ (state >> 30)) * 0xbf58476d1ce4e5b9) & mask
        z = ((z ^ (z >> 27)) * 0x94d049bb133111eb) & mask
        z ^= z >> 31
        steps = 1.0 + (z >> 1) % 1000
        factor = 1 + 1e-9 * (steps if z & 1 else -steps)
        numbers = {name: scene[name] * factor for name in MOVING[:-1] if name in scene}  # of several, w0 is 0 here
        if "y0" in scene:
            y0 = scene["y0"]
            numbers["y0"] = y0 * factor if y0 < 0 else 1 + (y0 - 1) * factor if y0 > 1 else y0
        yield [f"--{name.replace('_', '-')}={value!r}" for name, value in numbers.items()]


def without_units(options, scene):
    """The options with the scene as it is run, whose numbers need no units, and without those that set it moving."""
    write("without_units.json", scene)
    pairs = [pair for pair in zip(options[::2], options[1::2]) if pair[0][2:].replace("-", "_") not in (*MOVING, "scene")]
    return ["--scene", "without_units.json", *sum(pairs, ())]


def spread(run, options):
    """Greatest and last relative spread of the releases' amplitudes."""
    columns = [run["half_cycles"]["amplitude"]]
    for release in shifted(run["scene"]):
        other = call("run", *without_units(options, run["scene"]), *release)
        columns.append(json.loads(other.stdout)["half_cycles"]["amplitude"])
    rows = [sorted(row) for row in zip(*columns)]
    spreads = [(row[-1] - row[0]) / ((row[1] + row[2]) / 2) for row in rows]
    return max(spreads), spreads[-1], next((i for i, each in enumerate(spreads) if each > 0.01), None)


def holds(page, section, value, what, digits=1e-9):
    demand(any(near(value, number, digits) for number in page.numbers[section]),
           f"{name}: {section} does not have the {what}, {value}: {page.numbers[section]}")


def carried(scene):
    return sum(each["mass_ratio"] for each in scene.get("dampers", [scene]))


def largest_force(damper, speed):
    """By stepping through the contact."""
    nu, k, decrement = damper["mass_ratio"], damper["wall_stiffness"], -math.log(damper["restitution"])
    damping = 2 * math.sqrt(k / nu) * decrement / math.hypot(math.pi, decrement)
    q, v, largest, h = 0.0, speed, 0.0, 1e-4 * math.sqrt(nu / k)
    while q >= 0:
        force = damping * v + k / nu * q
        largest = max(largest, nu * force)
        v -= h * (1 + nu) * force
        q += h * v
    return largest


def of_damper(column, run, number):
    """Those rows of the impacts that are the damper's, from 0."""
    return [value for value, its in zip(run["impacts"][column], run["impacts"]["damper"]) if its == number + 1]


def dampers(page, run, scales):
    """What each of several did, and which took most of the energy."""
    energy, rows = run["energy"], run["half_cycles"]
    lost = sum(energy["impact_loss"]) + energy["contact_loss"] + energy["bounce_down_loss"] + energy["viscous_work"]
    taken = [its["impact_loss"] + its["bounce_down_loss"] for its in energy["dampers"]]
    for number, damper in enumerate(run["scene"]["dampers"]):
        speed = max(map(abs, of_damper("relative_velocity", run, number)))
        holds(page, "dampers", len(of_damper("time", run, number)), f"impacts of damper {number + 1}")
        holds(page, "dampers", 100 * taken[number] / lost, f"energy of damper {number + 1}")
        holds(page, "dampers", speed * (scales[1] / scales[0] / 1000 if scales else 1), f"speed of damper {number + 1}")
        if run["engine"]["name"] != "restitution":
            force = largest_force(damper, speed) * (scales[2] / scales[1] * 1000 if scales else 1)
            holds(page, "dampers", force, f"force on damper {number + 1}", 1e-3)
        if run["scene"]["force_amplitude"]:
            continue
        missed = failure({"impacts": rows["dampers"][number]["impacts"]})
        if missed < len(rows["amplitude"]):
            holds(page, "dampers", in_page(rows["amplitude"][missed], scales), f"failure of damper {number + 1}")
    return max(range(len(taken)), key=lambda number: taken[number])


def loads(page, run, scales):
    """Speed and number of the impacts, and the force of the hardest."""
    impacts, scene = run["impacts"], run["scene"]
    if not impacts["time"]:
        return
    speed, end = max(map(abs, impacts["relative_velocity"])), run["end_time"]
    since = 0.75 * end if scene["force_amplitude"] else 0
    rate = sum(time >= since for time in impacts["time"]) / (end - since)
    holds(page, "loads", speed * (scales[1] / scales[0] / 1000 if scales else 1), "largest impact speed")
    holds(page, "loads", rate * (3600 / scales[0] if scales else 2 * math.pi), "number of impacts in an hour or a period")
    if run["engine"]["name"] == "restitution" or "dampers" in scene:
        return
    holds(page, "loads", largest_force(scene, speed) * (scales[2] / scales[1] * 1000 if scales else 1), "largest force", 1e-3)


def linear_amplitude(scene, mass, omega):
    stiffness = complex(1 - mass * omega * omega, 2 * scene["damping_ratio"] * omega)
    return scene["force_amplitude"] / abs(stiffness) if stiffness else math.inf


def worst_linear(scene, mass):
    """The largest amplitude, by trying frequencies about the resonance."""
    if not scene["damping_ratio"]:
        return math.inf
    return max(linear_amplitude(scene, mass, mass ** -0.5 * (1 + 1e-6 * i)) for i in range(-2000, 2001))


def marks(text):
    """The triangles of the response's drawing, (frequency, amplitude) as its axes measure them: by way, and whether open."""
    drawing = re.search(r'id="figure-response">(.*?)</figure>', text, re.S)[1]
    axes, = json.loads(html.unescape(re.search(r"<metadata>(.*?)</metadata>", drawing)[1]))["axes"]
    height = float(re.search(r'viewBox="0 0 \S+ (\S+)"', drawing)[1])

    def value(axis, at, is_logarithmic):
        _, low, high, begin, end = axis
        part = (at - begin) / (end - begin)
        return low * (high / low) ** part if is_logarithmic else low + part * (high - low)

    found = {"rising": {False: [], True: []}, "falling": {False: [], True: []}}
    kinds = {"8": ("rising", False), "7": ("rising", True), "10": ("falling", False), "9": ("falling", True)}
    for group in re.findall(r'<g id="[^"]*gnuplot_plot_[^>]*>(.*?)(?=<g id="[^"]*gnuplot_plot_|\Z)', drawing, re.S):
        uses = re.findall(r"""<use xlink:href='#[^']*gpPt(\d+)' transform='translate\(([\d.]+),([\d.]+)\)""", group)
        for kind, x, y in uses[:-1] if group.startswith("<title>") else uses:  # the last is the legend's
            way, is_open = kinds[kind]
            found[way][is_open].append((value(axes["x"], float(x), False), value(axes["y"], height - float(y), "y" in axes["log"])))
    return found


def ranges_told(words):
    return re.search(r"Two steady motions are possible (.*?): which", words)


def response(page, text, run, scales):
    """The amplitudes of the two linear oscillators, by solving for their complex amplitude; those with the damper as they
    are drawn, as far as they can be read off; the largest, by a long run there."""
    scene, length = run["scene"], scales[1] if scales else 1
    words = page.words["response"]
    for mass in (1 + carried(scene), 1):
        given = linear_amplitude(scene, mass, scene["force_frequency"])
        for section in ("header", "response") if mass > 1 else ("response",):
            if math.isfinite(given):
                holds(page, section, given * length, f"amplitude with the mass {mass}")
            if scene["damping_ratio"]:
                holds(page, section, worst_linear(scene, mass) * length, f"worst amplitude with the mass {mass}", 1e-6)
    drawn = marks(text)
    count = len(sum((drawn[way][True] + drawn[way][False] for way in drawn), []))
    given_up = re.search(r"(\d+) motions? (was|were) given up", words)
    holds(page, "response", (count + int(given_up[1] if given_up else 0)) / 2, "number of frequencies")
    unsteady = re.search(r"(\d+) of these (is|are) not steady yet", words)
    not_periodic = len(drawn["rising"][True]) + len(drawn["falling"][True])
    demand(("do not repeat within" in words) == (not_periodic > 1), f"{name}: {not_periodic} motions are drawn as not periodic")
    if not_periodic > 1:
        holds(page, "response", not_periodic, "number of motions that do not repeat")
    demand(not unsteady or 0 < int(unsteady[1]) <= not_periodic, f"{name}: more are not steady than do not repeat")
    every = {way: sorted(drawn[way][False] + drawn[way][True]) for way in drawn}
    x_unit, y_unit = 1, 1
    if scales:
        told = json.loads(html.unescape(re.search(r'id="figure-response">.*?<metadata>(.*?)</metadata>', text, re.S)[1]))["axes"][0]
        x_unit, y_unit = (UNITS[told[axis][0].rpartition(" in ")[2]] for axis in "xy")
    pixel = 0.004  # of an amplitude, on the logarithmic axis
    largest = {way: max(amplitude for _, amplitude in every[way]) / y_unit for way in every}
    for way in every:
        holds(page, "response", largest[way], f"largest amplitude drawn, the frequency {way}", pixel)
        given = scene["force_frequency"] * (x_unit / scales[0] / 2 / math.pi if scales else 1)
        at = min(every[way], key=lambda mark: abs(mark[0] - given))
        if near(at[0], given, 1e-3):
            holds(page, "response", at[1] / y_unit, f"amplitude at the frequency given, {way}", pixel)
        else:
            demand(given_up, f"{name}: {way}, there is no mark at the frequency given")
    worst = max(largest.values())
    lead = page.words["header"].partition("At its worst frequency")[2]
    demand(lead and "on average" not in page.words["header"].partition("At its worst frequency")[0], f"{name}: the page does not open with the worst case")
    holds(page, "header", worst, "largest amplitude", pixel)
    twice = re.search(r"its largest amplitude is first ([\d.]+).*?, then ([\d.]+)", words)
    if twice:
        demand(near(float(twice[2]), worst, 0.01), f"{name}: followed again, {twice[2]} is not the largest amplitude {worst}")
        demand("not rely" in words or near(float(twice[1]), worst, 0.4), f"{name}: from {twice[1]} to {twice[2]}, and it counts as steady")
    locked = worst_linear(scene, 1 + carried(scene))
    if math.isfinite(locked) and "not rely" not in words:
        shown = next((number for number in page.numbers["header"] if near(number, worst, pixel)), math.nan)
        for section in ("header", "response"):
            holds(page, section, 100 * abs(1 - shown / (locked * length)), "reduction of the largest amplitude", 1e-6)
            demand(("off the largest" if shown < locked * length else "to the largest") in page.words[section], f"{name}: {section}: larger or smaller?")
    # A long run from the scene's own release, at the worst frequency: its last 500 periods.
    if scene["damping_ratio"] and not given_up:
        number = r"[\d.]+"
        told = re.search(f"At its worst frequency, ({number})" + (f".Hz \\(({number})" if scales else ""), page.words["header"])
        omega = min(page.numbers["header"], key=lambda number: abs(number - float(told[told.lastindex])))  # with all its digits
        periods = 4000
        long = json.loads(call("run", *without_units(options, scene), "--force-frequency", repr(omega), "--until-time", repr(periods * 2 * math.pi / omega),
                               "--max-half-cycles", "1000000", "--max-impacts", "1000000").stdout)["half_cycles"]
        last = max(a for t, a in zip(long["peak_time"], long["amplitude"]) if t > (periods - 500) * 2 * math.pi / omega) * length
        repeats = any(near(mark[1] / y_unit, worst, pixel) for way in drawn for mark in drawn[way][False])
        demand(near(last, worst, 0.01 if repeats else 0.2) or ranges_told(words) and last < worst,
               f"{name}: at the worst frequency a long run has {last}, not {worst}")
    # Where both motions repeat and differ the page says so, and its range reaches there.
    ranges = ranges_told(words)
    differ = [a[0] for a, b in zip(sorted(drawn["rising"][False]), sorted(drawn["falling"][False]))
              if drawn["rising"][True] == drawn["falling"][True] == [] and not near(a[1], b[1], 0.06)]
    demand(bool(ranges) or not differ, f"{name}: the two ways differ at {differ}, and the page does not say so")
    if ranges:
        at = re.search(r"At ([\d.]+)\D*(?:\(([\d.]+)\D*\))? the amplitude is ([\d.]+).*? if (the frequency has risen|it has fallen) to there, and ([\d.]+)", words)
        demand(float(at[3]) > float(at[5]), f"{name}: of two motions the smaller is named first")
        frequency = float(at[1]) * x_unit
        for end in re.findall(r"(?:between|and|at) ([\d.]+).(?:Hz|Ω)", ranges[1]):
            pair = [min(every[way], key=lambda mark: abs(mark[0] - float(end) * x_unit)) for way in every]
            demand(not near(pair[0][1], pair[1][1], 0.045), f"{name}: the two ways do not differ at {end}")
        for way, told in zip(("rising", "falling") if "risen" in at[4] else ("falling", "rising"), (at[3], at[5])):
            there = min(every[way], key=lambda mark: abs(mark[0] - frequency))
            demand(near(there[1] / y_unit, float(told), 0.01), f"{name}: {way}, the amplitude drawn at {frequency} is {there[1]}, not {told}")


# How many of a unit make a second, a millimetre or a hertz.
UNITS = {"s": 1, "ms": 1e3, "mm": 1, "µm": 1e3, "m": 1e-3, "Hz": 1, "kHz": 1e-3}


def axis(figure, given, noun, symbol, end, margin, scale):
    """An axis measures what it says, in a unit that fits, and ends at `end`, a dimensionless number, or up to `margin` above."""
    name, low, high = given[:3]
    factor = 1
    if scale is None:
        demand(name == symbol, f"{figure}: an axis is called {name}, not {symbol}")
    else:
        told, _, unit = name.rpartition(" in ")
        demand(told == noun and unit in UNITS, f"{figure}: an axis is called {name}, not {noun} in its unit")
        factor = scale * UNITS.get(unit, math.nan)
        demand(high < 100 if unit in ("ms", "µm") else 0.1 <= high < 1e4, f"{figure}: an axis goes to {high} {unit}")
    demand(end * factor * (1 - 1e-6) <= high <= end * factor * margin * (1 + 1e-6), f"{figure}: {name} goes to {high}, not {end * factor}")


def compare_axes(name, text, run, scales, shown):
    """What the axes of the drawings measure is what the run holds, in units where the scene is."""
    drawn = {figure: json.loads(html.unescape(said))["axes"] for figure, said in re.findall(
        r'id="figure-(\w+)">(?:(?!</figure>).)*?<metadata>(.*?)</metadata>', text, re.S)}
    seconds, millimetres = scales[:2] if scales else (None, None)
    rows = run["half_cycles"]
    if "decay" in drawn:
        only, = drawn["decay"]
        axis(f"{name}: decay", only["x"], "time", "t", max(rows["peak_time"]), 1, seconds)
        axis(f"{name}: decay", only["y"], "peak amplitude", "A", max(rows["amplitude"]), 1.3, millimetres)
    if "loss" in drawn:
        axis(f"{name}: loss", drawn["loss"][0]["x"], "peak amplitude", "A", rows["amplitude"][1], 1.2, millimetres)
    if "begin" in drawn:
        above, below = drawn["begin"]
        end = min(4 * math.pi if rows["amplitude"] else run["end_time"], run["end_time"])
        axis(f"{name}: motion", above["x"], "time", "t", 0.98 * end, 1.04, seconds)  # the last sample before the end
        length = run["scene"]["dampers"][shown]["clearance"] if "dampers" in run["scene"] else 1
        axis(f"{name}: motion", above["y"], "relative displacement", "y", 1.14, 2, millimetres and millimetres * length)
        demand(above["x"][:3] == below["x"][:3], f"{name}: motion: two axes of time")


def in_page(length, scales):
    """A length as a page gives it: in units in millimetres, below a tenth of one in micrometres."""
    value = length * (scales[1] if scales else 1)
    return 1e3 * value if scales and value < 0.1 else value


def compare(page, text, run, scales):
    """The numbers of the page against those of a run, read anew. `scales` are (s, mm, J), or nothing."""
    rows, energy = run["half_cycles"], run["energy"]
    times, amplitudes = rows["peak_time"], rows["amplitude"]
    impacts = sum(energy["impact_loss"]) + energy["contact_loss"] + energy["bounce_down_loss"]
    for part, value in {"energy at the beginning": energy["initial"]["total"], "end": energy["final"]["total"],
                        "loss to impacts": impacts, "viscous work": energy["viscous_work"]}.items():
        holds(page, "energy", value, part, 1e-6 if part == "loss to impacts" else 1e-9)
        if scales:
            holds(page, "energy", value * scales[2], part + " in J", 1e-6)
    first = min(4 * math.pi if amplitudes else run["end_time"], run["end_time"])
    holds(page, "motion", first / (2 * math.pi), "length of the first window")
    several = "dampers" in run["scene"]
    shown = dampers(page, run, scales) if several else None
    struck = sum(time <= first for time in (of_damper("time", run, shown) if several else run["impacts"]["time"]))
    if struck > 1:
        holds(page, "motion", struck, "impacts in the first window")
    else:
        demand(("strikes a wall once" if struck else "does not strike") in page.words["motion"], f"{name}: {struck} impacts in the first window")
    if energy["impact_loss"]:
        holds(page, "energy", len(energy["impact_loss"]), "number of impacts")
    loads(page, run, scales)
    if not amplitudes:
        return shown
    if run["scene"]["force_amplitude"]:
        last = amplitudes[-(len(amplitudes) // 4):]
        means = [sum(last) / len(last)] + ([min(last), max(last)] if "at least" in page.words["decay"] else [])
        for value in means:
            holds(page, "decay", value * (scales[1] if scales else 1), "amplitude in the last quarter")
        demand(len(means) == 3 or max(last) < 1.01 * min(last), f"{name}: the amplitudes of the last quarter are one")
        response(page, text, run, scales)
        return shown
    if amplitudes[0] == max(amplitudes[:2]):
        for part in (0.5, 0.1, 0.01):
            row = next((n for n, a in enumerate(amplitudes) if a < part * amplitudes[0]), None)
            if row is None:
                break
            below, digits = times[row], 1e-9
            if amplitudes[row] < amplitudes[row - 1] / 10:  # no swing: the last time at which |x| is as large, among samples
                begin, end = times[row - 1], rows["zero_crossing"][row - 1]
                motion = json.loads(call("run", *options, "--record", "history", "--history", f"{begin!r}:{end!r}:200001").stdout)["history"]
                below, digits = max(t for t, x in zip(motion["time"], motion["x"]) if abs(x) >= part * amplitudes[0]), 1e-3
            holds(page, "decay", (below - times[0]) / (2 * math.pi), f"periods to {part}", digits)
            if scales:
                holds(page, "decay", (below - times[0]) * scales[0], f"seconds to {part}", digits)
        if amplitudes[0] > amplitudes[-1]:
            holds(page, "decay", 100 * math.log(amplitudes[0] / amplitudes[-1]) / (times[-1] - times[0]), "damping ratio", 1e-7)
    if "loss" in drawn:
        eta, amplitude = best_damping(rows)
        holds(page, "loss", eta, "largest loss factor", 1e-6)  # the two ways of fitting round differently
        holds(page, "loss", in_page(amplitude, scales), "its amplitude", 1e-6)
    if rows["impacts"] and energy["impact_loss"] and not several:
        holds(page, "regimes", max(rows["impacts"]), "most impacts in a half cycle")
        for count, (first, last) in windows(rows["impacts"]).items():
            for value in (count, last - first + 1, amplitudes[first], amplitudes[last]):
                holds(page, "regimes", value, f"window of {count} impacts")
    greatest, last, lost = spread(run, options)
    demand(greatest > 0, f"{name}: the releases do not differ")
    # Twelve digits of an amplitude are left in a spread of a millionth, six of them significant.
    holds(page, "prediction", 100 * greatest, "greatest spread", 1e-6)
    if lost is not None:
        holds(page, "prediction", 100 * last, "last spread", 1e-6)
        holds(page, "prediction", amplitudes[lost - 1], "last amplitude at which the releases agree")
    return shown


def frictions(page, scene, run, scales):
    """What the page says of friction, by runs of the scene with it that end with the page's own."""
    ends = {"until_seconds": run["end_time"] * scales[0]}
    for mu in (0, 0.1, 0.2, 0.3):
        rubbed = {key: value for key, value in scene.items() if not key.startswith("until_")} | ends
        for each in rubbed.get("dampers", [rubbed]):
            each["friction_coefficient"] = mu
        write("rubbed.json", rubbed)
        rows = run["half_cycles"]
        if mu:
            rows = json.loads(call("run", "--scene", "rubbed.json", "--engine", run["engine"]["name"], *(["--locate"] if run["engine"].get("locate") else [])).stdout)["half_cycles"]
        impacts, amplitudes = rows["impacts"], rows["amplitude"]
        struck = [row for row, count in enumerate(impacts) if count]
        wanted = {"last impact": in_page(amplitudes[struck[-1]], scales), "its time": rows["peak_time"][struck[-1]] * scales[0],
                  "end": in_page(amplitudes[-1], scales)}
        if run["scene"]["force_amplitude"]:
            quarter = amplitudes[-(len(amplitudes) // 4):]
            wanted |= {"largest": in_page(max(quarter), scales), "mean": in_page(sum(quarter) / len(quarter), scales)}
        else:
            tenth = next((row for row, a in enumerate(amplitudes) if a < amplitudes[0] / 10), None)
            if tenth and amplitudes[tenth] > amplitudes[tenth - 1] / 10:
                wanted["time to a tenth"] = (rows["peak_time"][tenth] - rows["peak_time"][0]) * scales[0]
            eta, amplitude = best_damping(rows)
            if eta > 0:
                wanted |= {"best damping": in_page(amplitude, scales), "damping ratio there": 50 * eta}
        for what, value in wanted.items():
            holds(page, "scene", value, f"{what} with a coefficient of friction of {mu}", 1e-6)
        if mu == 0.2:
            for what in ("last impact", "largest" if "largest" in wanted else "end"):
                holds(page, "header", wanted[what], f"{what} with a coefficient of friction of {mu}")


given = json.loads(example.read_text())
write("slip.json", {**given, "clearance": given["clearance"] / 1000, "until_seconds": 10,
                    "description": "1 < 2 & \"3\" {{title}}"})
write("blade.json", {"mass": 0.05, "stiffness": 2e6, "secondary_mass": 0.002, "clearance": 0.01,
                     "restitution": 0.6, "initial_displacement": 0.06, "until_millimetres": 0.0002})
forced = {**given, "exciting_force": 10, "exciting_frequency": 3.18, "until_seconds": 60}
del forced["until_millimetres"]
write("forced.json", forced)
for wind, newtons in {"wind": 2, "gale": 2.4}.items():
    write(f"{wind}.json", {**forced, "exciting_force": newtons, "exciting_frequency": 3.15, "initial_displacement": 0})
write("boxes.json", {
    "mass": 40, "stiffness": 16000, "gravity": 3.7, "initial_displacement": 60, "until_millimetres": 0.3, "until_seconds": 300,
    "dampers": [{"secondary_mass": 0.5, "clearance": 8}, {"secondary_mass": 0.4, "clearance": 20, "contact_stiffness": 1e7},
                {"secondary_mass": 0.3, "clearance": 50, "restitution": 0.5}]})
write("pushed.json", {
    "mass": 40, "stiffness": 16000, "damping_ratio": 0.005, "exciting_force": 10, "exciting_frequency": 3.15, "until_seconds": 60,
    "dampers": [{"secondary_mass": 0.6, "clearance": 8}, {"secondary_mass": 0.4, "clearance": 20}]})
write("pair.json", {"x0": 8, "until_amplitude": 0.05, "until_time": 3000, "dampers": [
    {"mass_ratio": 0.02, "y0": 0.5}, {"mass_ratio": 0.01, "restitution": 0.4, "clearance": 6}]})
for name in trial.words or SCENES:
    options, words, drawn = SCENES[name]
    file = folder / f"{name.replace(' ', '-').replace(chr(39), '')}.html"
    made = call("report", *options, "--members", MEMBERS, "-o", file.name)
    demand(made.stdout == "", f"{name}: says {made.stdout!r}")
    if not file.exists():
        continue
    text = file.read_text(encoding="utf-8")
    page = Page(text)
    faults.extend(f"{name}: {fault}" for fault in page.faults)
    forced = "--force-amplitude" in options or options[-1] in ("forced.json", "wind.json", "gale.json", "pushed.json")
    several = options[1] in ("boxes.json", "pair.json", "pushed.json")
    sections = ["response" if forced and each == "loss" else "dampers" if several and each == "regimes" else each for each in SECTIONS]
    demand([s for s in page.numbers if s] == sections, f"{name}: sections {list(page.numbers)}")
    demand(page.figures == [f"figure-{each}" for each in drawn], f"{name}: figures {page.figures}")
    demand(len(page.svgs) == len(drawn), f"{name}: {len(page.svgs)} drawings")
    demand("http" not in text.replace("http://www.w3.org/", ""), f"{name}: refers to the network")
    demand("{{" not in text.replace("{{title}}", "", "slip" in name), f"{name}: a place is left open")
    for section, wanted in words.items():
        for each in wanted.split("|"):
            demand(each in page.words.get(section, ""), f"{name}: {section} does not say {each!r}: {page.words.get(section)}")
    for section in sections:
        demand(page.words[section].count(" ") > 5, f"{name}: {section} is empty")
    run = json.loads(call("run", *options, "--record", "half_cycles,impacts,energy").stdout)
    scales = None
    if "--scene" in options and "x0" not in (scene := json.loads((folder / options[1]).read_text())):
        mass, stiffness, length = scene["mass"], scene["stiffness"], scene.get("clearance") or scene["dampers"][0]["clearance"]
        scales = (math.sqrt(mass / stiffness), length, stiffness * length * length * 1e-6)
    if scales:
        frictions(page, scene, run, scales)
    demand(bool(scales) == ("If it slid with" in page.words["header"] or "If they slid with" in page.words["header"]),
           f"{name}: friction has no scale without units")
    shown = compare(page, text, run, scales)
    compare_axes(name, text, run, scales, shown)

    before = file.stat().st_mtime_ns
    call("report", *options, "--members", MEMBERS, "--threads", "1", "-o", file.name)
    demand(file.read_text(encoding="utf-8") == text, f"{name}: other bytes with one thread")
    demand(file.stat().st_mtime_ns == before, f"{name}: written again, though nothing has changed")

demand("1 &lt; 2 &amp; &quot;3&quot; {{title}}" in (folder / "slip-of-the-units.html").read_text(), "a description is not kept as it is")
finish(f"{len(trial.words or SCENES)} pages, ")
