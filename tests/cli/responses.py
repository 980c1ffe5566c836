"""What `response` writes is what data/schema/response.schema.json says, ends with its digest, and its CSV holds the same numbers.

That they are right is tested in ../steady/.
"""
import csv
import json
import math
import os
import pty
import re
import signal

from trial import call, demand, demand_valid, finish, folder, has_its_digest, read, read_json, source, start, write


def respond(file, *words):
    call("response", *words, "-o", file)
    return read(file)


def rows_of(file, *words):
    return list(csv.DictReader(respond(file, *words, "--format", "csv").splitlines()))


def examined(text, what):
    """The document, which must obey the schema and end with the digest of what is before."""
    demand_valid("response", json.loads(text), what)
    demand(has_its_digest(text), f"{what}: the digest is another")
    return json.loads(text)


short = ["--max-periods", 300]
forced = ["--mass-ratio", 0.1, "--damping-ratio", 0.01, "--force-amplitude", 0.05, "--x0", 1]
sweeps = {
    "exact": [*forced, "--vary", "force_frequency=0.9:1.1:5", "--start=-0.5:0:0.5:0.1", *short],
    "restitution": [*forced, "--engine", "restitution", "--vary", "force-amplitude=0.02:0.06:3", *short],
    "undamped": ["--force-amplitude", 0.004, "--vary", "force_frequency=0.9:1:2", *short],  # infinite at 1
    "budget": [*forced, "--vary", "force_frequency=0.9:1.1:3", "--max-impacts", 2],
    "several": ["--scene", "boxes.json", "--vary", "force_frequency=0.95:1.05:3", "--start=-0.5:0.2", *short],
    "units": ["--scene", source / "data/examples/mast_in_wind.json", "--vary", "exciting_frequency=3.05Hz:3.25Hz:3", *short],
}
write("boxes.json", {"damping_ratio": 0.01, "force_amplitude": 0.05, "x0": 1, "until_time": 1, "dampers": [
    {"mass_ratio": 0.05, "y0": 0.5}, {"mass_ratio": 0.03, "clearance": 2, "y0": 0.3}]})
for name, words in sweeps.items():
    document = examined(respond(f"{name}.json", "sweep", *words), name)
    ways = [(n, way, each[way]) for n, each in enumerate(document["sweeps"]) for way in ("up", "down")]
    count = document["axis"]["count"]
    for n, way_name, way in ways:  # of several dampers with their columns as the CSV names them
        for number, its in enumerate(way.pop("dampers", []), 1):
            way.update({f"{column}_{number}": values for column, values in its.items()})
    for _, _, way in ways:
        demand({len(column) for column in way.values()} == {count}, f"{name}: columns are not equally long")
    header, *rows = csv.reader(respond(f"{name}.csv", "sweep", *words, "--format", "csv").splitlines())
    demand(header[:4] == ["sweep", "way", document["axis"]["number"], "end"], f"{name}.csv: its header is {header}")
    demand(len(rows) == len(ways) * count, f"{name}.csv: {len(rows)} rows")
    for index, (n, way_name, way) in enumerate(ways):
        for i in range(count):
            row = dict(zip(header, rows[index * count + i]))
            demand((row["sweep"], row["way"], row["end"]) == (str(n), way_name, way["end"][i]), f"{name}.csv: {row}")
            wanted = {**way, "empty_amplitude": document["empty_amplitude"], "locked_amplitude": document["locked_amplitude"],
                      document["axis"]["number"]: document["values"]}
            for column in header[2:]:
                if column != "end":
                    given = float(row[column]) if row[column] else None
                    demand(given == wanted[column][i], f"{name}.csv: {column} is {given}, not {wanted[column][i]}")
    # The amplitudes of the linear oscillators, from the scene alone.
    for i, value in enumerate(document["values"]):
        scene = {**document["scene"], document["axis"]["number"]: value}
        for column, mass in (("empty_amplitude", 1), ("locked_amplitude", 1 + sum(each["mass_ratio"] for each in scene.get("dampers", [scene])))):
            h = abs(complex(1 - mass * scene["force_frequency"] ** 2, 2 * scene["damping_ratio"] * scene["force_frequency"]))
            given = document[column][i]
            demand(given is None if h == 0 else math.isclose(given, abs(scene["force_amplitude"]) / h, rel_tol=1e-12),
                   f"{name}: {column} is {given} at {value}")

