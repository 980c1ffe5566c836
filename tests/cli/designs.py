"""What `design` says of a design is what `run` and `sweep` say of it, with any number of threads.
"""
import csv
import json
import math

from trial import call, demand, demand_valid, finish, has_its_digest, read, read_json, source, write


def close(a, b, digits=12):
    return math.isclose(a, b, rel_tol=10**-digits)


def first_peak_below(scene, amplitude, engine="exact"):
    """In seconds, by `run` with the motion itself: the largest |x| between two zero crossings of it, from samples of one half cycle."""
    write("scene.json", scene)
    run = json.loads(call("run", "--scene", "scene.json", "--engine", engine))
    length, second = run["units"]["length_m"] * 1e3, run["units"]["time_s"]
    half = run["half_cycles"]
    n = next(i for i, height in enumerate(half["amplitude"]) if height * length < amplitude)
    begin, end = half["zero_crossing"][n - 1], half["zero_crossing"][n]
    motion = json.loads(call("run", "--scene", "scene.json", "--engine", engine, "--record", "history", "--history", f"{begin * second!r}:{end * second!r}:20001"))["history"]
    return max(zip(map(abs, motion["x"]), motion["time"]))[1] * second


mast = json.loads((source / "data/examples/mast.json").read_text())
write("mast.json", mast)
words = ("design", "--scene", "mast.json", "--to", 20, "--within", 5, "--share", 0.8, "--neighbours", 1000, "--secondary-mass", "1:8",
         "--clearance", "20:50")
printed = call(*words, "--threads", 1, "-o", "1.json", "--write-plan", "plan.json")
text = read("1.json")
for threads in (2, 5):
    demand(call(*words, "--threads", threads, "-o", "n.json") == printed, f"{threads} threads: another table")
    demand(read("n.json") == text, f"{threads} threads: another file")
answer = json.loads(text)

demand_valid("design", answer, "1.json")
demand(has_its_digest(text), "the file's own digest")
demand("1.json: valid" in call("check", "design", "1.json"), "check does not allow a file as it was written")
write("altered.json", text.replace('"met": true', '"met": false'))
call("check", "design", "altered.json", code=3)
call("check", "comparison", "1.json", code=3)

# The plan of the check, made by `sweep`, has the numbers of the first design (all of them: ../sweeps/lightest_design.cpp).
best = answer["designs"][0]
call("sweep", "plan.json", "-o", "check.csv")
rows = list(csv.DictReader(read("check.csv").splitlines()))
times = sorted(float(row["time_to_amplitude_20"]) for row in rows)
demand(answer["met"] and len(times) == 1000, f"met: {answer['met']}, {len(times)} times")
demand(best["in_time"] == sum(t <= 5 for t in times), f"in time: {best['in_time']}")
demand(times[-1] == best["slowest"] and times[799] == best["time_of_share"], f"times: {times[-1]}, {times[799]}, {best}")
for key in ("largest_impact_speed", "largest_wall_force"):
    demand(max(float(row[key]) for row in rows) == best[key], f"{key}: {best[key]}")

# The design and some of its neighbours, by `run`. Samples are a 20 000th of half a period apart, 8e-6 s.
designed = {**mast, "secondary_mass": best["secondary_mass"], "clearance": best["clearance"]}
demand(abs(first_peak_below(designed, 20) - best["nominal_time"]) < 1e-5, f"nominal time: {best['nominal_time']}")
for row in rows[::250]:
    scene = {**designed, "clearance": float(row["clearance"]), "restitution": float(row["restitution"])}
    demand(abs(first_peak_below(scene, 20) - float(row["time_to_amplitude_20"])) < 1e-5, f"{row}: time")

# Other draws give another check and nearly the same design, confirmed or not.
call(*words, "--seed", 5, "-o", "other.json", code=None)
other = read_json("other.json")["designs"][0]
demand(other["slowest"] != best["slowest"], "another seed has the same neighbours")
demand(abs(math.log(other["secondary_mass"] / best["secondary_mass"])) < 0.1, f"another seed: {other['secondary_mass']} kg")

