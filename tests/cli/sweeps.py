"""A table of `sweep` has the same bytes however it is made, holds the numbers of `run`, and is as its schemas say.
"""
import csv
import hashlib
import json
import math
import re
import shutil
import signal
import subprocess
import time

from trial import call, demand, demand_valid, finish, folder, has_its_digest, program, read, read_json, run, source, start, write


def wait_for_rows(name, least):
    """Until the share has a digest behind so many rows."""
    for _ in range(600):
        if (folder / name).exists() and any(int(n) >= least for n in re.findall(r"^# (\d+) ", read(name), re.M)):
            return
        time.sleep(0.02)
    demand(False, f"{name}: never {least} rows")


plan = {
    "schema": "impact-damper/plan/1",
    "description": "for a test",
    "scene_file": "mast.json",
    "grid": [{"number": "clearance", "from": 5, "to": 20, "count": 4, "scale": "logarithmic"}],
    "samples": {"count": 150, "seed": 7, "method": "latin_hypercube",
                "numbers": [{"number": "restitution", "standard_deviation": 0.2},
                            {"number": "clearance", "half_width": 0.1, "relative": True},
                            {"number": "secondary_mass", "from": 0.4, "to": 4, "scale": "logarithmic"}]},
    "quantities": ["time_to_amplitude=6", "impacts", "largest_loss_factor", "amplitude_of_largest_loss_factor",
                   "loss_factor_at=10", "largest_impact_speed", "largest_wall_force"],
}
shutil.copy(source / "data/examples/mast.json", folder)
write("plan.json", plan)

# The same bytes with any number of threads and parts.
for threads in (1, 2, 5):
    call("sweep", "plan.json", "--threads", threads, "-o", f"threads{threads}.csv")
table, description = read("threads1.csv"), read("threads1.csv.json")
for threads in (2, 5):
    demand(read(f"threads{threads}.csv") == table, f"{threads} threads: another table")
    demand(read(f"threads{threads}.csv.json") == description, f"{threads} threads: another description")
for part in (2, 3, 1):
    call("sweep", "plan.json", "--part", f"{part}/3", "-o", "parts.csv")
parts = [f"parts.csv.part-{part}-of-3" for part in (1, 2, 3)]
call("merge", parts[2], parts[0], parts[1], "-o", "parts.csv")
demand(read("parts.csv") == table, "parts: another table")
demand(read("parts.csv.json") == description, "parts: another description")
demand(sorted(each.name for each in folder.glob("*.part-*")) == parts, "shares are left over")

# Another seed is another table; the deviations do not depend on the grid.
write("seed.json", {**plan, "samples": {**plan["samples"], "seed": 8}})
call("sweep", "seed.json", "-o", "seed.csv")
demand(read("seed.csv") != table, "another seed makes the same table")

# What schemas say, and what other programs read.
whole = json.loads(description)
demand_valid("sweep", whole, "description")
demand_valid("plan", plan, "plan")
demand_valid("plan", json.loads((source / "data/examples/mast_plan.json").read_text()), "mast_plan.json")
demand(whole["table"] == {"rows": 600, "bytes": len(table), "sha256": hashlib.sha256(table.encode()).hexdigest()},
       f"the description of the table: {whole['table']}")
demand(has_its_digest(description), "the description's own digest")
rows = list(csv.DictReader(table.splitlines()))
demand(list(rows[0]) == [column["name"] for column in whole["columns"]], "columns are not as described")
demand("\r" not in table and len(rows) == 600, "not one row for each run")
units = {column["name"]: column["unit"] for column in whole["columns"]}
demand((units["time_to_amplitude_6"], units["largest_impact_speed"], units["clearance_sampled"]) == ("s", "mm/s", "mm"), f"units: {units}")

# A scene that is not valid has its row and its reason, and stops nothing.
wrong = [row for row in rows if not 0 <= float(row["restitution"]) <= 1]
demand(wrong and all(row["end"] == "not_valid" and row["problem"].startswith("restitution: must be ") and row["impacts"] == ""
                     for row in wrong), f"{len(wrong)} rows that are not valid")
