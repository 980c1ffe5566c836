#!/usr/bin/env python3
"""The package for browsers and node: installed from its tarball, its run files are the program's, byte for byte, and the
pages work: in the report the cited tables and verdicts are made anew.

    check.py BUILD

BUILD holds the figures of the exact engine, what they were made from and by, and wasm/; it is worked in BUILD/wasm/check, which is filled anew. Exit code
77: there is no node or no Chromium.
"""
import contextlib
import functools
import http.server
import json
import re
import shutil
import struct
import subprocess
import sys
import tarfile
import threading
import unittest
from math import sin
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
sys.dont_write_bytecode = True
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "same_bits")]
import browsers  # noqa: E402
from differences import compare_files  # noqa: E402

PROGRAM, TARBALL, WASM, WORK = None, None, None, None
CLOSED_FORM = [{"name": "exact"}, {"name": "restitution"}]
# The component element method takes a hundred times as long: it has only the shorter scenes.
ALL = CLOSED_FORM + [{"name": "cem", "time_step": 4e-4}]
SCENES = [(scene, engine) for folder, engines in (("data/scenes", CLOSED_FORM), ("tests/same_bits/scenes", ALL))
          for scene in sorted((SOURCE / folder).glob("*.json")) for engine in engines
          if engine["name"] == "cem" or '"law"' not in scene.read_text()]  # no other engine has laws of walls
PAGE = """<!doctype html>
<link rel="icon" href="data:,">
<title>The package in a browser</title>
<script type="module">
  import { run } from "./package/index.js";
  window.run = run;
</script>
"""
WINDOW = {"begin": 0, "end": 30, "count": 301}
WRONG = ["{", "[]", '{"mass_ratio": -1}', '{"x0": 1, "until_time": 1, "foo": 2}', '{"X0": 1, "until_time": 1}', '{"x0": "Übung", "until_time": 1}',
         '{"x0": 1, "until_time": 1e400}']


