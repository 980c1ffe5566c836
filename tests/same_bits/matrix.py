#!/usr/bin/env python3
"""The same bits: run files, tables and figures, whatever the program was built with and wherever it runs.

    matrix.py BUILD [--without-clang] [--only NAMES] [--brief]

BUILD is the project's build folder with the program in it, by g++ -O3, whose results all others are held against. More
programs are built below BUILD/same_bits, kept for the next time; that for WebAssembly is the one of `make wasm`. For
this processor there are five: {g++, clang++} x
{-O3 -march=native, -O2 with link-time optimisation}, and g++ -O0. The three other combinations would run nothing new:
link-time optimisation has the passes of -O2 and sees more at once, and what clang++ evaluates in another order than g++
it does so at any level. For other machines there are four: aarch64, riscv64 and s390x, whose bytes have the other order,
run by qemu; and WebAssembly, run by node. What is crossed with what:

    for this processor  x {at home, without the processor's FMA and AVX2 and in all surroundings at once: time zone,
                           comma locale, folder, ~/.gnuplot}
    for other machines  x at home
    one of them         x each of the four surroundings by itself, and all at once with the processor as it is
                          (clang++ -O3 -march=native)
    the project's own   x processor features {as they are, without FMA and AVX2} x {at home, all surroundings at once}
    pictures            gnuplot is no part of a build, so they are drawn from the tables that by then are the same for
                        all programs, once in each of the four surroundings, once in all at once without FMA and AVX2

Each time all three engines run all scenes of the catalogue and those in scenes/ (forced and damped, the component
element method also with its other ways to step), the catalogue's responses are found with fewer points and periods,
all tables are made, and the runs in BUILD/runs/exact get their verdicts. The heap is filled with rubbish where the
surroundings are strange, and at -O0 so are variables that nobody set: what reads them shows.

With --brief there are three builds: the project's own, clang++'s with sanitizers, which is that of `make sanitize`, and
s390x. No surrounding is by itself, and the two others are of the library alone, with again.cpp: they simulate anew what
is in the run and response files of the project's own build, and make no table, verdict or sweep. Of an ensemble they run
the first member: the others differ from it by their release alone. Of the catalogue's further runs and responses whose names
differ by a number, s390x runs the first.

Exit code 0 if no byte differs but in `provenance`, 1 if any does, 2 if something for the test is missing.
"""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from differences import compare_files

SOURCE = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent

VERSION = re.search(r"project\(impact-damper VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]
OWN = "the project's own build"
LTO = "-DCMAKE_INTERPROCEDURAL_OPTIMIZATION=ON"
# What CMake is called with. Variables that nobody set hold a pattern at -O0, where otherwise they would often be zero.
BUILDS = {
    "g++ -O0": ["-DCMAKE_CXX_FLAGS=-O0 -ftrivial-auto-var-init=pattern"],
    "g++ -O3 -march=native": ["-DCMAKE_CXX_FLAGS=-O3 -march=native"],
    "g++ -O2 with LTO": ["-DCMAKE_CXX_FLAGS=-O2", LTO],
    "clang++ -O3 -march=native": ["-DCMAKE_CXX_FLAGS=-O3 -march=native"],
    "clang++ -O2 with LTO": ["-DCMAKE_CXX_FLAGS=-O2", LTO, "-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=lld"],
}
BUILDS = {name: [f"-DCMAKE_CXX_COMPILER={name.split()[0]}", "-DCMAKE_BUILD_TYPE=None", *options]
          for name, options in BUILDS.items()}
SANITIZED = "clang++ -O2 with sanitizers"
BUILDS[SANITIZED] = ["--preset", "sanitize"]  # as `make sanitize`
LINUX = ["aarch64", "riscv64", "s390x"]
BUILDS |= {name: ["--toolchain", SOURCE / "src/toolchains/linux.cmake", f"-DMACHINE={name}"] for name in LINUX}
BUILDS["WebAssembly"] = ["--toolchain", SOURCE / "src/toolchains/wasm.cmake", "-DCMAKE_BUILD_TYPE=MinSizeRel"]  # as `make wasm`
# What runs the programs of other machines.
RUNNERS = {**{name: [f"qemu-{name}"] for name in LINUX}, "WebAssembly": ["node"]}
BRIEF = [SANITIZED, "s390x"]
EACH_SURROUNDING_BY_ITSELF = "clang++ -O3 -march=native"
FEATURES = {"": {}, "without FMA and AVX2": {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-AVX2,-FMA4"}}
SURROUNDINGS = ["time zone", "comma locale", "folder", "~/.gnuplot"]
ENGINES = ["exact", "restitution", "cem"]
# The component element method's other ways, on the small scenes.
WAYS = {"exact": [[], ["--calibration", "two-body"]], "restitution": [[]],
        "cem": [[], ["--locate", "--large-step", "0.05", "--calibration", "two-body"], ["--damper", "lagged"]]}
MEMBERS_OF_CLAIMS = 8  # of each ensemble: half of them, and the verdicts are the same
RECORD = ["--record", "half_cycles,impacts,contacts,energy,history", "--history", "0:150:301"]


class Setting(NamedTuple):
    """One cell of the matrix: a program, and what surrounds it."""
    program: Path
    build: str  # its name in BUILDS
    features: str = ""
    surroundings: tuple = ()

    def __str__(self):
        return ", ".join([self.build] + ([self.features] if self.features else []) +
                         ([" + ".join(self.surroundings)] if self.surroundings else []))


class Places(NamedTuple):
    work: Path     # the matrix's own folder
    locales: Path  # where de_DE.UTF-8 is
    home: Path     # of another user
    runs: Path     # that verdicts are about

    def environment(self, features: str, surroundings) -> dict:
        kept = {name: os.environ[name] for name in ("PATH", "HOME", "TMPDIR") if name in os.environ}
        kept.update(FEATURES[features])
        if "time zone" in surroundings:
            kept["TZ"] = "<+1245>-12:45<+1345>,M9.5.0,M4.1.0"
        if "comma locale" in surroundings:
            kept.update(LC_ALL="de_DE.UTF-8", LANG="de_DE.UTF-8", LOCPATH=str(self.locales))
        if "~/.gnuplot" in surroundings:
            kept.update(HOME=str(self.home), GNUTERM="dumb")
        if surroundings:
            kept["MALLOC_PERTURB_"] = "165"
        return kept

    def folder(self, surroundings) -> Path:
        """Where commands run: what they read lies in data/, figures/ and tests/ below it."""
        return self.work / "Übung 2; copy" if "folder" in surroundings else SOURCE


def say(text: str):
    print(f"same bits: {text}", file=sys.stderr, flush=True)


def missing(text: str):
    say(text)
    sys.exit(2)


def call(command, **options) -> str:
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, errors="replace", **options)
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def build(work: Path, name: str, target: str) -> Path:
    folder = {"WebAssembly": work.parent / "wasm", SANITIZED: work.parent / "sanitize"}.get(
        name, work / re.sub(r"[^\w+]+", "-", name))
    call(["cmake", "-S", SOURCE, "-B", folder, "-G", "Ninja", *BUILDS[name]])
    call(["cmake", "--build", folder, "--target", target, "-j1"])
    say(f"built {name}")
    return folder / "src" / ("impact-damper.js" if name == "WebAssembly" else target)


def tools_of(name: str) -> list:
    if name in LINUX:
        return [f"{name}-linux-gnu-g++", *RUNNERS[name]]
    if name == "WebAssembly":
        return ["em++", *RUNNERS[name]]
    return [name.split()[0]] + ["ld.lld"] * name.startswith("clang++")


def make_places(work: Path, runs: Path) -> Places:
    places = Places(work, work / "locales", work / "another user", runs)
    places.home.mkdir(parents=True, exist_ok=True)
    shutil.copy(HERE / "hostile.gnuplot", places.home / ".gnuplot")
    other = places.folder(["folder"])
    for part in ("data/scenes", "figures", "tests/same_bits/scenes"):
        shutil.copytree(SOURCE / part, other / part, dirs_exist_ok=True)
    shutil.copy(SOURCE / "data/claims.json", other / "data")
    if not (places.locales / "de_DE.UTF-8").exists():
        if not shutil.which("localedef") or not Path("/usr/share/i18n/locales/de_DE").exists():
            missing("there is no locale de_DE to make: make deps-check installs it")
        places.locales.mkdir(exist_ok=True)
        call(["localedef", "-i", "de_DE", "-f", "UTF-8", places.locales / "de_DE.UTF-8"])
    ask = "import locale; locale.setlocale(locale.LC_ALL, ''); print(locale.localeconv()['decimal_point'])"
    if call([sys.executable, "-c", ask], env=places.environment("", ["comma locale"])).strip() != ",":
        missing(f"the locale de_DE.UTF-8 in {places.locales} writes no comma")
    return places


def small_catalogues(work: Path) -> dict:
    """The catalogue with shorter responses, and with ensembles of two for the component element method, which takes a
    hundred times as long."""
    catalogue = json.loads((SOURCE / "figures/catalogue.json").read_text())
    catalogue["members"] = 2  # of runs that figures draw
    for entry in catalogue["responses"]:
        for axis in entry["vary"]:
            if "count" in axis:
                axis["count"] = min(axis["count"], 5)
        rule = entry.setdefault("rule", {})
        for name in {"max_periods", "mean_periods"} & rule.keys():
            rule[name] = min(rule[name], 200)
        if entry["kind"] == "orbits":
            rule |= {"max_points": 60, "max_branches": 3}
    paths = {}
    for engine in ENGINES:
        text = json.dumps(catalogue, ensure_ascii=False, indent=1)
        paths[engine] = work / f"catalogue-{engine}.json"
        paths[engine].write_text(re.sub(r'"ensemble": \d+', '"ensemble": 2', text) if engine == "cem" else text)
    for plan in plans_of(catalogue):  # beside them; two releases are as good as many
        (work / plan).write_text(re.sub(r'"count": \d+', '"count": 2', (SOURCE / "figures" / plan).read_text()))
    return paths


def plans_of(catalogue: dict) -> list:
    return sorted({figure["plan"] for figure in catalogue["figures"] if "plan" in figure})


# The words that the commands `run` and `response` take for entries of the catalogue, as figures/CMakeLists.txt has them.
def rerun(entry: dict, scenes) -> list:
    """Of the catalogue's further runs; `scenes` is the folder of the scenes."""
    engine = dict(entry.get("engine", {"name": "exact"}))
    words = ["run", "--scene", f"{scenes}/{entry['scene']}.json", "--engine", engine.pop("name"),
             *(["--stuck", "paper"] if "stuck_speed" in engine else []), "--record", ",".join(entry["record"])]
    for key, value in {**entry.get("set", {}), **engine}.items():
        words += ["--" + key.replace("_", "-")] + ([] if value is True else [str(value)])
    return words


def drawn_runs(catalogue: dict) -> list:
    """Those further runs that figures draw."""
    names = {curve[key] for figure in catalogue["figures"] for curve in figure.get("curves", [])
             for key in ("run", "alone") if key in curve}
    return [entry for entry in catalogue["runs"] if entry["name"] in names]


def respond(entry: dict, scenes) -> list:
    """Of the catalogue's responses."""
    words = ["response", entry["kind"], "--scene", f"{scenes}/{entry['scene']}.json", "--quiet"]
    for options in (entry.get("set", {}), entry.get("rule", {}), entry.get("engine", {})):
        words += [f"--{'engine' if name == 'name' else name.replace('_', '-')}={value}" for name, value in options.items()]
    for axis in entry["vary"]:
        count = f":{axis['count']}" if "count" in axis else ""
        words.append(f"--vary={axis['number']}={axis['from']}:{axis['to']}{count}")
    return words + [f"--start={s['x']}:{s['v']}:{s['y']}:{s['w']}" for s in entry.get("start", [])]


def run_again(setting: Setting, places: Places, reference: Path, results: Path):
    """The same runs and responses by the library alone: what is in the files below `reference`, simulated anew."""
    shutil.rmtree(results, ignore_errors=True)
    catalogue = json.loads((SOURCE / "figures/catalogue.json").read_text())
    below = {entry["scene"]: [f"below:{w['amplitude']}:{w['length']}:{w['count']}" for w in entry.get("history_below", [])]
             for entry in catalogue["scenes"]}
    copied = {entry["name"] for kind in ("runs", "responses") for entry in catalogue[kind]}
    jobs, seen = [], set()
    for file in sorted(reference.glob("*/runs/*.json")):
        name, own = file.relative_to(reference), file.stem
        if own.endswith(".csv") or own in copied and name.parts[0] != ENGINES[0]:
            continue
        small = [scene for scene in (HERE / "scenes").glob("*.json") if re.fullmatch(re.escape(scene.stem) + r"(-\d)?", own)]
        kind = re.sub(r"\d+$", "", own)
        # Another machine's program takes thirty times as long, and the component element method a hundred times.
        if setting.build in RUNNERS and (name.parts[0] == "cem" and not small or own in copied and kind in seen):
            continue
        seen.add(kind)
        windows = ["0:150:301"] if small else below.get(own, [])
        (results / name).parent.mkdir(parents=True, exist_ok=True)
        jobs.append([file, results / name, *(small or ["-"]), *windows])
    parts = os.cpu_count() if setting.build in RUNNERS else 1  # another machine's program takes minutes

    def run_part(part):
        call([*RUNNERS.get(setting.build, []), setting.program], cwd=places.folder(setting.surroundings),
             env=places.environment(setting.features, setting.surroundings),
             input="".join("\t".join(map(str, job)) + "\n" for job in jobs[part::parts]))

    with ThreadPoolExecutor(parts) as pool:
        list(pool.map(run_part, range(parts)))


def run_all(setting: Setting, places: Places, catalogues: dict, results: Path):
    """All runs, tables and verdicts of one setting, below `results`."""
    shutil.rmtree(results, ignore_errors=True)
    options = {"cwd": places.folder(setting.surroundings),
               "env": places.environment(setting.features, setting.surroundings)}
    program = setting.program
    if "folder" in setting.surroundings:
        program = results / "bin" / "impact-damper"
        program.parent.mkdir(parents=True)
        # By another process: what this one has open for writing, its other threads' children have, too, and no
        # program starts from a file that somebody may write.
        call(["cp", setting.program, program])

    def ask(*words):
        call([*RUNNERS.get(setting.build, []), program, *words], **options)

    def once(engine, name, *words, beside=None):
        """Among the runs of each engine what the first one's command makes: a file, and what it leaves beside it."""
        first, runs = (results / each / "runs" for each in (ENGINES[0], engine))
        if engine == ENGINES[0]:
            return ask(*words, "-o", runs / name)
        for each in (name, beside)[:2 if beside else 1]:
            (shutil.copytree if (first / each).is_dir() else shutil.copy)(first / each, runs / each)

    for engine in ENGINES:
        runs, tables = results / engine / "runs", results / engine / "tables"
        runs.mkdir(parents=True)
        tables.mkdir()
        catalogue = json.loads(catalogues[engine].read_text())
        shown = [(curve["scene"], curve["ensemble"]) for figure in catalogue["figures"] for curve in figure.get("curves", [])
                 if "ensemble" in curve]
        for entry in catalogue["scenes"]:
            members = max((count for scene, count in shown if scene == entry["scene"]), default=1)
            windows = [["--history-below", f"{w['amplitude']}:{w['length']}:{w['count']}"]
                       for w in entry.get("history_below", [])]
            ask("run", "--scene", f"data/scenes/{entry['scene']}.json", "--engine", engine, "--record",
                ",".join(entry["record"]), *sum(windows, []), "--members", str(members), "-o", runs / f"{entry['scene']}.json")
        for scene in sorted((HERE / "scenes").glob("*.json")):
            for number, way in enumerate(WAYS[engine]):
                ask("run", "--scene", f"tests/same_bits/scenes/{scene.name}", "--engine", engine, *RECORD,
                    *way, "-o", runs / f"{scene.stem}{f'-{number}' if number else ''}.json")
        # Each with an engine of its own.
        for entry in drawn_runs(catalogue):
            once(engine, f"{entry['name']}.json", *rerun(entry, "data/scenes"), "--members", str(catalogue["members"]),
                 beside=f"{entry['name']}.members")
        for entry in catalogue["responses"]:
            once(engine, f"{entry['name']}.json", *respond(entry, "data/scenes"))
        for plan in plans_of(catalogue):
            once(engine, f"{Path(plan).stem}.csv", "sweep", catalogues[engine].with_name(plan), beside=f"{Path(plan).stem}.csv.json")
        ask("series", "--catalogue", catalogues[engine], "--runs", runs, "--threads", "1", "-o", tables)
    ask("verify", "--runs", places.runs, "--members", MEMBERS_OF_CLAIMS, "-o", results / "verdicts.json")
    for table in results.rglob("*.csv.json"):  # names the program, of which each is another
        table.unlink()


def draw_all(places: Places, features: str, surroundings, tables: Path, pictures: Path):
    """The pictures of all engines' tables, below `pictures`; `tables` are run_all's results."""
    shutil.rmtree(pictures, ignore_errors=True)
    environment = places.environment(features, surroundings) | {"SVG_ONLY": "1"}  # what is compared
    for engine in ENGINES:
        (pictures / engine).mkdir(parents=True)
        for figure in json.loads((SOURCE / "figures/catalogue.json").read_text())["figures"]:
            name = Path(figure["script"]).stem
            table = tables / engine / "tables" / f"{name}.dat"
            if not table.exists():
                if figure["table"] != "drawing":
                    raise RuntimeError(f"{table} is missing")
                table = "-"
                if engine != ENGINES[0]:
                    continue
            call(["figures/draw", f"figures/{figure['script']}", table, figure["title"], pictures / engine / name,
                  VERSION],
                 cwd=places.folder(surroundings), env=environment)


def held_against(reference: Path, results: Path, all_of=True) -> list:
    """What differs, as text; names are engine/runs/SCENE.json, engine/tables/figNN.dat, engine/figNN.svg, verdicts.json."""
    found = []
    names = {path.relative_to(root) for root in ([reference] if all_of else []) + [results] for kind in ("json", "dat", "svg")
             for path in root.rglob(f"*.{kind}")}
    for name in sorted(names):
        difference = compare_files(str(name), str(reference / name), str(results / name))
        if difference:
            found.append(str(difference))
    return found


def settings_of(programs: dict, brief: bool) -> list:
    usual, reduced = FEATURES
    at_home, all_at_once = (), tuple(SURROUNDINGS)
    cells = []
    for name, program in programs.items():
        chosen = [(usual, at_home)] + [(reduced, all_at_once)] * (name not in RUNNERS and name != SANITIZED)
        if name == OWN:
            chosen += [(usual, all_at_once), (reduced, at_home)]
        if name == EACH_SURROUNDING_BY_ITSELF and not brief:
            chosen += [(usual, all_at_once)] + [(usual, (each,)) for each in SURROUNDINGS]
        cells += [Setting(program, name, *each) for each in chosen]
    return cells


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("--without-clang", action="store_true", help="leave clang++ out, and say so")
    parser.add_argument("--only", metavar="NAMES", help="only builds whose name begins with one of these, set apart by commas, and say so")
    parser.add_argument("--brief", action="store_true", help="two other builds, of the library alone, and no surrounding by itself")
    arguments = parser.parse_args()
    own = arguments.build.resolve() / "src" / "impact-damper"
    if not own.exists():
        missing(f"{own} is missing: make build")
    runs = arguments.build.resolve() / "runs/exact"
    if not runs.exists():
        missing(f"{runs} is missing: make verify")
    offered = BRIEF if arguments.brief else [name for name in BUILDS if name != SANITIZED]
    wanted = [name for name in offered if not (arguments.without_clang and name.startswith("clang++")) and
              (not arguments.only or name.startswith(tuple(arguments.only.split(","))))]
    for tool in ["cmake", "ninja", "gnuplot"] + sum(map(tools_of, wanted), []):
        if not shutil.which(tool):
            missing(f"{tool} is missing: make deps-same-bits installs it" +
                    ("; --without-clang leaves its builds out" if tool in ("clang++", "ld.lld") else ""))
    begin = time.monotonic()
    work = arguments.build.resolve() / "same_bits"
    work.mkdir(exist_ok=True)
    places = make_places(work, runs)
    catalogues = small_catalogues(work)

    programs = {OWN: own}
    # Several builds at a time, each a step at a time: none waits for the last step of another.
    say(f"building {len(wanted)} programs")
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        made = pool.map(lambda name: build(work, name, "again" if arguments.brief else "impact-damper"), wanted)
    programs |= dict(zip(wanted, made))
    built = time.monotonic()

    cells = settings_of(programs, arguments.brief)
    reference = work / "results-0"
    run_all(cells[0], places, catalogues, reference)
    wrong = {}

    def examine(number):
        results = work / f"results-{number}"
        library = cells[number].program.name == "again"
        if library:
            run_again(cells[number], places, reference, results)
        else:
            run_all(cells[number], places, catalogues, results)
        found = held_against(reference, results, all_of=not library)
        if not found:
            shutil.rmtree(results)
        say(f"{number} of {len(cells) - 1}: {cells[number]}: " +
            (f"{len(found)} files differ" if found else "the same"))
        if found:
            wrong[str(cells[number])] = found

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(examine, sorted(range(1, len(cells)), key=lambda number: cells[number].build not in RUNNERS)))
    ran = time.monotonic()

    drawings = [("", ()), *(("", (each,)) for each in SURROUNDINGS if not arguments.brief), (list(FEATURES)[-1], tuple(SURROUNDINGS))]
    draw_all(places, *drawings[0], reference, work / "pictures-0")

    def examine_drawing(number):
        features, surroundings = drawings[number]
        draw_all(places, features, surroundings, reference, work / f"pictures-{number}")
        found = held_against(work / "pictures-0", work / f"pictures-{number}")
        name = "pictures, " + (" + ".join([features] * bool(features) + list(surroundings)))
        say(f"{name}: " + (f"{len(found)} files differ" if found else "the same"))
        if found:
            wrong[name] = found

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(examine_drawing, range(1, len(drawings))))
    drawn = time.monotonic()

    for name, found in wrong.items():
        print(f"\n{name}: {len(found)} files differ from {cells[0]}")
        for text in found[:3]:
            print("  " + text)
        if len(found) > 3:
            print(f"  and {len(found) - 3} more")
    files = sum(1 for kind in ("json", "dat") for path in reference.rglob(f"*.{kind}"))
    print(f"\nsame bits: {len(programs)} programs, {len(cells)} settings of {files} runs, tables and verdicts, "
          f"{len(drawings)} of {len(list((work / 'pictures-0').rglob('*.svg')))} pictures: " +
          (f"{len(wrong)} settings differ" if wrong else "no byte differs"))
    if arguments.without_clang:
        print("same bits: NOT COVERED: clang++, left out by --without-clang")
    if arguments.only:
        print(f"same bits: NOT COVERED: all builds whose names begin with none of {arguments.only}, left out by --only")
    if arguments.brief:
        print(f"same bits: NOT COVERED: builds other than {', '.join(BRIEF)}, tables, verdicts and sweeps by these, "
              "other members of ensembles, surroundings by themselves, left out by --brief")
    if "fma" not in Path("/proc/cpuinfo").read_text().split():
        print("same bits: NOT COVERED: this processor has no FMA to be switched off")
    say(f"built in {built - begin:.0f} s, ran in {ran - built:.0f} s, drew in {drawn - ran:.0f} s")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
