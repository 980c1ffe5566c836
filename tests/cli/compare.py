"""`compare` finds what was done to a record, fits the numbers it was made with, and writes what its schema says.

Records are made by tests/measured/make_record.py, which shares no code with the program. More of them, and how often the truth
is within an interval: ../measured/.
"""
import json
import math
import random
import re
import signal
import sys
import time

from trial import call, demand, demand_valid, finish, folder, read, read_json, run, source, start, write

scene = source / "data/examples/mast.json"
example = source / "data/examples/mast_measured.csv"
TRUTH = {"restitution": 0.52, "damping_ratio": 0.003, "clearance": 11.5}


def record(name, *words):
    write(name, run(sys.executable, source / "tests/measured/make_record.py", *words).stdout)
    return name


def compare(name, *words, scene=scene):
    printed = call("compare", "--measured", name, "--scene", scene, "-o", "out.json", *words)
    return printed, read_json("out.json")


# The example is what its script makes.
record("again.csv")
demand((folder / "again.csv").read_bytes() == example.read_bytes(), "mast_measured.csv is not what make_record.py makes")

# The fit, by the engine with rigid walls as the record has them.
text, found = compare(example, "--engine", "restitution", "--threads", 1)
first = read("out.json")
compare(example, "--engine", "restitution", "--threads", 3)
demand(read("out.json") == first, "other bytes with another number of threads")
demand_valid("comparison", found, "out.json")
call("check", "comparison", "out.json")
for each in found["fit"]["parameters"]:
    truth = TRUTH[each["name"]]
    demand(each["low"] <= truth <= each["high"], f"{each['name']}: {truth} is not in {each['low']} to {each['high']}")
    demand(each["high"] - each["low"] < 0.25 * truth, f"{each['name']}: a wide interval")
demand(found["fit"]["normal_deviate"] < 3, "the example is unlike every decay")
# Peaks 0 and 2 are clipped (58 + 1.5 mm are more than 55), and those close to the limit may be left out as well;
# 0.35 s without samples are two half cycles.
demand(2 <= found["reduction"]["clipped"] <= 6, f"clipped: {found['reduction']['clipped']}")
demand(2 <= found["reduction"]["in_gaps"] <= 4, f"in gaps: {found['reduction']['in_gaps']}")
for each in found["bins"]:
    # Within four standard deviations, of noise and scatter.
    wide = 4 * (each["relative_error"] ** 2 + each["relative_scatter"] ** 2) ** 0.5
    demand(abs(each["fitted"] / each["eta"] - 1) < wide, f"bin from {each['upper']}: {each['fitted']} fitted, {each['eta']} measured")
demand(f"left out: {found['reduction']['clipped']} half cycles clipped" in text, text)

# A wrong sampling rate is told.
text, _ = compare(record("slower.csv", "time_factor=1.25"), "--fit", "none")
demand(re.search(r"oscillates at 2\.5 Hz, 0\.8\d* times what the scene does: its sampling rate is wrong", text) is not None, text)

# With the damping known clearance and restitution are told far better: the page's advice, and its numbers.
write("known.json", json.loads(scene.read_text(encoding="utf-8")) | {"damping_ratio": TRUTH["damping_ratio"]})
text, known = compare(example, "--engine", "restitution", "--fit", "restitution,clearance", scene="known.json")
interval = re.search(r"^clearance .* (\S+ to \S+ mm)  ", text, re.M)[1]
demand(interval in (source / "docs/compare.md").read_text(encoding="utf-8"), f"docs/compare.md has another clearance than {interval}")
widths = [each["high"] - each["low"] for each in (found["fit"]["parameters"][2], known["fit"]["parameters"][1])]
demand(widths[1] < widths[0] / 5, f"widths of the clearance's interval: {widths}")