# With friction and weight the search is by runs that have them: its time again, and that of a neighbour.
rubbed = {**mast, "friction_coefficient": 0.2, "inclination": 2}
write("rubbed.json", rubbed)
said = call("design", "--scene", "rubbed.json", *words[3:], "--engine", "restitution", "-o", "rubbing.json", "--write-plan", "plan.json")
rubbing = read_json("rubbing.json")
demand_valid("design", rubbing, "rubbing.json")
demand(rubbing["question"]["scene"]["friction_coefficient"] == 0.2, f"the scene of the question: {rubbing['question']['scene']}")
found = rubbing["designs"][0]
designed = {**rubbed, "secondary_mass": found["secondary_mass"], "clearance": found["clearance"]}
demand(abs(first_peak_below(designed, 20, "restitution") - found["nominal_time"]) < 1e-5, f"with friction: {found}")
call("sweep", "plan.json", "-o", "check.csv")
row = list(csv.DictReader(read("check.csv").splitlines()))[7]
neighbour = {**designed, "clearance": float(row["clearance"]), "restitution": float(row["restitution"])}
demand(abs(first_peak_below(neighbour, 20, "restitution") - float(row["time_to_amplitude_20"])) < 1e-5, f"with friction: {row}")
held = (1 + found["secondary_mass"] / 40) * 9806.65 / 400 * (0.2 * math.cos(math.radians(2)) + math.sin(math.radians(2)))
demand(f"Up to {held:.3g} mm that secondary mass is held at rest" in said, f"with friction, held up to {held}: {said}")

# A scene without units: the mast with its box of 10 mm, in clearances of it. Times are in units of 0.05 s.
same = ("design", "--mass-ratio", 0.04, "--damping-ratio", 0.002, "--x0", 6, "--to", 2, "--within", 100, "--share", 0.8, "--neighbours", 1000,
        "--secondary-mass", f"{best['secondary_mass'] / 40}:0.2", "--clearance", f"2:{best['clearance'] / 10}", "-o", "scaled.json")
call(*same)
scaled = read_json("scaled.json")
demand_valid("design", scaled, "dimensionless")
first = scaled["designs"][0]
demand(scaled["units"]["time"] == "1/Omega_n" and close(first["secondary_mass"] * 40, best["secondary_mass"]) and
       close(first["clearance"] * 10, best["clearance"]), f"dimensionless: {first}")
for key, unit in (("nominal_time", 0.05), ("largest_impact_speed", 200), ("largest_wall_force", 160)):
    demand(close(first[key] * unit, best[key], 3 if key != "nominal_time" else 9), f"dimensionless: {key}: {first[key] * unit}")

# Under a force: the plans of its check, made by `sweep`, have its numbers, with any number of threads.
machine = ("design", "--scene", source / "data/examples/machine.json", "--engine", "restitution", "--under-force", 5, "--frequencies", "3.5:5", "--at-most", 2.5,
           "--from", 20, "--to", 2, "--within", 15, "--share", 0.5, "--neighbours", 100, "--secondary-mass", "3.5:4.2", "--clearance", "5:5.4")
printed = call(*machine, "--threads", 1, "-o", "forced.json", "--write-plan", "steady.json", "--write-decay-plan", "decay.json")
demand(call(*machine, "--threads", 3, "-o", "n.json") == printed and read("n.json") == read("forced.json"), "under a force: 3 threads: another answer")
pushed = read_json("forced.json")
demand_valid("design", pushed, "forced.json")
found = pushed["designs"][0]
call("sweep", "steady.json", "-o", "steady.csv")
call("sweep", "decay.json", "-o", "decay.csv")
steady, decay = ([float(row[column]) for row in csv.DictReader(read(table).splitlines())]
                 for table, column in (("steady.csv", "worst_steady_amplitude"), ("decay.csv", "time_to_amplitude_2")))