demand(all(row["end"] == "done" and row["problem"] == "" for row in rows if row not in wrong), "a valid scene is not done")

# Rows hold the numbers of runs of their scenes.
for row in [row for row in rows if row not in wrong][::97]:
    scene = {**read_json("mast.json"), "clearance": float(row["clearance_sampled"]),
             "restitution": float(row["restitution"]), "secondary_mass": float(row["secondary_mass"])}
    write("scene.json", scene)
    made = json.loads(call("run", "--scene", "scene.json", "--record", "half_cycles,impacts"))
    length, second = made["units"]["length_m"] * 1e3, made["units"]["time_s"]
    half = made["half_cycles"]
    first = next(i for i, amplitude in enumerate(half["amplitude"]) if amplitude * length < 6)
    demand(math.isclose(float(row["time_to_amplitude_6"]), half["peak_time"][first] * second, rel_tol=1e-12), f"{row}: time")
    demand(int(row["impacts"]) == len(made["impacts"]["time"]), f"{row}: impacts")
    speed = max(map(abs, made["impacts"]["relative_velocity"])) * length / second
    demand(math.isclose(float(row["largest_impact_speed"]), speed, rel_tol=1e-12), f"{row}: speed")

# So do those of several dampers in units.
boxes = json.loads((source / "data/examples/mast_boxes.json").read_text())
write("boxes.json", boxes)
call("sweep", "--scene", "boxes.json", "--vary", "clearance_1=40mm,6cm", "--keep", "impacts", "-o", "boxes.csv")
for row in csv.DictReader(read("boxes.csv").splitlines()):
    boxes["dampers"][0]["clearance"] = float(row["clearance_1"])
    write("scene.json", boxes)
    made = json.loads(call("run", "--scene", "scene.json", "--record", "impacts"))
    demand(int(row["impacts"]) == len(made["impacts"]["time"]), f"{row}: impacts of several dampers in units")

# A natural frequency stands for the stiffness: twice as high, a decay takes half the time.
call("sweep", "--scene", "mast.json", "--vary", "natural_frequency=2Hz,4Hz", "--keep", "time_to_amplitude=6mm", "-o", "frequency.csv")
slow, fast = (float(row["time_to_amplitude_6"]) for row in csv.DictReader(read("frequency.csv").splitlines()))
demand(math.isclose(slow, 2 * fast, rel_tol=1e-9), f"natural frequency: {slow} s and {fast} s")

# Wall forces of an assumed stiffness are said to be, by the sweep and beside its map; those of a given one are not.
def said_of_walls(*words):
    axes = ["--vary", "clearance=5mm,6mm", "--vary", "restitution=0.5,0.6"]
    swept = run(program, "sweep", "--scene", "mast.json", *axes, *words, "--keep", "largest_wall_force", "-o", "walls.csv")
    return swept.stderr, call("map", "walls.csv", "--x", "clearance", "--y", "restitution", "--z", "largest_wall_force", "-o", "walls.svg")


for said in said_of_walls():
    demand("largest_wall_force is that of walls 10000 times as stiff as the primary spring, 1.6e+08 N/m: the program's default, an "
           "assumption." in said, f"assumed walls: {said}")
for said in said_of_walls("--contact-stiffness", "1e7N/m"):
    demand("assumption" not in said, f"given walls: {said}")

# Killed, and again, and interrupted: the same command goes on, to the same bytes.
slow = {**plan, "quantities": plan["quantities"] + ["impact_energy_share"]}
write("slow.json", slow)
call("sweep", "slow.json", "-o", "undisturbed.csv")
words = ["sweep", "slow.json", "--threads", "2", "-o", "killed.csv"]
share = "killed.csv.part-1-of-1"
for least, end in ((64, signal.SIGKILL), (192, signal.SIGKILL), (320, signal.SIGINT)):
    process = start(*words)
    wait_for_rows(share, least)
    process.send_signal(end)
    said = process.communicate()[1]
    demand(process.returncode == (130 if end == signal.SIGINT else -end), f"{end}: exit code {process.returncode}: {said}")
    if end == signal.SIGINT:
        demand(re.search(r"^impact-damper: interrupted: \d+ of 600 runs are kept in killed.csv.part-1-of-1; the same command goes on "
                         r"from there$", said, re.M), f"interrupted: {said}")
    demand(not (folder / "killed.csv").exists(), f"{end}: a table that is not whole")
