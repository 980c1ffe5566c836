#!/usr/bin/env python3
"""Runs every command that simulates with random scenes and options, and examines how it ends and what it writes.

    commands.py PROGRAM FOLDER [--seconds S] [--count N] [--seed SEED] [--only COMMAND[:NUMBER],...] [--timeout S] [--verbose]
    commands.py --planted FOLDER    whether it notices every way in which a command can fail

PROGRAM is best the sanitizers' (cmake --preset sanitize, target impact-damper). Each command has cases of its own for
S seconds (default 120), or N cases, two commands at a time. A case is a function of SEED, the command and the case's
number; the default seed is the tree of src/, so that each change of the program has new ones. --only orbits:17 runs that case alone.
FOLDER holds a folder for each case that failed, with its scene.

A case fails if a sanitizer reports, if the program ends by a signal, by an exit code that is not documented or without
saying why, if it takes longer than the timeout (default 600 s), or if what it writes is not valid JSON of its published
schema, not a table of finite numbers or not a whole page. The cases must reach what they are for: at least half of
those of a command must be valid input.
"""
import argparse
import collections
import concurrent.futures
import csv
import html.parser
import io
import json
import math
import os
import pathlib
import random
import re
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time

from jsonschema import Draft7Validator, RefResolver  # Debian: python3-jsonschema

SOURCE = pathlib.Path(__file__).resolve().parents[2]
ENGINES = ("exact", "restitution", "cem")
SETTINGS = dict(os.environ, UBSAN_OPTIONS="print_stacktrace=1",
                ASAN_OPTIONS="detect_stack_use_after_return=1:strict_string_checks=1:detect_leaks=1")