demand(pushed["met"] and len(steady) == found["neighbours"] == 100, f"under a force: {found}")
demand(found["worst_amplitude"] == max(steady) and found["amplitude_of_share"] == sorted(steady)[49], f"under a force: {found}")
demand(found["in_time"] == sum(a <= 2.5 and t <= 15 for a, t in zip(steady, decay)) and found["slowest"] == max(decay), f"under a force: {found}")
rows = list(csv.DictReader(read("steady.csv").splitlines()))
worst = max(rows, key=lambda row: float(row["worst_steady_amplitude"]))
demand(found["worst_frequency"] == float(worst["worst_frequency"]), f"under a force: {found['worst_frequency']}")
demand(printed.splitlines()[5].split()[:2] == [f"{found['worst_amplitude']:.3g}", f"{found['worst_frequency']:.3g}"], f"the worst is not first: {printed}")
stiffness = 120 * (2 * math.pi * 4.2) ** 2
alone = 5e3 / stiffness / (2 * 0.005 * math.sqrt(1 - 0.005**2))
demand(close(pushed["alone"]["amplitude"], alone), f"alone: {pushed['alone']}, not {alone}")

# The same machine without units, in clearances of 5 mm.
hertz = 4.2
call("design", "--damping-ratio", 0.005, "--x0", 4, "--engine", "restitution", "--under-force", 5 / (stiffness * 5e-3), "--frequencies", f"{3.5 / hertz}:{5 / hertz}",
     "--at-most", 0.5, "--share", 0.5, "--neighbours", 100, "--secondary-mass", f"{found['secondary_mass'] / 120}:0.06", "--clearance",
     f"{found['clearance'] / 5}:1.61", "-o", "scaled.json", code=None)
scaled = read_json("scaled.json")
demand_valid("design", scaled, "dimensionless, under a force")
demand(close(scaled["alone"]["amplitude"] * 5, alone, 9) and scaled["units"]["frequency"] == "Omega_n" and scaled["designs"][0]["time"] is None, f"dimensionless: {scaled}")
demand(abs(scaled["designs"][0]["worst_frequency"] - 1) < 0.05, f"dimensionless: {scaled['designs'][0]}")

# Not met: what is reached, and what may do.
said = call("design", "--damping-ratio", 0.02, "--under-force", 0.02, "--frequencies", "0.8:1.2", "--at-most", 0.2, "--secondary-mass", 0.04, "--clearance", "1:1.05",
            "--engine", "restitution", "--share", 0.5, "--neighbours", 100, "-o", "unmet.json", code=1)
unmet = read_json("unmet.json")
demand_valid("design", unmet, "not met under a force")
demand(not unmet["met"] and unmet["designs"][0]["in_time"] == 0 and unmet["designs"][0]["worst_amplitude"] > 0.2, f"not met under a force: {unmet}")
demand("A heavier secondary mass, a larger amplitude or narrower tolerances may do." in said and "steady amplitude is 0.5 epsilon at 1 Omega_n" in said,
       f"not met under a force: {said}")

# No damper is needed: said so at once, in the file too.
said = call("design", "--scene", "mast.json", "--under-force", 2, "--frequencies", "4:5", "--at-most", 1, "-o", "none.json")
none = read_json("none.json")
demand_valid("design", none, "none needed")
demand("No damper is needed." in said and none["none_needed"] and none["met"] and not none["designs"], f"none needed: {said}")

# Neighbours that cannot decide, however many of them are in time, do not make a design unconfirmed.
few = call("design", "--scene", "mast.json", "--to", 20, "--within", 5, "--secondary-mass", "6:8", "--clearance", "40:41", "--neighbours", 100, code=1)
demand("100 neighbours are too few to tell" in few and "give at least --neighbours 381." in few and "not confirmed" not in few, f"few neighbours: {few}")

# Not in time: said so, with the heaviest mass.
said = call(*words[:6], 1.5, *words[7:], "-o", "none.json", code=1)
none = read_json("none.json")
demand("No design was found." in said and "A heavier secondary mass" in said, f"none: {said}")
demand(not none["met"] and [each["secondary_mass"] for each in none["designs"]] == [8], f"none: {none}")
demand_valid("design", none, "none")

finish()
