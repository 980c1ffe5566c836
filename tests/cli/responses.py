"""What `response` writes is what data/schema/response.schema.json says, ends with its digest, and its CSV holds the same numbers.

    responses.py PROGRAM SOURCE FOLDER        FOLDER, made anew, is for the files
"""
import csv
import hashlib
import json
import math
import pathlib
import shutil
import signal
import subprocess
import sys

try:
    from jsonschema import Draft7Validator, RefResolver
except ImportError:
    print("skipped: Python's jsonschema is not here (Debian: python3-jsonschema)")
    sys.exit(77)

program, source, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3])
path = source / "data/schema/response.schema.json"
schema = json.loads(path.read_text(encoding="utf-8"))
Draft7Validator.check_schema(schema)
validator = Draft7Validator(schema, resolver=RefResolver(path.as_uri(), schema))
faults = []


def demand(holds, what):
    if not holds:
        faults.append(what)


def respond(file, *words):
    done = subprocess.run([str(program), "response", *map(str, words), "-o", file], cwd=folder, capture_output=True, text=True)
    demand(done.returncode == 0, f"{words}: exit code {done.returncode}: {done.stderr}")
    return (folder / file).read_text(encoding="utf-8")


def examined(text, what):
    """The document, which must obey the schema and end with the digest of what is before."""
    document = json.loads(text)
    for error in validator.iter_errors(document):
        faults.append(f"{what}: {list(error.absolute_path)}: {error.message[:200]}")
    body, _, seal = text.rpartition(', "sha256": "')
    demand(hashlib.sha256(body.encode()).hexdigest() == seal.split('"')[0], f"{what}: the digest is another")
    return document


shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
short = ["--max-periods", 300]
forced = ["--mass-ratio", 0.1, "--damping-ratio", 0.01, "--force-amplitude", 0.05, "--x0", 1]
sweeps = {
    "exact": [*forced, "--vary", "force_frequency=0.9:1.1:5", "--start=-0.5:0:0.5:0.1", *short],
    "restitution": [*forced, "--engine", "restitution", "--vary", "force-amplitude=0.02:0.06:3", *short],
    "undamped": ["--force-amplitude", 0.004, "--vary", "force_frequency=0.9:1:2", *short],  # infinite at 1
    "budget": [*forced, "--vary", "force_frequency=0.9:1.1:3", "--max-impacts", 2],
    "units": ["--scene", source / "data/examples/mast_in_wind.json", "--vary", "exciting_frequency=3.05:3.25:3", *short],
}
for name, words in sweeps.items():
    document = examined(respond(f"{name}.json", "sweep", *words), name)
    ways = [(n, way, each[way]) for n, each in enumerate(document["sweeps"]) for way in ("up", "down")]
    count = document["axis"]["count"]
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
        for column, mass in (("empty_amplitude", 1), ("locked_amplitude", 1 + scene["mass_ratio"])):
            h = abs(complex(1 - mass * scene["force_frequency"] ** 2, 2 * scene["damping_ratio"] * scene["force_frequency"]))
            given = document[column][i]
            demand(given is None if h == 0 else math.isclose(given, abs(scene["force_amplitude"]) / h, rel_tol=1e-12),
                   f"{name}: {column} is {given} at {value}")

# Impacts on either wall, counted in a run from the state that is told on.
checked = 0
for name in ("exact", "restitution"):
    document = json.loads((folder / f"{name}.json").read_text())
    for way in (each[way] for each in document["sweeps"] for way in ("up", "down")):
        for i, end in enumerate(way["end"]):
            if end != "periodic" or way["impacts_left"][i] + way["impacts_right"][i] == 0:
                continue
            scene = {**document["scene"], document["axis"]["number"]: document["values"][i]}
            scene.update(x0=way["x"][i], v0=way["v"][i], y0=way["y"][i], w0=way["w"][i],
                         until_time=2 * math.pi / scene["force_frequency"] * way["period"][i])
            (folder / "scene.json").write_text(json.dumps(scene))
            subprocess.run([str(program), "run", "--scene", "scene.json", "--engine", name, "--record", "impacts", "-o",
                            "run.json"], cwd=folder, check=True)
            walls = json.loads((folder / "run.json").read_text())["impacts"]["wall"]
            demand([walls.count(0), walls.count(1)] == [way["impacts_left"][i], way["impacts_right"][i]],
                   f"{name}: impacts at {document['values'][i]} are not {walls}")
            checked += way["impacts_left"][i] != way["impacts_right"][i]
demand(checked > 0, "no motion strikes one wall more often than the other")

budget = json.loads((folder / "budget.json").read_text())
demand("impact_budget" in budget["sweeps"][0]["up"]["end"] and None in budget["sweeps"][0]["up"]["amplitude"], "budget: none")

# In SI: the same rows in other units.
units = json.loads((folder / "units.json").read_text())
length, time, force = (units["units"][key] for key in ("length_m", "time_s", "force_N"))
demand([round(v / time / 2 / math.pi, 9) for v in units["values"]] == [3.05, 3.15, 3.25], f"units: {units['values']}")
plain = list(csv.DictReader((folder / "units.csv").read_text().splitlines()))
text = respond("si.csv", "sweep", *sweeps["units"], "--format", "csv", "--si")
SI = {"force_frequency_Hz": ("force_frequency", 1 / (2 * math.pi * time)), "amplitude_m": ("amplitude", length),
      "v_m_per_s": ("v", length / time), "power_W": ("power", units["units"]["energy_J"] / time), "lag_deg": ("lag_deg", 1)}
for row, own in zip(csv.DictReader(text.splitlines()), plain):
    for column, (name, scale) in SI.items():
        demand(math.isclose(float(row[column]), float(own[name]) * scale, rel_tol=1e-12), f"si.csv: {column} is {row[column]}")

basins = {
    "initial": [*forced, "--force-frequency", 0.9, "--vary", "x0=-1:1:9", "--vary", "v0=-1:1:7", "--engine", "restitution"],
    "parameters": [*forced, "--vary", "force_frequency=0.8:1.2:5", "--vary", "mass_ratio=0.05:0.1:3", *short],
    "starts": ["--scene", source / "data/examples/mast_in_wind.json", "--vary", "initial_displacement=-20:20:3",
               "--vary", "exciting_force=1:2:2", *short],
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
        demand((int(row[2]) if row[2] else -1) == attractor[n], f"{name}.csv: {row}")
    demand(len(rows) == len(attractor), f"{name}.csv: {len(rows)} rows")
starts = json.loads((folder / "starts.json").read_text())
demand([axis["from"] for axis in starts["axes"]] == [-2, 1 / 160], f"starts: {starts['axes']}")

# Interrupted: one line that says what is left, and no file, also none half written.
process = subprocess.Popen([str(program), "response", "basin", *map(str, forced), "--vary", "x0=-1:1:2000", "--vary",
                            "v0=-1:1:2000", "-o", "long.json"], cwd=folder, stderr=subprocess.PIPE, text=True)
while "response: " not in process.stderr.readline():  # its progress, after two seconds
    demand(process.poll() is None, "interrupted: it has ended by itself")
    if faults:
        break
process.send_signal(signal.SIGINT)
said = process.communicate()[1].splitlines()[-1]
demand(process.returncode == 130, f"interrupted: exit code {process.returncode}")
demand(said == "impact-damper: interrupted: long.json is not written", f"interrupted: {said}")
demand(not list(folder.glob("*long*")), "interrupted: a file is left")

print("\n".join(faults + [f"{len(faults)} faults"]))
sys.exit(1 if faults else 0)