def call(*words, cwd=None) -> str:
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, cwd=cwd)
    if done.returncode:
        raise AssertionError(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def install(folder: Path):
    """As npm does for a package that needs no other; by npm where there is one."""
    folder.mkdir(parents=True)
    (folder / "package.json").write_text('{"name": "stranger", "private": true, "type": "module"}')
    if shutil.which("npm"):
        call("npm", "install", "--offline", "--no-audit", "--no-fund", TARBALL, cwd=folder)
        return
    print("no npm: the tarball is unpacked instead", file=sys.stderr)
    with tarfile.open(TARBALL) as tar:
        tar.extractall(folder / "node_modules")
    (folder / "node_modules/package").rename(folder / "node_modules/impact-damper")


def jobs(folder: Path) -> list:
    return [{"scene": scene.read_text(), "options": {"engine": engine, "history": WINDOW},
             "file": str(folder / f"{scene.stem}-{engine['name']}.json")} for scene, engine in SCENES]


def run_natively(folder: Path):
    folder.mkdir(parents=True)
    for scene, engine in SCENES:
        step = ["--time-step", str(engine["time_step"])] if "time_step" in engine else []
        call(PROGRAM, "run", "--scene", scene, "--engine", engine["name"], *step,
             "--record", "half_cycles,impacts,contacts,energy,history",
             "--history", f"{WINDOW['begin']}:{WINDOW['end']}:{WINDOW['count']}",
             "-o", folder / f"{scene.stem}-{engine['name']}.json")


def run_in_node(stranger: Path, folder: Path) -> str:
    folder.mkdir(parents=True)
    todo = stranger / "jobs.json"
    todo.write_text(json.dumps(jobs(folder)))
    shutil.copy(HERE / "runs.mjs", stranger)
    return call("node", "runs.mjs", todo, cwd=stranger)


def different(one: Path, other: Path) -> list:
    names = sorted(path.name for path in one.glob("*.json"))
    return [str(found) for found in (compare_files(name, str(one / name), str(other / name)) for name in names) if found]


def plant_wrong_bit(module: Path):
    """The last bit of the sine of 1/16 in the table that the module's sine begins with (elementary_tables.cpp)."""
    entry = struct.pack("<d", round(sin(1 / 16) * 2**52) / 2**52)
    data = module.read_bytes()
    if data.count(entry) == 0:
        raise AssertionError("the sine's table is not in the module")
    module.write_bytes(data.replace(entry, bytes([entry[0] ^ 1]) + entry[1:]))


class Served:
    """Files by HTTP on this machine: browsers load no module from a file."""

    def __init__(self, folder: Path):
        class Handler(http.server.SimpleHTTPRequestHandler):
            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=folder))
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        self.address = f"http://127.0.0.1:{self.server.server_port}"


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stranger = WORK / "stranger"
        install(cls.stranger)
        cls.package = cls.stranger / "node_modules/impact-damper"
        run_natively(WORK / "native")

    def test_in_node_run_files_are_the_programs(self):
        self.assertEqual(run_in_node(self.stranger, WORK / "node"), "")
        self.assertEqual(different(WORK / "native", WORK / "node"), [])
        self.assertEqual([file.name for file in (WORK / "node").glob("*.json") if str(SOURCE) in file.read_text()], [])

    def test_one_wrong_bit_in_the_sine_is_noticed(self):
        faulty = WORK / "faulty"
        shutil.copytree(self.stranger, faulty)
        plant_wrong_bit(faulty / "node_modules/impact-damper/impact-damper.wasm")
        run_in_node(faulty, WORK / "wrong")
        self.assertNotEqual(different(WORK / "native", WORK / "wrong"), [])

    def test_a_scene_is_rejected_in_the_programs_words(self):
        folder = WORK / "rejected"
        folder.mkdir()
        todo = [{"scene": text, "options": {}, "file": str(folder / f"{i}.txt")} for i, text in enumerate(WRONG)]
        (self.stranger / "wrong.json").write_text(json.dumps(todo))
        shutil.copy(HERE / "runs.mjs", self.stranger)
        call("node", "runs.mjs", "wrong.json", cwd=self.stranger)
        for i, text in enumerate(WRONG):
            with self.subTest(text):
                scene = folder / f"{i}.json"
                scene.write_text(text)
                done = subprocess.run([PROGRAM, "run", "--scene", scene], capture_output=True, text=True)
                kind, *words = (folder / f"{i}.txt").read_text().splitlines()
                self.assertEqual(kind, "invalid")
                self.assertEqual("\n".join(words), done.stderr.strip().replace(str(scene), "scene"))

    def test_a_module_for_one_damper_rejects_lists(self):
        script = """
          import { load, loadWithLists } from "impact-damper/core";
          const list = '{"x0": 1, "until_time": 9, "dampers": [{"mass_ratio": 0.01}, {"mass_ratio": 0.02}]}';
          const told = [(await load()).simulate('{"x0": 1, "until_time": 9}').end_time];
          for (const engine of ["exact", "restitution", "cem"]) {
            told.push((await loadWithLists()).simulate(list, { engine }).end_time);
            try {
              (await load()).simulate(list, { engine });
            } catch (error) {
              told.push([error.kind, error.message]);
            }
          }
          console.log(JSON.stringify(told));
        """
        (self.stranger / "lists.mjs").write_text(script)
        told = json.loads(call("node", "lists.mjs", cwd=self.stranger))
        words = ["invalid", "scene: this module knows no lists of dampers, friction, weight and drag, and no laws of walls and springs, impact-damper-lists.wasm does"]
        self.assertEqual(told, [9] + 3 * [9, words])

    def test_the_module_for_one_damper_is_small(self):
        script = ('const { brotliCompressSync } = require("zlib"), { readFileSync } = require("fs");'
                  'console.log(brotliCompressSync(readFileSync(process.argv[1])).length);')
        self.assertLess(int(call("node", "-e", script, self.package / "impact-damper.wasm")), 161_000)

    def test_the_example_prints_what_the_program_computes(self):
        shutil.copy(self.package / "example.mjs", self.stranger)
        printed = call("node", "example.mjs", cwd=self.stranger)
        file = WORK / "example.json"
        call(PROGRAM, "run", "--mass-ratio", "0.02", "--restitution", "0.6", "--x0", "6", "--until-amplitude", "0.25",
             "--record", "half_cycles,impacts", "-o", file)
        run = json.loads(file.read_text())
        self.assertIn(f"{run['end_time'] / 6.283185307179586:.1f} periods, {len(run['impacts']['time'])} impacts", printed)
        self.assertIn(f"largest amplitude {run['half_cycles']['amplitude'][0]:.3f}", printed)

    def test_a_run_that_is_no_longer_wanted_ends_at_once(self):
        script = """
          import { run } from "impact-damper";
          const scene = { x0: 6, mass_ratio: 0.02, restitution: 0.6, until_time: 1e6 };
          const wanted = new AbortController();
          const begin = performance.now();
          const long = run(scene, { engine: { name: "cem", time_step: 1e-6 }, signal: wanted.signal });
          const queued = run(scene, { engine: "cem", signal: AbortSignal.abort("never wanted") });
          const next = run({ ...scene, until_time: 10 });
          setTimeout(() => wanted.abort("enough"), 200);
          const ends = await Promise.allSettled([long, queued, next]);
          console.log(JSON.stringify([ends[0].reason, ends[1].reason, ends[2].value.end_time]));
        """
        (self.stranger / "aborted.mjs").write_text(script)
        self.assertEqual(json.loads(call("timeout", "60", "node", "aborted.mjs", cwd=self.stranger)), ["enough", "never wanted", 10])

    def test_the_types_are_right(self):
        if not shutil.which("tsc"):
            self.skipTest("no TypeScript: make deps-wasm installs it")
        shutil.copy(HERE / "types.ts", self.stranger)
        call("tsc", "--noEmit", "--strict", "--target", "es2022", "--module", "node16", "--moduleResolution", "node16",
             "--lib", "es2022,dom", "types.ts", cwd=self.stranger)

    def test_in_a_browser_run_files_are_the_programs(self):
        folder = WORK / "browser"
        folder.mkdir()
        (folder / "page.html").write_text(PAGE)
        (folder / "package").symlink_to(self.package)
        served = Served(folder)
        with contextlib.closing(browsers.Chromium()) as page:
            page.load(lambda: page.call("Page.navigate", url=f"{served.address}/page.html"))
            for job in jobs(folder):
                options = json.dumps({**job["options"], "file": True})
                text = page.does(f"run({json.dumps(job['scene'])}, {options}).then((run) => run.file)")
                Path(job["file"]).write_text(text)
            foreign = [said for said in page.messages if served.address not in said]
        self.assertEqual(foreign, [])
        self.assertEqual(different(WORK / "native", folder), [])