class Case:
    """Random numbers, the case's folder, and the words of its command line."""

    def __init__(self, seed, command, number, folder):
        self.random = random.Random(f"{seed} {command} {number}")
        self.folder, self.words, self.files = folder, [], {}
        self.outputs = {}  # kind of each file that is asked for
        COMMANDS[command](self)

    def one_of(self, *values):
        return self.random.choice(values)

    def chance(self, probability):
        return self.random.random() < probability

    def uniform(self, least, most):
        return self.random.uniform(least, most)

    def log_uniform(self, least, most):
        return math.exp(self.random.uniform(math.log(least), math.log(most)))

    def sign(self):
        return self.one_of(-1, 1)

    def file(self, name, content):
        self.files[name] = content if isinstance(content, str) else json.dumps(content)
        return name

    def add(self, *words):
        self.words += [str(each) for each in words]

    def output(self, name, kind, option="-o"):
        """Asks for a file, which `examined` reads as kind says."""
        self.outputs[name] = kind
        self.add(option, name)

    # Scenes

    def damper(self, engine, several):
        nu = self.one_of(0.02, 0.1, 0.5, 1, 2, self.log_uniform(1e-8, 10), self.log_uniform(1e-3, 0.3))
        clearance = self.one_of(1, 0.5, 2, self.log_uniform(0.01, 100)) if several else 1
        damper = {
            "mass_ratio": nu,
            "restitution": self.one_of(0, 1, 0.5, 0.6, 0.6, math.exp(-math.pi * math.sqrt(nu)), self.uniform(0, 1)),
            "wall_stiffness": self.one_of(1e4, 1e4, 100, max(nu, 1e-6), 1, max(nu / (1 + nu) ** 2, 1e-6), self.log_uniform(1, 1e10)),
            "y0": clearance * self.one_of(0, 0, 1, 1, 0.5, 0.25, self.uniform(0, 1)),
            "w0": self.one_of(0, 0, 0, self.sign(), self.uniform(-5, 5), 1e-6 * self.sign())}
        if several:
            damper["clearance"] = clearance
        elif engine != "restitution" and self.chance(0.1):  # a wall pressed in
            damper["y0"] = self.one_of(-0.25, 1.25, -1e-9)
        return damper

    def scene(self, engine, forced, several):
        """Numbers as in use beside those at which events coincide or derivatives vanish."""
        dampers = [self.damper(engine, several) for _ in range(self.one_of(1, 2, 2, 3, 5) if several else 1)]
        if several and self.chance(0.3):  # alike
            dampers = [dict(dampers[0]) for _ in dampers]
        nu = dampers[0]["mass_ratio"]
        zeta = self.one_of(0, 0, self.log_uniform(1e-4, 0.1), self.log_uniform(1e-3, 3), 0.5, math.sqrt(0.5),
                           math.sqrt(3) / 2, 1, math.sqrt(1 + nu))
        scene = {"damping_ratio": zeta,
                 "x0": self.one_of(0, 0, 1, 0.5, 0.25, 2, 6, self.uniform(0, 10)) * self.sign(),
                 "v0": self.one_of(0, 0, 0, self.sign(), self.uniform(-5, 5)),
                 "until_time": self.one_of(3, 10, 4 * math.pi, self.uniform(1, 60))}
        if forced:
            k = dampers[0]["wall_stiffness"]
            resonances = [1, math.sqrt(1 / (1 + nu)), math.sqrt(k), math.sqrt(k * (1 + nu) / nu)]
            scene["force_amplitude"] = self.one_of(0.05, 0.25, 1, self.log_uniform(1e-3, 3))
            scene["force_frequency"] = self.one_of(1, 1, 0.5, 2, self.uniform(0.5, 1.5), self.log_uniform(0.1, 10),
                                                   min(self.one_of(*resonances), 30))
            force = scene["force_amplitude"] * scene["force_frequency"]
        if self.chance(0.2):  # at rest in the cavity, where derivatives vanish
            scene["v0"] = force if forced else self.one_of(0, 1)
            scene["x0"] = -2 * zeta * scene["v0"]
            for damper in dampers:
                damper["w0"] = 0
        elif self.chance(0.2) and not several and abs(scene["x0"]) <= 1:  # a wall is met where x comes to zero
            dampers[0]["y0"] = -scene["x0"] if scene["x0"] < 0 else 1 - scene["x0"]
        if self.chance(0.1):
            scene["until_amplitude"] = self.log_uniform(0.01, 5)
        scene.update({"dampers": dampers} if several else dampers[0])
        return scene

    def scene_in_units(self):
        """A free decay that the secondary mass damps, as design and compare take it."""
        mass = self.log_uniform(0.1, 1000)
        clearance = self.log_uniform(0.1, 50)
        scene = {"mass": mass, "stiffness": mass * (2 * math.pi * self.log_uniform(0.5, 50)) ** 2,
                 "damping_ratio": self.one_of(0, 0.002, self.log_uniform(1e-4, 0.05)),
                 "secondary_mass": mass * self.log_uniform(0.005, 0.2), "clearance": clearance,
                 "restitution": self.one_of(0, 1, 0.6, self.uniform(0, 1)),
                 "initial_displacement": clearance * self.log_uniform(0.3, 15)}
        if self.chance(0.3):
            scene["contact_stiffness"] = scene["stiffness"] * self.log_uniform(10, 1e6)
        if self.chance(0.3):
            scene["secondary_displacement"] = clearance * self.one_of(1, 0.5, self.uniform(0, 1))
        scene["until_millimetres"] = scene["initial_displacement"] * self.uniform(0.02, 0.5)
        return scene

    def engine(self, *names, steps=100_000):
        """Words for one of these engines; `steps` of the component element method bound a run."""
        engine = self.one_of(*names)
        self.add("--engine", engine)
        if engine != "restitution" and self.chance(0.3):
            self.add("--calibration", "two-body")
        if engine == "cem":
            if self.chance(0.3):
                self.add("--locate")
            if self.chance(0.3):
                self.add("--stuck", "paper")
            if self.chance(0.3):
                self.add("--large-step", 0.05)
            if self.chance(0.2):
                self.add("--damper", "lagged")
        # A run is short. One that would not be ends early, which is one more way to end.
        self.add("--max-steps", steps if engine == "cem" else 100_000, "--max-impacts", self.one_of(50, 1000), "--max-half-cycles", 200,
                 "--threads", self.one_of(1, 1, 2))
        return engine

    # Commands

    def run(self, several=False):
        self.add("run")
        scene = self.scene(self.engine(*ENGINES), self.chance(0.5), several)
        self.add("--scene", self.file("scene.json", scene), "--record", "half_cycles,impacts,contacts,energy,history",
                 "--history", f"0:{scene['until_time']}:101")
        if self.chance(0.2):
            self.add("--members", 3)
        self.output("out.json", "run")

    def lists(self):
        self.one_of(lambda: self.run(True), lambda: self.response_sweep(True), lambda: self.report(True))()

    def report(self, several=False):
        self.add("report")
        engine = self.engine(*ENGINES, steps=20_000)
        scene = self.scene(engine, self.chance(0.3), several)
        scene["until_time"] = min(scene["until_time"], 20)
        self.add("--scene", self.file("scene.json", scene), "--without-figures", "--members", self.one_of(1, 2, 3))
        self.output("out.html", "page")

    def response(self, what, several=None):
        self.add("response", what)
        engine = self.engine("exact", "restitution")
        scene = self.scene(engine, True, self.chance(0.25) if several is None else several)
        scene.pop("until_amplitude", None)
        scene["force_frequency"] = max(scene["force_frequency"], 0.5)  # eight periods of it are a run
        self.add("--scene", self.file("scene.json", scene))
        return scene

    def written(self, kind):
        if self.chance(0.3):
            self.add("--format", "csv")
            kind = "table"
        self.output("out.csv" if kind == "table" else "out.json", kind)

    def range_of(self, scene, name, factors=(1.1, 1.3)):
        begin = scene[name]
        return f"{name}={begin}:{begin * self.one_of(*factors)}"

    def response_sweep(self, several=None):
        scene = self.response("sweep", several)
        self.add("--vary", self.range_of(scene, self.one_of("force_frequency", "force_amplitude")) + ":3",
                 "--max-periods", 200, "--mean-periods", 20)
        self.written("response")

    def basin(self):
        self.response("basin")
        self.add("--vary", f"x0=-1:{self.one_of(1, 0.5)}:3", "--vary", f"v0={self.one_of(-1, 0)}:1:2", "--max-periods", 100)
        self.written("response")

    def orbits(self):
        scene = self.response("orbits", self.chance(0.15))
        name = self.one_of("force_frequency", "force_frequency", "force_amplitude")
        if self.chance(0.7):  # where steady motions are, and bifurcations of them
            scene.update(damping_ratio=self.uniform(0.01, 0.1), force_frequency=self.uniform(0.7, 1.2),
                         force_amplitude=self.log_uniform(0.03, 0.3), x0=0, v0=0)
            for damper in scene.get("dampers", [scene]):
                damper.update(mass_ratio=self.log_uniform(0.02, 0.2), restitution=self.uniform(0.2, 0.8),
                              wall_stiffness=self.log_uniform(100, 1e4))
            self.file("scene.json", scene)
        self.add("--vary", self.range_of(scene, name, (0.75, 0.75, 0.9, 1.3)), "--max-points", self.one_of(60, 150, 150), "--max-branches", 10,
                 "--max-periods", 500, "--longest-period", self.one_of(4, 16, 16))
        self.written("response")

    def lyapunov(self):
        self.response("lyapunov")
        threads = self.words.index("--threads")
        del self.words[threads:threads + 2]
        self.add("--periods", self.one_of(10, 50), "--discard", self.one_of(0, 5))
        self.written("response")

    def sweep(self):
        self.add("sweep")
        forced = self.chance(0.4)
        several = self.chance(0.25)
        engine = self.engine(*(ENGINES[:2] if forced else ENGINES))
        scene = self.scene(engine, forced, several)
        self.add("--scene", self.file("scene.json", scene))
        varied = ["damping_ratio=0,1e-12,0.5,1", "x0=-1,0,6", "v0=0:1:2"]
        varied += ["clearance_1=0.5,1"] if several else ["mass_ratio=0.01:1:3:log", "restitution=0,0.5,1", "y0=0,0.5,1"]
        for each in self.random.sample(varied, self.one_of(1, 2)):
            self.add("--vary", each)
        level = self.log_uniform(0.01, 5)
        kept = ["impacts", "largest_impact_speed", f"time_to_amplitude={level}", "impact_energy_share"]
        if not forced:
            kept += [f"loss_factor_at={level}", "largest_loss_factor", "amplitude_of_largest_loss_factor",
                     "lowest_amplitude_above_loss=0.01", "highest_amplitude_above_loss=0.02"]
        elif not several:
            kept += ["steady_amplitude", "steady_period", "transient_periods", "impacts_per_period", "lyapunov_exponent"][:self.one_of(0, 0, 5)]
        self.add("--keep", ",".join(self.random.sample(kept, self.random.randint(1, len(kept)))))
        self.output("out.csv", "sweep")

    def design(self):
        self.add("design")
        scene = self.scene_in_units()
        scene.pop("secondary_displacement", None)  # the release is at the left wall
        mass, begin = scene["mass"], scene["initial_displacement"]
        lowest = begin * self.uniform(0.1, 0.6)
        self.add("--scene", self.file("scene.json", scene), "--to", lowest)
        if self.chance(0.3):
            self.add("--dampers", self.one_of(1, 2, 4))
            self.output("out.json", "scene")
            return
        self.engine("exact", "exact", "restitution", "restitution", "cem", steps=3000)
        cycle = 2 * math.pi * math.sqrt(mass / scene["stiffness"])
        self.add("--within", cycle * self.log_uniform(2, 20), "--neighbours", 100, "--seed", self.random.randint(0, 10**15))
        if self.chance(0.8):  # a small area is soon searched
            light, tight = mass * self.log_uniform(0.01, 0.2), lowest * self.log_uniform(0.3, 3)
            self.add("--secondary-mass", f"{light}:{light * self.uniform(1.02, 1.5)}",
                     "--clearance", f"{tight}:{tight * self.uniform(1.02, 1.5)}")
        if self.chance(0.5) and 0.1 <= scene["restitution"] <= 0.9:
            self.add("--tolerance", "restitution=0.1")
        else:
            self.add("--tolerance", self.one_of("clearance=10%", "secondary_mass=2%"))
        self.output("out.json", "design")

    def compare(self):
        self.add("compare")
        scene = self.scene_in_units()
        self.add("--scene", self.file("scene.json", scene))
        self.engine("exact", "exact", "restitution", "restitution", "cem", steps=20_000)
        # A decay in a straight line that goes over into an exponential one, noise, and at times what records have.
        omega = math.sqrt(scene["stiffness"] / scene["mass"])
        step = 2 * math.pi / omega / self.uniform(21, 60)
        amplitude, slope = scene["initial_displacement"], self.uniform(0.001, 0.02)
        noise = self.one_of(0, 1e-3, 1e-2) * amplitude
        head = self.one_of("t_s,x_mm", "t_s,x_mm", "t_s,a_m_per_s2")
        factor = 1 if "x_mm" in head else -omega * omega / 1000
        rows = [head]
        for i in range(self.random.randint(150, 1500)):
            now = amplitude * max(1 - slope * omega * step * i, 0.02 * math.exp(-0.01 * omega * step * i))
            rows.append(f"{step * i:.9g},{factor * (now * math.cos(omega * step * i) + self.random.gauss(0, noise)):.9g}")
        if self.chance(0.1):
            del rows[self.random.randrange(1, len(rows))]
        self.add("--measured", self.file("record.csv", "\n".join(rows) + "\n"), "--fit",
                 self.one_of("none", "none", "restitution"))
        self.output("out.json", "comparison")


