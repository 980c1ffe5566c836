"""`compare` finds what was done to a record, fits the numbers it was made with, and writes what its schema says.

    compare.py PROGRAM SOURCE FOLDER        FOLDER, made anew, is for the files

Records are made by tests/measured/make_record.py, which shares no code with the program.
"""
import json
import re
import signal
import subprocess
import sys
import time

from trial import demand, finish, faults, folder, program, read_json, source, validator, write

scene = source / "data/examples/mast.json"
example = source / "data/examples/mast_measured.csv"
TRUTH = {"restitution": 0.52, "damping_ratio": 0.003, "clearance": 11.5}


def record(name, *words):
    made = subprocess.run([sys.executable, str(source / "tests/measured/make_record.py"), *words], capture_output=True, text=True, check=True)
    write(name, made.stdout)
    return name


def compare(name, *words, scene=scene):
    done = subprocess.run([str(program), "compare", "--measured", str(name), "--scene", str(scene), "-o", "out.json", *words],
                          cwd=folder, capture_output=True, text=True)
    demand(done.returncode == 0, f"{name} {words}: exit code {done.returncode}: {done.stderr}")
    return done.stdout, read_json("out.json")


# The example is what its script makes.
record("again.csv")
demand((folder / "again.csv").read_bytes() == example.read_bytes(), "mast_measured.csv is not what make_record.py makes")

# The fit, by the engine with rigid walls as the record has them; the bytes do not depend on the number of threads.
text, found = compare(example, "--engine", "restitution", "--threads", "1")
first = (folder / "out.json").read_bytes()
compare(example, "--engine", "restitution", "--threads", "3")
demand((folder / "out.json").read_bytes() == first, "other bytes with another number of threads")
schema = validator("comparison")
for error in schema.iter_errors(found):
    faults.append(f"schema: {list(error.absolute_path)}: {error.message[:200]}")
done = subprocess.run([str(program), "check", "comparison", str(folder / "out.json")], capture_output=True, text=True)
demand(done.returncode == 0, f"check: {done.stderr}")
for each in found["fit"]["parameters"]:
    truth = TRUTH[each["name"]]
    demand(each["low"] <= truth <= each["high"], f"{each['name']}: {truth} is not in {each['low']} to {each['high']}")
    demand(each["high"] - each["low"] < 0.25 * truth, f"{each['name']}: a wide interval")
demand(found["fit"]["normal_deviate"] < 3, "the example is unlike every decay")
# Peaks 0 and 2 are clipped (58 + 1.5 mm are more than 55), and those close to the limit may be left out as well;
# 0.35 s without samples are two half cycles.
demand(2 <= found["reduction"]["clipped"] <= 6, f"clipped: {found['reduction']['clipped']}")
demand(2 <= found["reduction"]["in_gaps"] <= 4, f"in gaps: {found['reduction']['in_gaps']}")
demand(abs(found["reduction"]["noise"] - 0.08) < 0.012, f"noise: {found['reduction']['noise']}")
demand(abs(found["reduction"]["offset"] - 2.0) < 0.15, f"offset: {found['reduction']['offset']}")
demand(abs(found["reduction"]["drift"] - 1.0) < 0.3, f"drift: {found['reduction']['drift']}")
for each in found["bins"]:
    # Within four standard deviations, of noise and scatter.
    wide = 4 * (each["relative_error"] ** 2 + each["relative_scatter"] ** 2) ** 0.5
    demand(abs(each["fitted"] / each["eta"] - 1) < wide, f"bin from {each['upper']}: {each['fitted']} fitted, {each['eta']} measured")
demand(f"left out: {found['reduction']['clipped']} half cycles clipped" in text, text)

# A wrong sampling rate is told, and changes no loss factor.
text, slower = compare(record("slower.csv", "time_factor=1.25"), "--fit", "none")
demand(re.search(r"oscillates at 2\.5 Hz, 0\.8\d* times what the scene does: its sampling rate is wrong", text) is not None, text)
for one, other in zip(found["bins"], slower["bins"]):
    # Samples at the very ends of windows may fall out of them by rounding: that is less than the noise.
    demand(abs(one["eta"] / other["eta"] - 1) < one["relative_error"], "a wrong sampling rate changes the loss factor")

# With the damping known clearance and restitution are told far better: the page's advice, and its numbers.
write("known.json", json.loads(scene.read_text(encoding="utf-8")) | {"damping_ratio": TRUTH["damping_ratio"]})
text, known = compare(example, "--engine", "restitution", "--fit", "restitution,clearance", scene="known.json")
interval = re.search(r"^clearance .* (\S+ to \S+ mm)  ", text, re.M)[1]
demand(interval in (source / "docs/compare.md").read_text(encoding="utf-8"), f"docs/compare.md has another clearance than {interval}")
widths = [each["high"] - each["low"] for each in (found["fit"]["parameters"][2], known["fit"]["parameters"][1])]
demand(widths[1] < widths[0] / 5, f"widths of the clearance's interval: {widths}")

# Large amplitudes alone: restitution and clearance are not distinguished.
text, begin = compare(record("begin.csv", "seconds=8", "gap_from=99"), "--engine", "restitution")
demand("above the" in text and "where impacts cease" in text, text)
demand("hardly be distinguished" in text or "does not tell" in text, text)
# An acceleration with the same amplitudes and frequency: two derivatives make -omega^2 of it.
rows = [line.split(",") for line in example.read_text(encoding="utf-8").split()[1:]]
omega = 2 * 3.14159265 * found["reduction"]["frequency"]
write("acceleration.csv", "t_s,a_m_per_s2\n" + "".join(f"{t},{-float(x) * omega ** 2 / 1000:.6g}\n" for t, x in rows))
text, of_acceleration = compare("acceleration.csv", "--fit", "none")
demand("they may err by 4 %" in text, text)
# The frequency that made it is the mean one; above 8 mm the local one is within a percent of it.
for one, other in zip(found["half_cycles"]["amplitude"][:80], of_acceleration["half_cycles"]["amplitude"]):
    demand(abs(one / other - 1) < 0.02, f"{one} mm, {other} of the acceleration")
demand("fit" not in of_acceleration and not list(schema.iter_errors(of_acceleration)), "nothing was to be fitted")

# Interrupted, it leaves nothing behind.
(folder / "out.json").unlink()
running = subprocess.Popen([str(program), "compare", "--measured", str(example), "--scene", str(scene), "-o", "out.json"], cwd=folder,
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
time.sleep(1)
running.send_signal(signal.SIGINT)
out, err = running.communicate()
demand(running.returncode == 130 and out == "" and "interrupted: " in err, f"interrupted: {running.returncode} {err}")
demand(not (folder / "out.json").exists(), "interrupted, a file is left")

finish()