# What a link of the form for one's own damper keeps.
KEPT = "fetch([...document.querySelectorAll('.own a')].find((a) => a.textContent === '%s').href).then((it) => it.text())"


class InABrowser(browsers.InABrowser):
    """A page, opened from a folder as a reader does."""

    def awaited(self, begin: str, found: str, seconds: int) -> str:
        """What the script `found` gives, once that is something, after `begin`."""
        return self.page.does(f"""new Promise((resolve, reject) => {{
          {begin}
          const end = performance.now() + {seconds} * 1000;
          const look = () => {{
            const told = {found};
            if (told) resolve(told);
            else if (performance.now() < end) setTimeout(look, 10);
            else reject(new Error("nothing is told in time"));
          }};
          look();
        }})""")

    def settled(self) -> str:
        """What the page tells of the run when it has it."""
        return self.awaited("", """!document.querySelector("[aria-busy]") &&
            (document.querySelector("[role=status]")?.textContent || document.querySelector("[role=alert]")?.textContent)""", 60)

    def checked(self, place: str, seconds: int) -> str:
        """What is told when the button there has been pressed."""
        return self.awaited(f"""const place = document.querySelector("{place}"), output = place.querySelector("output");
          place.querySelector("button").click();""",
                            'output.dataset.state && output.dataset.state !== "working" && output.textContent', seconds)

    def alert(self) -> str:
        return self.page.does("document.querySelector('[role=alert]').textContent")

    def types(self, name: str, value: str, selector: str = ""):
        self.page.does(f"""(() => {{
          const field = document.querySelector("[aria-label^='{name}']{selector}");
          field.value = "{value}";
          field.dispatchEvent(new Event("change"));
        }})()""")

    def fits_a_phone_and_a_dark_screen(self, name: str):
        for width in (390, 1280):
            for scheme in ("light", "dark"):
                with self.subTest(f"{width}, {scheme}"):
                    self.open(width=width, scheme=scheme)
                    self.assertLessEqual(self.page.does("document.documentElement.scrollWidth"), width)
                    self.page.screenshot(WORK / f"{name}-{width}-{scheme}.png")

    def told_by_the_program(self, restitution: float) -> tuple:
        """Of the decay from amplitude 6 with 2 % of the mass, what the page tells, too."""
        file = WORK / f"told-{restitution}.json"
        call(PROGRAM, "run", "--mass-ratio", "0.02", "--restitution", restitution, "--x0", "6", "--until-time", "2000",
             "--until-amplitude", "0.01", "--record", "half_cycles,impacts", "-o", file)
        run = json.loads(file.read_text())
        return f"{run['end_time'] / 6.283185307179586:.3g} periods", f"{len(run['impacts']['time'])} impacts"


