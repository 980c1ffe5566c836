#!/usr/bin/env python3
"""The Python module against the program: the same bits, and what the module adds to them.

    test_module.py PROGRAM MODULE SOURCE FOLDER

PROGRAM runs the same scenes; MODULE is the shared object; SOURCE the project's; scenes are written to FOLDER.
"""
import contextlib
import copy
import ctypes
import ctypes.util
import json
import math
import pickle
import re
import signal
import struct
import subprocess
import sys
import threading
import unittest
from pathlib import Path

try:
    import numpy as np
except ImportError:
    print("not tried: numpy is missing: make deps-check")
    sys.exit(77)

PROGRAM, MODULE, SOURCE, FOLDER = (Path(each).resolve() for each in sys.argv[1:5])
sys.path.insert(0, str(MODULE.parent))
import impact_damper

ENGINES = ("exact", "restitution", "cem")
FREE = {"mass_ratio": 0.05, "restitution": 0.5, "x0": 3, "until_time": 100}
FORCED = {"mass_ratio": 0.05, "restitution": 0.5, "damping_ratio": 0.01, "x0": 3, "force_amplitude": 0.05,
          "force_frequency": 0.97, "until_time": 60}
STUCK = {"restitution": 0, "x0": 8, "y0": 0.25, "until_amplitude": 7.5}
IN_UNITS = {"mass": 40, "stiffness": 16000, "secondary_mass": 2, "clearance": 10, "initial_displacement": 30,
            "until_seconds": 20, "description": "ein Mast, 12 m: \"größer\""}
SCENES = {"free": FREE, "forced": FORCED, "stuck": STUCK, "in_units": IN_UNITS}
ALL = "half_cycles,impacts,contacts,energy"
TO_NEAREST, UPWARD = 0, 0x800  # <fenv.h> on x86


def by_the_program(scene: dict, engine: str, *options: str) -> str:
    file = FOLDER / "scene.json"
    file.write_text(json.dumps(scene))
    done = subprocess.run([PROGRAM, "run", "--scene", file, "--engine", engine, "--record", ALL, *options],
                          capture_output=True, text=True, check=True)
    return done.stdout


def without_provenance(text: str) -> str:
    """Module and program may have been built at two commits."""
    return text[:text.index('\n "provenance": ')]


def bits(number) -> bytes:
    return struct.pack("<d", number)