# Each has the same time.
COMMANDS = {"orbits": lambda case: case.one_of(case.orbits, case.orbits, case.orbits, case.lyapunov)(), "basin": Case.basin,
            "sweep": lambda case: case.one_of(case.sweep, case.response_sweep)(), "design": Case.design,
            "compare": Case.compare, "report": Case.report, "run": Case.run, "lists": Case.lists}


# What a command writes

def validators():
    read = {path.name.split(".")[0]: (path, json.loads(path.read_text(encoding="utf-8")))
            for path in (SOURCE / "data/schema").glob("*.json")}
    return {name: Draft7Validator(schema, resolver=RefResolver(path.as_uri(), schema))
            for name, (path, schema) in read.items()}


VALIDATORS = validators()
VALIDATING = threading.Lock()  # a resolver of references is one thread's at a time


def no_number(word):
    raise ValueError(f"{word} in JSON")


class Page(html.parser.HTMLParser):
    EMPTY = {"meta", "link", "br", "hr", "img", "input", "col", "wbr", "path", "line", "rect", "circle", "use"}

    def __init__(self):
        super().__init__()
        self.open, self.faults = [], []

    def handle_starttag(self, tag, attrs):
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag in self.EMPTY:
            return
        if not self.open or self.open.pop() != tag:
            self.faults.append(f"</{tag}> closes nothing")

    def handle_data(self, data):
        if not self.open or self.open[-1] not in ("script", "style"):
            found = re.search(r"(?<![A-Za-z])(nan|inf|infinity)(?![A-Za-z])", data, re.I)
            if found:
                self.faults.append(f"\"{data.strip()[:80]}\"")