kept = read(share)
# Another plan or another program is not mixed with what is kept.
said = call("sweep", "plan.json", "-o", "killed.csv", code=3)
demand("killed.csv.part-1-of-1: holds runs of another plan, part or program" in said and "the program is the same" in said, f"another plan: {said}")
demand(read(share) == kept, "another plan has changed what was kept")
version = re.search(r'"program": "(\S+)', kept)[1]
write(share, kept.replace(f'"program": "{version}', '"program": "9.9.9', 1))
said = call(*words, code=3)
demand("of another plan, part or program" in said and "this program is " in said, f"another version: {said}")
write(share, kept)
call(*words)
demand(read("killed.csv") == read("undisturbed.csv"), "killed: another table")
demand(not list(folder.glob("*killed*part*")) and not list(folder.glob(".*")), "killed: files are left")

# Of parts that are not those of one table (../sweeps/sweep_table.cpp: each way) none is made.
for files, code, expected in (([], 3, "part 2 of 3 is missing"), (["nowhere"], 5, "nowhere: cannot be read")):
    said = call("merge", parts[0], *files, parts[2], "-o", "wrong.csv", code=code)
    demand(expected in said, f"merge of {files}: {said}")
    demand(not (folder / "wrong.csv").exists() and not (folder / "wrong.csv.json").exists(), f"merge of {files}: a table")

# The same numbers as HDF5, with another program to read them; from three shares, the same bytes.
said = call("sweep", "plan.json", "--threads", 2, "-o", "table.h5", code=None)
if not shutil.which("h5dump") or "built without the HDF5 library" in said:
    print("not tried: HDF5, for want of h5dump (hdf5-tools), or of libhdf5-dev when the program was built")
else:
    for column in whole["columns"]:
        name = column["name"]
        shown = subprocess.run(["h5dump", "-y", "-w", "0", "-m", "%.17g", "-d", name, folder / "table.h5"], capture_output=True, text=True).stdout
        values, *attributes = re.findall(r"^ +DATA \{\n(.*?)\n *\}", shown, re.M | re.S)
        expected = [row[name] for row in rows]
        if name in ("end", "problem"):
            same = re.findall(r'"((?:[^"\\]|\\.)*)"', values) == [text.replace('"', '\\"') for text in expected]
        else:
            values = [float(each) for each in values.split(",")]
            same = len(values) == len(expected) and all(math.isnan(value) if text == "" else value == float(text)
                                                        for text, value in zip(expected, values))
        demand(same, f"HDF5: the column {name}")
        demand([each.strip() for each in attributes] == [f'"{column["meaning"]}"', f'"{column["unit"]}"'], f"HDF5: {attributes}")
    holds, made = json.loads(read("table.h5.json"))["table"], (folder / "table.h5").read_bytes()
    demand(holds == {"rows": 600, "bytes": len(made), "sha256": hashlib.sha256(made).hexdigest()}, f"HDF5: {holds}")
    time.sleep(1.1)  # a time of day in the file would be another one
    call("merge", parts[2], parts[0], parts[1], "-o", "merged.h5")
    demand((folder / "merged.h5").read_bytes() == made, "HDF5 from parts: other bytes")
    for name in ("merged.hdf5", "merged.hdf", "merged.H5"):
        call("merge", *parts, "-o", name)
        demand((folder / name).read_bytes() == made, f"{name}: is not HDF5")

# Two at a time do not write one share.
first = start(*words[:-1], "both.csv")
wait_for_rows("both.csv.part-1-of-1", 0)
demand("another sweep is writing it" in call(*words[:-1], "both.csv", code=5), "two sweeps at a time")
first.communicate()
demand(first.returncode == 0 and read("both.csv") == read("undisturbed.csv"), "the first of two sweeps")

finish()