def report_page(wasm: Path, folder: Path) -> Path:
    """The report's page with all that is compiled, as make paper makes it, in the folder."""
    call(SOURCE / "paper/report/make.py", WASM.parent, "--html", "--verdicts", SOURCE / "data/reference/verdicts.json",
         "--wasm", wasm, "--out", folder)
    return folder / "report.html"


class Report(InABrowser):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.report = report_page(WASM, WORK / "report")

    def test_a_link_leads_to_a_damper_and_its_parameters(self):
        self.page.open(self.report, 1280)
        self.page.load_again("damper-4&restitution=0.4")
        told = self.settled()
        for words in self.told_by_the_program(0.4):
            self.assertIn(words, told)
        self.assertEqual(self.page.does("[...document.querySelectorAll('.damper')].map((each) => each.id)"), ["damper-4"])

    def test_all_tables_and_verdicts_are_the_cited_ones(self):
        self.page.open(self.report, 1280)
        cited = json.loads((SOURCE / "data/reference/manifest.json").read_text())["figures"]
        tables = {each["figure"]: each["tables"][0]["sha256"] for each in cited if each["tables"]}
        self.assertGreaterEqual(tables.keys(), {str(number) for number in range(1, 16)})
        verdicts = len(json.loads((SOURCE / "data/reference/verdicts.json").read_text())["verdicts"])
        told = self.checked("[data-check-all]", 1200)
        self.assertIn(f"{len(tables)} of {len(tables)} tables and {verdicts} of {verdicts} verdicts are the cited ones", told)
        for figure, sha256 in tables.items():
            self.assertEqual(self.page.does(f"document.querySelector('#figure-{figure} .check output').textContent"),
                             f"equal: SHA-256 here {sha256}, cited {sha256}")

    def test_one_claim_is_checked_by_itself(self):
        self.page.open(self.report, 1280)
        self.assertRegex(self.checked("#claim-bounce-down-end-04", 120), "^equal: SHA-256 here ([0-9a-f]{8}), cited \\1$")

    def test_a_table_and_a_verdict_of_another_version_are_noticed(self):
        text, other = self.report.read_text(encoding="utf-8"), "0" * 64
        cited = [re.search(f'id="{name}"[^>]*data-sha256="([0-9a-f]{{64}})"', text)[1] for name in ("figure-8", "claim-bounce-down-end-04")]
        for sha256 in cited:
            text = text.replace(sha256, other)
        faulty = WORK / "other-version.html"
        faulty.write_text(text, encoding="utf-8")
        self.page.open(faulty, 1280)
        self.assertEqual(self.checked("#figure-8 .check", 120), f"different: SHA-256 here {cited[0]}, cited {other}")
        self.assertEqual(self.checked("#claim-bounce-down-end-04", 120), f"different: SHA-256 here {cited[1][:8]}, cited {other[:8]}")

    def test_one_wrong_bit_in_the_programs_sine_is_noticed(self):
        shutil.copytree(WASM / "program", WORK / "wrong-bit/program")
        shutil.copytree(WASM / "package", WORK / "wrong-bit/package")
        plant_wrong_bit(WORK / "wrong-bit/program/impact-damper.wasm")
        self.page.open(report_page(WORK / "wrong-bit", WORK / "wrong-bit/report"), 1280)
        self.assertRegex(self.checked("#figure-15 .check", 120), "^different: ")
        self.assertRegex(self.checked("#figure-8 .check", 120), "^different: ")

    def test_each_damper_begins_at_its_figure_and_tells_what_the_program_does(self):
        self.page.open(self.report, 1280)
        windows = {figure["title"]: figure.get("window") for figure in json.loads((SOURCE / "figures/catalogue.json").read_text())["figures"]
                   if figure["table"] in ("motion", "phase")}
        places = self.page.does("document.querySelectorAll('[data-damper]').length")
        self.assertEqual(places, len(windows))
        for place, window in enumerate(windows.values()):
            with self.subTest(place):
                self.page.does(f"""(() => {{
                  document.querySelector('.damper')?.remove();
                  document.querySelector('.open-damper').click();
                }})()""")
                told = self.settled()
                for words in self.told_by_the_program(0.6):
                    self.assertIn(words, told)
                link = self.page.does("document.querySelector('.player a').getAttribute('href')")
                self.assertEqual(self.page.does(f"document.getElementById('{link[1:].split('&')[0]}').matches('.damper')"), True)
                amplitude = float(re.search(r"At period .*: amplitude ([\d.]+)", told)[1])
                self.assertTrue(window is None or 0.8 * window < amplitude <= 1.005 * window, f"{amplitude} at {window}")