def examined(text, kind):
    """What is wrong with it."""
    if kind == "page":
        page = Page()
        page.feed(text)
        page.close()
        whole = text.lstrip().lower().startswith("<!doctype html") and text.rstrip().endswith("</html>")
        return page.faults[:3] + [f"<{tag}> is left open" for tag in page.open[:3]] + ([] if whole else ["not a whole page"])
    if kind in ("table", "sweep"):
        rows = [row for row in csv.reader(io.StringIO(text)) if row and not row[0].startswith("#")]
        faults = [] if rows and rows[0] else ["an empty table"]
        faults += [f"a row of {len(row)} cells below {len(rows[0])}: {row}" for row in rows if len(row) != len(rows[0])]
        faults += [f"the cell {cell}" for row in rows for cell in row if re.fullmatch(r"[+-]?(nan|inf|infinity)", cell, re.I)]
        return faults[:3]
    try:
        content = json.loads(text, parse_constant=no_number)
    except ValueError as error:
        return [str(error)]
    with VALIDATING:
        return [place for error in VALIDATORS[kind].iter_errors(content) for place in places_of(error)][:3]


def places_of(error):
    """Of alternatives that all fail, what is wrong with the one that fails deepest in the file."""
    while error.context:
        error = max(error.context, key=lambda each: len(each.absolute_path))
    return [f"/{'/'.join(map(str, error.absolute_path))}: {error.message[:200]}"]