class Module(unittest.TestCase):
    def columns_are_equal(self, given, wanted, name: str) -> int:
        """Each number of `wanted`, out of a run file, is in `given`; nothing else is. Returns how many."""
        if isinstance(wanted, dict):
            self.assertEqual(list(given), list(wanted), name)
            return sum(self.columns_are_equal(given[key], wanted[key], f"{name}/{key}") for key in wanted)
        if not isinstance(wanted, list):
            self.assertIs(type(given), float, name)
            self.assertEqual(bits(given), bits(wanted), name)
            return 1
        self.assertIs(type(given), np.ndarray, name)
        self.assertEqual((given.dtype, given.shape), (np.dtype("float64"), (len(wanted),)), name)
        self.assertTrue(given.flags.c_contiguous and given.flags.aligned and not given.flags.writeable, name)
        for i, (number, of_the_program) in enumerate(zip(given, wanted)):
            if of_the_program is None:
                self.assertTrue(math.isnan(number), (name, i))
            else:
                self.assertEqual(bits(number), bits(of_the_program), (name, i))
        return len(wanted)

    def test_every_number_has_the_programs_bits(self):
        for name, scene in SCENES.items():
            for engine in ENGINES:
                with self.subTest(scene=name, engine=engine):
                    text = by_the_program(scene, engine, "--history", "0:5:101")
                    run = impact_damper.run(engine=engine, history=self.first_times(scene), **scene)
                    self.assertEqual(without_provenance(run.text()), without_provenance(text))
                    (FOLDER / "run.json").write_text(run.text())
                    subprocess.run([PROGRAM, "check", "run", FOLDER / "run.json"], capture_output=True, check=True)
                    wanted = json.loads(text)
                    self.assertEqual(run.stop_reason, wanted["stop_reason"])
                    for key in ("schema", "scene", "engine", "stop_reason", "provenance"):
                        del wanted[key]
                    given = {key: value for key, value in vars(run).items() if key != "stop_reason"}
                    self.assertGreater(self.columns_are_equal(given, wanted, ""), 550)

    @staticmethod
    def first_times(scene: dict):
        """0 to 5 as the program takes them: in seconds for a scene in units."""
        if "mass" not in scene:
            return 0, 5, 101
        return 0, 5 / math.sqrt(scene["mass"] / scene["stiffness"]), 101

    def test_an_engine_with_options_has_the_programs_bits(self):
        for engine, options in (({"name": "cem", "time_step": np.float64(2e-3), "locate": np.True_, "damper": "lagged"},
                                 ("--time-step", "2e-3", "--locate", "--damper", "lagged")),
                                ({"name": "exact", "max_impacts": np.int64(9), "calibration": "two-body"},
                                 ("--max-impacts", "9", "--calibration", "two-body"))):
            with self.subTest(engine):
                text = impact_damper.run(engine=engine, **FORCED).text()
                self.assertEqual(without_provenance(text),
                                 without_provenance(by_the_program(FORCED, engine["name"], *options)))
                self.assertEqual(impact_damper.run(engine=json.loads(text)["engine"], **FORCED).text(), text)

    def test_what_was_not_asked_for_is_no_attribute(self):
        run = impact_damper.run(until_time=10)
        self.assertFalse(hasattr(run, "history") or hasattr(run, "units"))
        self.assertTrue(hasattr(impact_damper.run(until_time=10, history=[0, 1, 2]), "history"))

    def test_numbers_of_all_kinds_are_the_same_scene(self):
        wanted = impact_damper.run(x0=3, restitution=0.5, until_time=8).text()
        for three, half, eight in ((3.0, np.float64(0.5), np.int64(8)), (np.int32(3), np.float32(0.5), np.float16(8)),
                                   (np.array(3), np.array(0.5), 8)):
            self.assertEqual(impact_damper.run(x0=three, restitution=half, until_time=eight, until_amplitude=None).text(),
                             wanted)

    def test_all_that_is_wrong_is_told_at_once_by_its_name(self):
        with self.assertRaises(ValueError) as raised:
            impact_damper.run(mass_ratio=-1, restitution=math.nan, x0="3", v0=[1, 2], y0=1j, mas_ratio=0.1, until_time=True)
        lines = str(raised.exception).splitlines()
        self.assertEqual([line.split(":")[0] for line in lines],
                         ["restitution", "x0", "v0", "y0", "until_time", "mass_ratio", "mas_ratio"], lines)
        self.assertIn('got the string "nan"', lines[0])
        self.assertEqual(lines[5], "mass_ratio: must be >= 1e-09 and <= 1e+06, got -1")
        self.assertIn("mass_ratio", lines[6].split(":", 1)[1])

    def test_each_wrong_argument_is_a_value_error(self):
        for arguments, word in (({}, "until_time"), ({"X0": 3, "until_time": 5}, 'X0: unknown key, did you mean "x0"?'),
                                ({"x0": 3, "clearence": 4, "until_time": 5}, 'clearence: unknown key, did you mean "clearance"?'),
                                ({"x0": "+3", "until_time": 5}, 'x0: must be a number, got the string "+3"'), ({"mass": 40, "until_seconds": 1}, "stiffness"),
                                ({"mass": 40, "x0": 1, "until_time": 5}, "either in units or dimensionless"),
                                ({"until_time": 5, "engine": "exakt"}, "exact, restitution or cem, got exakt"),
                                ({"until_time": 5, "engine": {"name": "exact", "time_step": 1}}, "engine: /time_step: unknown"),
                                ({"until_time": 5, "engine": None}, "exact, restitution or cem, got None"),
                                ({"until_time": 5, "y0": 2, "engine": "restitution"}, "y0: must be >= 0 and <= 1"),
                                ({"until_time": 5, "history": (5, 1, 10)}, "history: "),
                                ({"until_time": 5, "history": (0, 1, 10**30)}, "history: "),
                                ({"until_time": 5, "history": (0, 1, -3)}, "history: "),
                                ({"until_time": 5, "history": (0, 1)}, "history: must be (begin, end, count)"),
                                ({"until_time": 5, "history": "011"}, "history: must be (begin, end, count)"),
                                ({"until_time": 10**400}, "scene")):
            with self.subTest(arguments):
                with self.assertRaises(ValueError) as raised:
                    impact_damper.run(**arguments)
                self.assertIn(word, str(raised.exception))
        with self.assertRaises(TypeError):
            impact_damper.run("scene.json")

    def test_a_numerical_failure_is_an_arithmetic_error(self):
        environment = ctypes.CDLL(ctypes.util.find_library("m"))
        if environment.fesetround(UPWARD) != 0:
            self.skipTest("no rounding mode to set")
        try:
            with self.assertRaises(ArithmeticError) as raised:
                impact_damper.run(until_time=5)
        finally:
            environment.fesetround(TO_NEAREST)
        self.assertIn("the rounding mode is not to nearest", str(raised.exception))

    def test_a_column_outlives_its_run(self):
        amplitude = impact_damper.run(**FREE).half_cycles["amplitude"]
        wanted = impact_damper.run(**FREE).half_cycles["amplitude"].copy()
        for _ in range(20):
            impact_damper.run(**FORCED)
        self.assertEqual(amplitude.tobytes(), wanted.tobytes())

    def test_memory_is_given_back(self):
        def resident() -> int:
            return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

        def work(times: int):
            for _ in range(times):
                run = impact_damper.run(until_time=5, history=(0, 5, 100000))  # about 4 MB
                run.text()
                with contextlib.suppress(ValueError):
                    impact_damper.run(until_time=-1)

        work(3)
        before = resident()
        work(20)
        self.assertLess(resident() - before, 20e6)  # 20 runs kept would be 80 MB

    def test_a_run_is_copied_and_pickled_whole(self):
        run = impact_damper.run(history=(0, 5, 11), **FORCED)
        for other in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run), pickle.loads(pickle.dumps(copy.copy(run)))):
            self.assertEqual(other.text(), run.text())
            self.assertEqual(other.end_time, run.end_time)
            self.assertEqual(other.history["x"].tobytes(), run.history["x"].tobytes())
            self.assertEqual(repr(other), f"impact_damper.Run(stop_reason='time', end_time={run.end_time})")

    LONG = {"until_time": 1e4, "force_amplitude": 0.3, "force_frequency": 1.0}  # some tenths of a second

    def test_other_threads_run_meanwhile(self):
        # With so long an interval a thread gets the interpreter only from one that gives it away.
        self.addCleanup(sys.setswitchinterval, sys.getswitchinterval())
        sys.setswitchinterval(1000)
        began, seen, ended = threading.Event(), threading.Event(), threading.Event()

        def simulate():
            began.set()
            for _ in range(20):
                impact_damper.run(**self.LONG)
                if seen.is_set():
                    break
            ended.set()

        thread = threading.Thread(target=simulate)
        thread.start()
        began.wait()
        meanwhile = not ended.is_set()
        seen.set()
        thread.join()
        self.assertTrue(meanwhile)

    def test_an_interruption_takes_effect_when_the_run_has_ended(self):
        timer = threading.Timer(0.02, signal.raise_signal, [signal.SIGINT])
        with self.assertRaises(KeyboardInterrupt):
            timer.start()
            impact_damper.run(**self.LONG)
            timer.join()
        self.assertEqual(impact_damper.run(until_time=5).stop_reason, "time")

    def test_nothing_but_its_beginning_is_exported(self):
        done = subprocess.run(["nm", "-D", "--defined-only", MODULE], capture_output=True, text=True, check=True)
        self.assertEqual([line.split()[-1] for line in done.stdout.splitlines()], ["PyInit_impact_damper"])

    def test_several_dampers_are_numbered_from_1(self):
        scene = {"x0": 3, "until_time": 20, "dampers": [{"y0": 0.5}, {"mass_ratio": 0.01, "clearance": 0.3}]}
        for engine in ("exact", "restitution", "cem"):
            run = impact_damper.run(engine=engine, history=(0, 5, 6), **scene)
            file = json.loads(run.text())
            for number in (1, 2):
                for section, column in (("history", "y"), ("history", "w"), ("half_cycles", "impacts")):
                    self.assertEqual(list(getattr(run, section)["dampers"][str(number)][column]),
                                     file[section]["dampers"][number - 1][column])
            self.assertEqual(set(run.impacts["damper"]), {1, 2})

    def test_every_field_is_in_the_documentation(self):
        schema = json.loads((SOURCE / "data/schema/scene.schema.json").read_text())
        fields = {name for text in self.keys_of(schema) for name in text} - {"description", "$schema"}
        self.assertGreater(len(fields), 25)
        for field in fields:
            self.assertRegex(impact_damper.run.__doc__, rf"(?m)^{field} +\S")
        for name, section in vars(impact_damper.run(history=(0, 1, 2), **IN_UNITS)).items():
            paragraph = re.search(rf"(?m)^{name} +\S.*(?:\n .*)*", impact_damper.Run.__doc__)
            self.assertIsNotNone(paragraph, name)
            for column in section if isinstance(section, dict) and name != "units" else ():
                self.assertRegex(paragraph.group(), rf"\b{column}\b", name)

    def keys_of(self, schema):
        if isinstance(schema, dict):
            if isinstance(schema.get("properties"), dict):
                yield schema["properties"].keys()
            for value in schema.values():
                yield from self.keys_of(value)
        elif isinstance(schema, list):
            for value in schema:
                yield from self.keys_of(value)

    def test_the_example_prints_what_is_shown(self):
        done = subprocess.run([sys.executable, "-B", SOURCE / "src/python/decay.py"], capture_output=True, text=True,
                              env={"PYTHONPATH": str(MODULE.parent)}, check=True)
        shown = (SOURCE / "examples/README.md").read_text().split("## [decay.py]")[1]
        self.assertEqual(done.stdout, re.search(r"```text\n(.*?)```", shown, re.S)[1])


FOLDER.mkdir(parents=True, exist_ok=True)
unittest.main(argv=sys.argv[:1])