class DamperToPlayWith(InABrowser):
    """The page that is nothing but a damper."""

    def open(self, link="", page=None, width=1280, scheme="light"):
        self.page.open(page or WASM / "damper.html", width, scheme)
        if link:
            self.page.load_again(link)
        return self.settled()

    def types(self, name: str, value: str) -> str:
        super().types(name, value, "[type=number]")
        return self.settled()

    def test_restitution_is_lowered_and_bounce_down_ends_at_two(self):
        told = self.open()
        for words in self.told_by_the_program(0.6):
            self.assertIn(words, told)
        told = self.types("restitution", "0.4")
        for words in self.told_by_the_program(0.4):
            self.assertIn(words, told)
        # The paper's claim, and what the program finds by the same rule (claim bounce-down-04).
        self.assertRegex(told, r"bounce-down ends at amplitude (1\.9|2\.0)")

    def test_who_moves_in_time_while_a_new_decay_is_simulated_sees_the_new_one(self):
        self.open()
        self.page.does("""(() => {
          const time = document.querySelector(".time"), field = document.querySelector("[aria-label^='restitution'][type=number]");
          const move = (to) => { time.value = to; time.dispatchEvent(new Event("input")); };
          move(500);
          field.value = "0.4";
          field.dispatchEvent(new Event("change"));
          move(900);
        })()""")
        told = self.settled()
        for words in self.told_by_the_program(0.4):
            self.assertIn(words, told)

    def test_an_emptied_field_is_no_zero(self):
        before = self.open()
        self.assertEqual(self.types("restitution", ""), before)
        self.assertEqual(self.page.does("document.querySelector('[aria-label^=restitution][type=number]').value"), "0.6")

    def test_a_link_carries_the_parameters(self):
        told = self.open("mass_ratio=0.1&restitution=0.8&x0=3&engine=restitution")
        link = self.page.does("location.hash")
        self.assertEqual(link, "#mass_ratio=0.1&restitution=0.8&damping_ratio=0&wall_stiffness=10000"
                         "&force_amplitude=0&force_frequency=1&x0=3&engine=restitution")
        self.assertEqual(self.open(link[1:]), told)

    def test_under_a_force_the_motion_is_the_programs(self):
        told = self.open("mass_ratio=0.02&restitution=0.6&x0=1&force_amplitude=0.006&force_frequency=0.99")
        file = WORK / "forced.json"
        call(PROGRAM, "run", "--mass-ratio", "0.02", "--restitution", "0.6", "--x0", "1", "--force-amplitude", "0.006",
             "--force-frequency", "0.99", "--until-time", repr(150 * 6.283185307179586), "--record", "half_cycles,impacts", "-o", file)
        run = json.loads(file.read_text())
        amplitude = f"{run['half_cycles']['amplitude'][-1]:.3g}"
        self.assertIn(f"150 periods to amplitude {amplitude}, {len(run['impacts']['time'])} impacts; under a force", told)
        self.assertNotIn("loss factor", told)

    def test_friction_weight_and_drag_are_the_programs(self):
        for engine, given in (("restitution", {"friction": 0.3, "weight": 0.1}), ("restitution", {"drag": 0.2}), ("exact", {"drag": 0.2})):
            file = WORK / "rubbed.json"
            call(PROGRAM, "run", "--x0", "6", "--until-time", "2000", "--until-amplitude", "0.01", "--engine", engine, "--record", "half_cycles,impacts",
                 *(word for name, value in given.items() for word in (f"--{name}", str(value))), "-o", file)
            run = json.loads(file.read_text())
            told = self.open("".join(f"{name}={value}&" for name, value in given.items()) + f"engine={engine}")
            self.assertIn(f"to amplitude {run['half_cycles']['amplitude'][-1]:.3g}, {len(run['impacts']['time'])} impacts", told)
            self.assertEqual("held at rest up to amplitude 0.408" in told, "friction" in given)

    def test_what_is_not_valid_is_rejected_in_the_programs_words_and_the_decay_stays(self):
        before = self.open()
        self.types("restitution", "1.5")
        self.assertIn("/restitution: must be", self.alert())
        self.types("restitution", "0.6")
        self.assertEqual(self.alert(), "")
        self.assertEqual(self.settled(), before)

    def test_the_keyboard_moves_through_the_decay(self):
        before = self.open()
        self.page.does("document.querySelector('.time').focus()")
        for _ in range(3):
            self.page.presses("PageUp")
        told = self.page.does("""new Promise((resolve) => setTimeout(() =>
          resolve(document.querySelector("[role=status]").textContent), 1000))""")
        self.assertNotEqual(told.split("At period")[1], before.split("At period")[1])
        self.assertGreater(self.page.does("Number(document.querySelector('.time').value)"), 0)

    def test_it_plays_and_pauses(self):
        self.open()
        at = "Number(document.querySelector('.time').value)"
        press = "document.querySelector('.player button').click()"
        self.assertEqual(self.page.does(at), 0)
        self.page.does(press)
        self.page.does(f"new Promise((resolve) => {{ const look = () => {at} > 1 ? resolve() : setTimeout(look, 20); look(); }})")
        self.page.does(press)
        moment = self.page.does(at)
        self.page.does("new Promise((resolve) => setTimeout(resolve, 200))")
        self.assertEqual(self.page.does(at), moment)

    def test_it_fits_a_phone_and_a_dark_screen(self):
        self.fits_a_phone_and_a_dark_screen("page")

    def test_who_wants_little_motion_has_it_slow_and_without_flashes(self):
        def speed_and_flash(motion: str) -> list:
            self.open()
            self.page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": motion}])
            self.page.load_again()
            self.settled()
            return self.page.does("""(() => {
              const [still, struck] = document.querySelectorAll(".wall");
              struck.classList.add("struck");
              return [document.querySelector("[aria-label=speed]").value, getComputedStyle(struck).fill !== getComputedStyle(still).fill];
            })()""")

        self.assertEqual(speed_and_flash("no-preference"), ["0", True])
        self.assertEqual(speed_and_flash("reduce"), ["-1", False])

    def test_every_control_has_a_name(self):
        self.open()
        self.assertEqual(self.page.does("""[...document.querySelectorAll("input, select, button, svg")].filter((each) =>
          !each.getAttribute("aria-label") && !each.textContent.trim()).map((each) => each.outerHTML)"""), [])

    def test_a_page_that_needs_the_network_is_noticed(self):
        faulty = WORK / "faulty.html"
        faulty.write_text((WASM / "damper.html").read_text().replace("<style>", '<script src="http://127.0.0.1:9/library.js"></script><style>'))
        self.open(page=faulty)
        self.assertTrue(any("127.0.0.1:9" in said for said in self.page.messages))
        self.page.messages.clear()