class Tally:
    def __init__(self):
        self.codes, self.longest, self.failed, self.invalid = collections.Counter(), (0, None), 0, {}


def run_case(case, timeout):
    """Exit code (absent after a time-out), seconds, what is wrong, and the first line of what it says."""
    shutil.rmtree(case.folder, ignore_errors=True)
    case.folder.mkdir(parents=True)
    for name, text in case.files.items():
        (case.folder / name).write_text(text, encoding="utf-8")
    begin = time.monotonic()
    # What a coverage build counts is for the tests that are the same each time.
    process = subprocess.Popen([str(program), *case.words], cwd=case.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               env=dict(SETTINGS, GCOV_PREFIX=str(case.folder / "counts")), stdin=subprocess.DEVNULL)
    try:
        out, err = (each.decode("utf-8", "replace") for each in process.communicate(timeout=timeout))
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None, timeout, [f"not done after {timeout} s"], ""
    seconds, code, faults = time.monotonic() - begin, process.returncode, []
    if code < 0:
        faults.append(f"ended by {signal.Signals(-code).name}")
    if re.search(r"Sanitizer|runtime error:", err):
        faults.append("a sanitizer's report:\n" + "\n".join(err.splitlines()[:40]))
    elif code > 5:
        faults.append(f"exit code {code}")
    elif code > 0 and not (err.strip() or (code == 1 and out.strip())):
        faults.append(f"exit code {code} without a message")
    if re.search(r"(?<![A-Za-z])(nan|inf)(?![A-Za-z])", out + err, re.I):
        faults.append("NaN or infinity in the text: " + (out + err)[:400])
    for name, kind in case.outputs.items():
        path = case.folder / name
        if path.exists() and path.is_file():
            faults += [f"{name}: {fault}" for fault in examined(path.read_text(encoding="utf-8"), kind)]
        elif code == 0:
            faults.append(f"{name} is missing")
    if not faults:
        shutil.rmtree(case.folder)
    elif code > 1:
        faults.append(err[:400])
    return code, seconds, faults, err.partition("\n")[0]


def line_of(case):
    """What repeats it."""
    folder = shlex.quote(str(case.folder))
    return f"cd {folder} && {shlex.quote(str(program))} {shlex.join(case.words)}"