# Large amplitudes alone: restitution and clearance are not distinguished.
text, _ = compare(record("begin.csv", "seconds=8", "gap_from=99"), "--engine", "restitution")
demand("above the" in text and "where impacts cease" in text, text)
demand("hardly be distinguished" in text or "does not tell" in text, text)
# An acceleration, with its impacts, and a velocity, as a table calculation writes it: no head, semicolons, decimal commas.
# Both are fitted by the numbers that they were made with, and begin like the displacement.
whole = ("samples_per_second=400", "offset=0", "drift=0", "range=1e9", "gap_from=99")
record("acceleration.csv", "derivative=2", "noise=100", *whole)
record("velocity.csv", "derivative=1", "noise=2", *whole)
rows = [line.split(",") for line in (folder / "velocity.csv").read_text(encoding="utf-8").split()[1:]]
write("velocity.txt", "".join(f"{t};{float(v) / 10:.5f}\n".replace(".", ",") for t, v in rows))
displacement = compare(record("displacement.csv", *whole), "--fit", "none")[1]
for quantity, words in (("acceleration.csv", ()), ("velocity.txt", ("--time", "1:s", "--column", "2:cm/s"))):
    text, other = compare(quantity, "--engine", "restitution", *words)
    demand_valid("comparison", other, quantity)
    for each in other["fit"]["parameters"]:
        truth = TRUTH[each["name"]]
        demand(each["low"] <= truth <= each["high"], f"{quantity}, {each['name']}: {truth} is not in {each['low']} to {each['high']}")
        demand(each["high"] - each["low"] < 0.3 * truth, f"{quantity}, {each['name']}: a wide interval")
    begin = other["half_cycles"]["time"][0]
    amplitudes = [next(a for t, a in zip(each["time"], each["amplitude"]) if abs(t - begin) < 0.02)
                  for each in (other["half_cycles"], displacement["half_cycles"])]
    demand(abs(amplitudes[0] / amplitudes[1] - 1) < 0.01, f"{quantity}: {amplitudes[0]} mm in place of {amplitudes[1]} mm")
    demand(("impacts count by their area" in text) == (quantity == "acceleration.csv"), text)
demand("column 2 as velocity in cm/s; time in column 1 in s; semicolons between cells, decimal commas" in text, text)
text, without = compare("acceleration.csv", "--fit", "none")
demand("fit" not in without, "nothing was to be fitted")
demand_valid("comparison", without, "without a fit")

# Without impacts a record has the damping ratio alone; with impacts it has no such one.
noise = random.Random(4)
for without, carried in (("locked", 1.6), ("absent", 0)):
    omega, rate = math.sqrt(16000 / (40 + carried)), 0.003 * math.sqrt(16000 * 40) / (40 + carried)
    write("without.csv", "t_s,x_mm\n" + "".join(
        f"{i / 100},{40 * math.exp(-rate * i / 100) * math.cos(math.sqrt(omega ** 2 - rate ** 2) * i / 100) + noise.gauss(0, 0.05):.4f}\n"
        for i in range(4000)))
    text, other = compare("without.csv", "--without-impacts", without)
    demand_valid("comparison", other, without)
    demand(other["without_impacts"] == without and "nothing" not in text and "Hz, " not in text.split("the scene")[1], text)
    [found_ratio] = other["fit"]["parameters"]
    demand(found_ratio["low"] - 2e-5 < 0.003 < found_ratio["high"] + 2e-5, f"{without}: 0.003 is not in {found_ratio}")
    demand(found_ratio["high"] - found_ratio["low"] < 3e-5, f"{without}: a wide interval, {found_ratio}")
    demand(all(abs(each["simulated"] / 0.004 - 1) < 0.03 for each in other["bins"]), f"{without}: {other['bins'][0]} simulated")
text, _ = compare(example, "--without-impacts", "locked")
demand("The loss factor is not the same at all amplitudes" in text, text)

# Friction, inclination and drag are taken from the scene, and said.
write("slides.json", json.loads(scene.read_text(encoding="utf-8")) | {"friction_coefficient": 0.2, "inclination": 3, "drag": 0.5})
text, slides = compare(example, "--engine", "restitution", "--fit", "none", scene="slides.json")
held = 1.04 * (0.2 * math.cos(math.radians(3)) + math.sin(math.radians(3))) * 9806.65 / 400
demand("a coefficient of friction of 0.2, an inclination of 3 degrees and a drag of 0.5 N s/m. If it is wrong" in text, text)
demand(f"Up to {held:.3g} mm the secondary mass is held at rest" in text, text)
demand(slides["bins"][-2]["simulated"] < 0.5 * found["bins"][-2]["simulated"], "friction does not hold the mass")
demand("known from the scene" not in call("compare", "--measured", example, "--scene", scene, "--fit", "none"), "nothing is known of friction")

# Interrupted, it leaves nothing behind.
(folder / "out.json").unlink()
running = start("compare", "--measured", example, "--scene", scene, "-o", "out.json")
time.sleep(1)
running.send_signal(signal.SIGINT)
out, err = running.communicate()
demand(running.returncode == 130 and out == "" and "interrupted: " in err, f"interrupted: {running.returncode} {err}")
demand(not (folder / "out.json").exists(), "interrupted, a file is left")

finish()