@unittest.skipUnless(browsers.Firefox.program(), "no Firefox: make deps-wasm installs it")
class InFirefox(InABrowser):
    kind = browsers.Firefox

    def test_the_papers_figures_have_the_cited_tables(self):
        self.page.open(report_page(WASM, WORK / "report-for-firefox"))
        for figure in range(1, 16):
            with self.subTest(figure):
                self.assertRegex(self.checked(f"#figure-{figure} .check", 300), "^equal: ")

    def test_the_damper_and_the_page_about_ones_own_tell_what_the_program_does(self):
        self.page.open(WASM / "damper.html")
        told = self.settled()
        for words in self.told_by_the_program(0.6):
            self.assertIn(words, told)
        self.page.open(WASM / "own.html")
        self.settled()
        (WORK / "firefox").mkdir()
        scene, page = WORK / "firefox/mast.json", WORK / "firefox/mast.html"
        scene.write_text(self.page.does(KEPT % "Save the scene"), encoding="utf-8")
        call(PROGRAM, "report", "--scene", scene, "--without-figures", "-o", page)
        self.assertEqual(self.page.does(KEPT % "Save the page"), page.read_text(encoding="utf-8"))


class OwnDamper(InABrowser):
    """The form for one's own damper, and the page that the program writes about it."""

    def open(self, width=1280, scheme="light"):
        self.page.open(WASM / "own.html", width, scheme)
        self.settled()

    def kept(self, link: str) -> str:
        return self.page.does(KEPT % link)

    def test_the_page_is_the_one_that_the_program_writes_about_the_saved_scene(self):
        self.open()
        self.types("name", "my mast")
        self.types("coefficient of restitution", "0.4")
        self.settled()
        folder = WORK / "own"
        folder.mkdir()
        (folder / "my mast.json").write_text(self.kept("Save the scene"), encoding="utf-8")
        mast = json.loads((SOURCE / "data/examples/mast.json").read_text()) | {"restitution": 0.4}
        del mast["description"]
        self.assertEqual(json.loads((folder / "my mast.json").read_text()), mast)
        call(PROGRAM, "report", "--scene", "my mast.json", "--without-figures", "-o", "program's.html", cwd=folder)
        self.assertEqual(self.kept("Save the page"), (folder / "program's.html").read_text(encoding="utf-8"))
        shown = self.page.does("document.querySelector('iframe').contentDocument.body.innerText")
        self.assertIn("Impact damper: my mast", shown)
        self.assertIn("To damp a given amplitude choose a clearance of", shown)

    def test_a_scene_that_is_not_valid_is_rejected_in_the_programs_words(self):
        self.open()
        self.types("coefficient of restitution", "1.5")
        self.settled()
        scene = WORK / "mast.json"
        scene.write_text(self.kept("Save the scene"), encoding="utf-8")
        done = subprocess.run([PROGRAM, "report", "--scene", "mast.json"], cwd=WORK, capture_output=True, text=True)
        self.assertEqual(done.returncode, 3)
        self.assertEqual(self.alert(), done.stderr.strip().replace("mast.json: /restitution:", "coefficient of restitution (restitution):"))
        self.assertEqual(self.field("coefficient of restitution", "getAttribute('aria-invalid')"), "true")
        self.assert_page_is_stale()
        self.types("coefficient of restitution", "0.5")
        self.assertIn("Simulated by the program", self.settled())
        self.assertEqual(self.alert(), "")
        self.assertEqual(self.field("coefficient of restitution", "getAttribute('aria-invalid')"), None)

    def test_what_is_no_number_is_taken_for_none(self):
        self.open()
        for text in ("1,5", "abc", "1e400", "1e"):
            with self.subTest(text):
                self.types("damping ratio", text)
                self.assertEqual(self.alert(), f"damping ratio: must be a number such as 0.002, got '{text}'")
                self.assertEqual(self.field("damping ratio", "value"), text)
                self.assert_page_is_stale()
        self.types("damping ratio", "")
        self.assertIn("Simulated by the program", self.settled())
        self.assertNotIn("damping_ratio", json.loads(self.kept("Save the scene")))

    def test_a_name_is_that_of_a_file(self):
        self.open()
        for name in ("figures/catalogue", "../x", "a\\\\b"):
            with self.subTest(name):
                self.types("name", name)
                self.assertIn("name: must be that of a file, without a slash", self.alert())
                self.assert_page_is_stale()
        self.types("name", "<b>x<~b>.json")
        self.settled()
        self.assertEqual(self.page.does("document.querySelector('iframe').contentDocument.querySelector('h1').textContent"), "Impact damper: <b>x<~b>")
        self.types("name", "")
        self.settled()
        self.assertEqual(self.page.does("document.querySelector('.own a[download$=html]').download"), "my damper.html")

    def test_the_newest_scene_is_shown_and_saved_under_its_name(self):
        self.open()
        for field, value in (("name", "one"), ("released at", ""), ("exciting force", "2"), ("its frequency", "3.15"),
                             ("ends below", ""), ("ends after", "600"), ("name", "two"),
                             ("exciting force", ""), ("its frequency", ""), ("released at", "50")):
            self.types(field, value)
        self.settled()
        self.assertEqual(self.page.does("document.querySelector('.own a[download$=html]').download"), "two.html")
        page = self.kept("Save the page")
        self.assertIn("Impact damper: two", page)
        self.assertIn("From an amplitude of", page)

    def test_its_contents_lead_to_its_sections_and_its_height_is_that_of_the_page(self):
        self.open()
        page = "document.querySelector('iframe').contentDocument"
        for link in range(self.page.does(f"{page}.querySelectorAll('nav a').length")):
            self.page.does(f"{page}.querySelectorAll('nav a')[{link}].click()")
            title = self.page.does(f"{page}.querySelectorAll('nav a')[{link}].textContent")
            top = self.page.does(f"[...{page}.querySelectorAll('h2')].find((h) => h.textContent === '{title}').getBoundingClientRect().top")
            self.assertGreater(top, -1)  # a browser scrolls by whole pixels
            self.assertEqual(self.page.does(f"{page}.querySelector('h1').textContent"), "Impact damper: mast")
        heights = "(() => { const f = document.querySelector('iframe'); return [f.clientHeight, f.contentDocument.documentElement.scrollHeight]; })()"
        for restitution in ("0.5", "0.4", "0.3", "0.6"):
            self.types("coefficient of restitution", restitution)
            self.settled()
        self.page.does("new Promise((resolve) => setTimeout(resolve, 500))")  # a new layout
        own, content = self.page.does(heights)
        self.assertLessEqual(content, own)
        self.assertLess(own, self.page.does(f"{page}.body.getBoundingClientRect().height") + 60)

    def field(self, name: str, what: str):
        return self.page.does(f"document.querySelector('[aria-label^=\"{name}\"]').{what}")

    def assert_page_is_stale(self):
        self.assertEqual(self.page.does("document.querySelector('[role=status]').textContent"),
                         "The page below is that of the scene before the last change.")
        self.assertEqual(self.page.does("[document.querySelector('.own').matches('[data-stale]'), "
                                           "[...document.querySelectorAll('.own a')].map((each) => each.hidden)]"), [True, [False, True]])

    def test_it_fits_a_phone_and_a_dark_screen(self):
        self.fits_a_phone_and_a_dark_screen("own")


if __name__ == "__main__":
    BUILD = Path(sys.argv[1]).resolve()
    PROGRAM, WASM = BUILD / "src/impact-damper", BUILD / "wasm"
    TARBALL, WORK = next(WASM.glob("impact-damper-*.tgz")), WASM / "check"
    if not shutil.which("node") or not browsers.Chromium.program():
        print("there is no node or no Chromium: make deps-wasm deps-check", file=sys.stderr)
        sys.exit(77)
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