def examine(command):
    tally, begin, number = Tally(), time.monotonic(), 0
    while (number < options.count) if options.count else (time.monotonic() - begin < options.seconds):
        nth = number if only[command] is None else only[command]
        case = Case(options.seed, command, nth, options.folder / f"{command}-{nth}")
        code, seconds, faults, said = run_case(case, options.timeout)
        tally.codes["time-out" if code is None else code] += 1
        tally.longest = max(tally.longest, (seconds, nth))
        if code in (2, 3, 5):
            tally.invalid.setdefault(re.sub(r"[0-9.e+-]+", "#", said), f"  {command}:{nth}: {said}")
        if faults:
            tally.failed += 1
            scene = "".join(f"\n    {name}: {text if len(text) < 2000 else '(long)'}" for name, text in case.files.items())
            print(f"FAILED {command}:{nth} --seed {options.seed}\n  " + "\n  ".join(faults) +
                  f"\n  {line_of(case)}{scene}", flush=True)
        number += 1
        if only[command] is not None:
            break
    invalid = tally.codes[2] + tally.codes[3] + tally.codes[5]
    few = number >= 8 and invalid * 2 > number
    if tally.invalid and (options.verbose or few):
        print(*tally.invalid.values(), sep="\n")
    codes = ", ".join(f"{count} x {code}" for code, count in sorted(tally.codes.items(), key=str))
    print(f"{command}: {number} cases, exit codes {codes}; longest {tally.longest[0]:.1f} s (number {tally.longest[1]}), "
          f"{tally.failed} failed" + ("; FAILED: most are not valid input" if few else ""), flush=True)
    return tally.failed + few


# By the number of the case, which the folder it runs in is named after.
WAYS = ["echo 'no design was found' >&2; exit 1",  # allowed
        "kill -SEGV $$",
        "echo '==1==ERROR: AddressSanitizer: heap-buffer-overflow' >&2; exit 1",
        "echo 'orbits.cpp:1:1: runtime error: index out of bounds' >&2; exit 1",
        "exit 4",
        "echo 'this code is not documented' >&2; exit 99",
        "echo '{\"x\": NaN}' > out.json; printf 'x\\nnan\\n' > out.csv",
        "echo '{\"x\": 1}' > out.json; printf 'x\\n1,2\\n' > out.csv",
        "true",  # no file
        "exec sleep 60"]


def planted(folder):
    """Whether each way is noticed: the program is a script that fails in each of them."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    program = folder / "program"
    program.write_text("#!/bin/sh\ncase ${PWD##*-} in\n" + "".join(f"{n}) {way} ;;\n" for n, way in enumerate(WAYS)) + "esac\n")
    program.chmod(0o755)
    done = subprocess.run([sys.executable, "-B", __file__, program, folder / "cases", "--only", "run", "--count", str(len(WAYS)),
                           "--timeout", "3", "--seed", "any"], capture_output=True, text=True)
    failed = [int(number) for number in re.findall(r"^FAILED run:(\d+)", done.stdout, re.MULTILINE)]
    print(done.stdout, done.stderr)
    return done.returncode == 1 and failed == list(range(1, len(WAYS)))


if sys.argv[1:2] == ["--planted"]:
    sys.exit(not planted(pathlib.Path(sys.argv[2]).resolve()))
parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
for word in ("program", "folder"):
    parser.add_argument(word, type=lambda text: pathlib.Path(text).resolve())
parser.add_argument("--seconds", type=float, default=120)
parser.add_argument("--count", type=int)
parser.add_argument("--timeout", type=float, default=600)
for option in ("--seed", "--only"):
    parser.add_argument(option)
parser.add_argument("--verbose", action="store_true", help="say why cases were not valid")
options = parser.parse_args()
program = options.program
if options.seed is None:
    tree = subprocess.run(["git", "-C", str(SOURCE), "rev-parse", "--short=12", "HEAD:src"], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True, check=False).stdout.strip()
    options.seed = tree or str(time.time_ns())
only = {}
for word in (options.only or ",".join(COMMANDS)).split(","):
    name, _, number = word.partition(":")
    if name not in COMMANDS:
        sys.exit(f"{name} is none of {', '.join(COMMANDS)}")
    only[name] = int(number) if number else None
print(f"seed {options.seed}, {len(only)} commands, " +
      (f"{options.count} cases each" if options.count else f"{options.seconds:g} s each"), flush=True)
with concurrent.futures.ThreadPoolExecutor(2) as pool:
    failed = sum(pool.map(examine, only))
sys.exit(bool(failed))