budget = read_json("budget.json")
demand("impact_budget" in budget["sweeps"][0]["up"]["end"] and None in budget["sweeps"][0]["up"]["amplitude"], "budget: none")


# In SI: the same rows in other units.
def compare_units(file, plain, columns, *words):
    for row, own in zip(rows_of(file, *words, "--si"), csv.DictReader(read(plain).splitlines()), strict=True):
        for column, (name, scale) in columns.items():
            demand((row[column] == "") == (own[name] == "") and
                   (not row[column] or math.isclose(float(row[column]), float(own[name]) * scale, rel_tol=1e-12)),
                   f"{file}: {column} is {row[column]}")


units = read_json("units.json")
length, time, force = (units["units"][key] for key in ("length_m", "time_s", "force_N"))
demand([round(v / time / 2 / math.pi, 9) for v in units["values"]] == [3.05, 3.15, 3.25], f"units: {units['values']}")
SI = {"force_frequency_Hz": ("force_frequency", 1 / (2 * math.pi * time)), "amplitude_m": ("amplitude", length),
      "v_m_per_s": ("v", length / time), "power_W": ("power", units["units"]["energy_J"] / time), "lag_deg": ("lag_deg", 1)}
compare_units("si.csv", "units.csv", SI, "sweep", *sweeps["units"])

basins = {
    "initial": [*forced, "--force-frequency", 0.9, "--vary", "x0=-1:1:9", "--vary", "v0=-1:1:7", "--engine", "restitution"],
    "parameters": [*forced, "--vary", "force_frequency=0.8:1.2:5", "--vary", "mass_ratio=0.05:0.1:3", *short],
    "starts": ["--scene", source / "data/examples/mast_in_wind.json", "--vary", "initial_displacement=-20mm:20mm:3",
               "--vary", "exciting_force=1N:2N:2", *short],
}
for name, words in basins.items():
    document = examined(respond(f"{name}.json", "basin", *words), name)
    (first, second), attractor = document["axes"], document["attractor"]
    demand(len(attractor) == first["count"] * second["count"], f"{name}: {len(attractor)} points")
    demand(attractor.count(-1) == document["undecided"], f"{name}: undecided")
    for index, each in enumerate(document["attractors"]):
        demand(attractor.count(index) == each["points"], f"{name}: {each}")
    header, *rows = csv.reader(respond(f"{name}.csv", "basin", *words, "--format", "csv").splitlines())
    demand(header == [first["number"], second["number"], "attractor"], f"{name}.csv: its header is {header}")
    for n, row in enumerate(rows):
        place = [axis["from"] + (axis["to"] - axis["from"]) * i / (axis["count"] - 1)
                 for axis, i in ((first, n % first["count"]), (second, n // first["count"]))]
        demand(all(math.isclose(float(a), b, rel_tol=1e-12, abs_tol=1e-12) for a, b in zip(row, place)), f"{name}.csv: {row}")
        demand(row[2] == str(attractor[n]), f"{name}.csv: {row}")
    demand(len(rows) == len(attractor), f"{name}.csv: {len(rows)} rows")
starts = read_json("starts.json")
demand([axis["from"] for axis in starts["axes"]] == [-2, 1 / 160], f"starts: {starts['axes']}")

# Branches of orbits: the table holds their points and, in their places, the events.
rigid = ["--engine", "restitution", "--mass-ratio", 0.02]
two_impacts = [*rigid, "--damping-ratio", 0.1, "--force-amplitude", 0.0655307, "--force-frequency", 0.9]
doubling = [*rigid, "--damping-ratio", 0.02, "--force-frequency", 0.9]
branches = {
    "folds": [*two_impacts, "--vary", "force_frequency=0.9:2.5"],
    "flips": [*doubling, "--vary", "force_amplitude=0.05:0.12"],
    "few": [*doubling, "--vary", "force_amplitude=0.05:0.12", "--max-branches", 1, "--largest-step", 0.01],
    "mast": ["--scene", source / "data/examples/mast_in_wind.json", "--vary", "exciting_frequency=3.09Hz:3.0Hz", "--start=0:0:5mm:0"],
    "chaotic": [*forced, "--force-frequency", 0.9, "--vary", "force_amplitude=0.05:0.06", "--max-periods", 20],
    "slides": ["--engine", "restitution", "--mass-ratio", 0.1, "--damping-ratio", 0.05, "--friction", 0.15, "--force-amplitude", 0.25,
               "--force-frequency", 0.8, "--x0", 1, "--y0", 0.3, "--vary", "force_frequency=0.8:0.81"],
}
found = {}
for name, words in branches.items():
    document = found[name] = examined(respond(f"{name}.json", "orbits", *words), name)
    number = document["range"]["number"]
    demand(document["complete"] == (name != "few"), f"{name}: complete is {document['complete']}")
    header, *rows = csv.reader(respond(f"{name}.csv", "orbits", *words, "--format", "csv").splitlines())
    demand(header[:3] == ["branch", "event", number], f"{name}.csv: its header is {header}")
    rows = [dict(zip(header, row)) for row in rows]
    for index, branch in enumerate(document["branches"]):
        columns = {"values" if column == number else column: column for column in header[2:]}
        demand({len(branch[column]) for column in columns} == {len(branch["values"])}, f"{name}: columns are not equally long")
        own = [row for row in rows if row["branch"] == str(index)]
        points = [row for row in own if not row["event"]]
        demand(len(points) == len(branch["values"]), f"{name}.csv: {len(points)} points")
        for i, row in enumerate(points):
            for column, heading in columns.items():
                given = float(row[heading]) if row[heading] else None
                demand(given == branch[column][i], f"{name}.csv: {heading} is {given}, not {branch[column][i]}")
        told = [(sum(not before["event"] for before in own[:i]), row) for i, row in enumerate(own) if row["event"]]
        demand(len(told) == len(branch["events"]), f"{name}.csv: {len(told)} events")
        for (before, row), event in zip(told, sorted(branch["events"], key=lambda each: each["points_before"])):
            demand((before, row["event"], float(row[number])) == (event["points_before"], event["kind"], event["value"]),
                   f"{name}.csv: {row}")
            demand({key: float(row[key]) for key in "xvyw"} == event["state"], f"{name}.csv: {row}")
    demand(len(rows) == sum(len(each["values"]) + len(each["events"]) for each in document["branches"]), f"{name}.csv: rows")
demand(all(("stop_margin" in branch) == (name == "slides") for name, each in found.items() for branch in each["branches"]), "stop_margin")
demand(max(found["slides"]["branches"][0]["stop_margin"]) > 0.01, f"slides: {found['slides']['branches'][0]['stop_margin']}")
demand([start["branch"] for start in found["chaotic"]["starts"]] == [None] and not found["chaotic"]["branches"], "chaotic: a branch")
demand([start["end"] for start in found["mast"]["starts"]] == ["periodic"] * 2, "mast: a start")

# A grazing of the stable motion of twice the period, by a sweep from one of its sides to the other.
branch = found["flips"]["branches"][2]
event = next(each for each in branch["events"] if each["kind"] == "grazing")
point = {key: branch[key][event["points_before"] - 1] for key in ("period", "impacts_left", "impacts_right", "symmetric", *"xvyw")}
swept = json.loads(respond("swept.json", "sweep", *doubling, "--vary", f"force_amplitude={event['value'] - 1e-7!r}:{event['value'] + 1e-7!r}:2",
                           "--start=" + ":".join(str(point.pop(key)) for key in "xvyw"), "--max-periods", 50000))["sweeps"][1]["up"]
demand([all(swept[key][i] == point[key] for key in point) for i in (0, 1)] == [True, False], f"flips: no grazing at {event['value']}: {swept}")

exponents = ["lyapunov", *doubling, "--force-amplitude", 0.05, "--periods", 40, "--discard", 30]
document = examined(respond("exponents.json", *exponents), "exponents")
plain = rows_of("exponents.csv", *exponents)
demand([[float(row[key]) for row in plain] for key in ("exponent", "standard_error")] ==
       [document["exponents"], document["standard_errors"]], "exponents.csv: other numbers")
document = examined(respond("several_orbits.json", "orbits", "--scene", "boxes.json", "--vary", "force_frequency=1:1.01",
                            "--max-points", 4, "--max-branches", 1), "orbits of several dampers")
demand(len(document["branches"][0]["dampers"]) == 2 and len(document["branches"][0]["values"]) > 1,
       f"orbits of several dampers: {document['branches']}")

boxes = ["--scene", "boxes.json", "--engine", "restitution", "--force-frequency", 0.95]
document = examined(respond("several.json", "lyapunov", *boxes, "--periods", 10, "--discard", 0), "exponents of several dampers")
demand(len(document["exponents"]) == 6, f"exponents of several dampers: {document['exponents']}")
ended = examined(respond("ended.json", "lyapunov", *forced, "--force-frequency", 0.9, "--max-impacts", 1), "ended")
demand((ended["stop_reason"], ended["exponents"], ended["standard_errors"]) == ("impact_budget", [], []), "ended: exponents")

# In SI.
mast = ["--scene", source / "data/examples/mast_in_wind.json"]
units = found["mast"]["units"]
length, time = units["length_m"], units["time_s"]
SI = {"force_frequency_Hz": ("force_frequency", 1 / (2 * math.pi * time)), "amplitude_m": ("amplitude", length),
      "slowest_impact_m_per_s": ("slowest_impact", length / time), "nearest_miss_m": ("nearest_miss", length),
      "y_m": ("y", length), "w_m_per_s": ("w", length / time), "multiplier_1_re": ("multiplier_1_re", 1)}
compare_units("mast_si.csv", "mast.csv", SI, "orbits", *branches["mast"])
rates = ["lyapunov", *mast, "--periods", 50]
rows_of("rates.csv", *rates)
compare_units("rates_si.csv", "rates.csv", {f"{name}_per_s": (name, 1 / time) for name in ("exponent", "standard_error")}, *rates)

# All of them are valid to `check`, whose complaint about an altered one names it and the place.
files = sorted(file.name for file in folder.glob("*.json") if '"impact-damper/response/1"' in file.read_text())
demand(len(files) > 15, f"check: only {files}")
demand(call("check", "response", *files) == "".join(f"{name}: valid\n" for name in files), "check: not each is valid")
text = read("exact.json")
for old, new, says in (('"mass_ratio": 0.1', '"mass_ratio": 0.11', "altered.json: /locked_amplitude/0: must be "),
                       ('"end": ["periodic"' if '"end": ["periodic"' in text else '"end": ["not_periodic"', '"end": ["step_budget"',
                        "must be null, got ")):
    write("altered.json", text.replace(old, new, 1))
    said = call("check", "response", "altered.json", code=3)
    demand(says in said, f"check: {said}")

# Tables and verdicts use a response only if it is the catalogue's.
scenes = source / "data/scenes"
(folder / "runs").mkdir()
write("catalogue.json", {
    "schema": "impact-damper/catalogue/1", "scenes": [{"scene": "nu2-e06", "record": ["half_cycles"]}],
    "responses": [{"name": "low", "scene": "nu2-e06", "set": {"x0": 0, "force_amplitude": 0.008}, "kind": "sweep",
                   "rule": {"max_periods": 100, "mean_periods": 10, "nudge": 1e-6},
                   "vary": [{"number": "force_frequency", "from": 0.95, "to": 1.01, "count": 3}],
                   "start": [{"x": 2, "v": 0, "y": 0, "w": 0}]}],
    "figures": [{"figure": "1", "title": "t", "table": "response", "responses": ["low"], "script": "fig01.gp"}]})


def series(code, says):
    said = call("series", "--catalogue", "catalogue.json", "--runs", "runs", "--scenes", scenes, code=code)
    demand(says in said, f"series: not {says}: {said}")


asked = ["--scene", scenes / "nu2-e06.json", "--quiet", "--x0", 0, "--force-amplitude", 0.008, "--max-periods", 100, "--mean-periods", 10]
varied = ["--vary", "force_frequency=0.95:1.01:3", "--start=2:0:0:0", "--nudge=1e-6"]
series(5, "figure 1: runs/low.json: cannot be read: No such file or directory; made by: impact-damper response sweep --scene ")
for code, says, words in (
        (0, "# empty-1", varied),
        (3, "figure 1: runs/low.json: /scene/restitution: must be 0.6 as in response low of the catalogue, got 0.7", [*varied, "--restitution", 0.7]),
        (3, "figure 1: runs/low.json: /engine: must be ", [*varied, "--engine", "restitution"]),
        (3, "figure 1: runs/low.json: /rule: must be ", [*varied, "--tolerance", 1e-6]),
        (3, "figure 1: runs/low.json: /sweeps/2/start: must be none as in response low of the catalogue, got ", [*varied, "--start=1:0:0:0"]),
        (3, "/sweeps/1/nudge: must be 1e-06 as in response low of the catalogue, got 2e-06", [*varied[:-1], "--nudge=2e-6"]),
        (3, "/axis: must be ", ["--vary", "force_frequency=0.95:1.02:3", *varied[2:]])):
    respond("runs/low.json", "sweep", *asked, *words)
    series(code, says)
respond("runs/low.json", "orbits", *asked[:-2], "--vary", "force_frequency=0.95:1.01")
series(3, "/kind: must be sweep as in response low of the catalogue, got orbits")

# One damper in cavities of other clearances, that of its own scene among them, and as scenes of their own.
def amplitudes(scene_words, *words):
    rows = csv.DictReader(call("response", "sweep", "--scene", source / "data/examples/mast_in_wind.json", "--damping-ratio", 0.05, "--exciting-force", "20N",
                               *scene_words, *words, "--format", "csv", "--si", "--quiet").splitlines())
    return [float(row["amplitude_m"]) for row in rows if row["way"] == "up"]


listed = amplitudes(["--clearance", "2mm"], "--vary", "clearance=1mm:3mm:3")
for clearance, amplitude in zip((1, 2, 3), listed):
    alone = amplitudes(["--clearance", f"{clearance}mm"], "--vary", "exciting_frequency=3.15Hz:3.2Hz:2")[0]
    demand(math.isclose(alone, amplitude, rel_tol=1e-9), f"clearance {clearance} mm: {amplitude} m, as a scene of its own {alone} m")

# Progress is for a terminal, where one line is rewritten. Interrupted: one line that says what is left, and no file, also
# none half written.
terminal, its_end = pty.openpty()
long = ["response", "basin", *forced, "--vary", "x0=-1:1:2000", "--vary", "v0=-1:1:2000", "-o", "long.json"]
piped, process = start(*long), start(*long, stderr=its_end)
os.close(its_end)


def shown(until):
    """What the terminal shows up to this text, or to its end."""
    text = b""
    try:
        while until not in text and (part := os.read(terminal, 4096)):
            text += part
    except OSError:  # nobody writes there any more
        pass
    return text


progress = shown(b"points")
demand(re.fullmatch(rb"\r\x1b\[Kresponse: \d+ of 4000000 points", progress), f"progress on a terminal: {progress}")
for each in (piped, process):
    each.send_signal(signal.SIGINT)
said = "impact-damper: interrupted: long.json is not written"
rest = shown(b"never")
demand(rest.endswith(f"\r\x1b[K{said}\r\n".encode()) and rest.count(b"\n") == 1, f"interrupted on a terminal: {rest}")
demand(piped.communicate()[1] == said + "\n", "interrupted: a pipe shows progress before ten seconds")
for each in (piped, process):
    demand(each.wait() == 130, f"interrupted: exit code {each.returncode}")
demand(not list(folder.glob("*long*")), "interrupted: a file is left")

finish()
