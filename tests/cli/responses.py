"""What `response` writes is what data/schema/response.schema.json says, ends with its digest, and its CSV holds the same numbers.

    responses.py PROGRAM SOURCE FOLDER        FOLDER, made anew, is for the files
"""
import csv
import json
import math
import signal
import subprocess

from trial import demand, finish, faults, folder, has_its_digest, program, read, read_json, source, validator, write

schema = validator("response")


def respond(file, *words):
    done = subprocess.run([str(program), "response", *map(str, words), "-o", file], cwd=folder, capture_output=True, text=True)
    demand(done.returncode == 0, f"{words}: exit code {done.returncode}: {done.stderr}")
    return read(file)


def examined(text, what):
    """The document, which must obey the schema and end with the digest of what is before."""
    document = json.loads(text)
    for error in schema.iter_errors(document):
        faults.append(f"{what}: {list(error.absolute_path)}: {error.message[:200]}")
    demand(has_its_digest(text), f"{what}: the digest is another")
    return document


short = ["--max-periods", 300]
forced = ["--mass-ratio", 0.1, "--damping-ratio", 0.01, "--force-amplitude", 0.05, "--x0", 1]
sweeps = {
    "exact": [*forced, "--vary", "force_frequency=0.9:1.1:5", "--start=-0.5:0:0.5:0.1", *short],
    "restitution": [*forced, "--engine", "restitution", "--vary", "force-amplitude=0.02:0.06:3", *short],
    "undamped": ["--force-amplitude", 0.004, "--vary", "force_frequency=0.9:1:2", *short],  # infinite at 1
    "budget": [*forced, "--vary", "force_frequency=0.9:1.1:3", "--max-impacts", 2],
    "several": ["--scene", "boxes.json", "--vary", "force_frequency=0.95:1.05:3", "--start=-0.5:0.2", *short],
    "units": ["--scene", source / "data/examples/mast_in_wind.json", "--vary", "exciting_frequency=3.05:3.25:3", *short],
}
(folder / "boxes.json").write_text(json.dumps({"damping_ratio": 0.01, "force_amplitude": 0.05, "x0": 1, "until_time": 1, "dampers": [
    {"mass_ratio": 0.05, "y0": 0.5}, {"mass_ratio": 0.03, "clearance": 2, "y0": 0.3}]}))
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

# Impacts on either wall, counted in a run from the state that is told on.
checked = 0
for name in ("exact", "restitution"):
    document = read_json(f"{name}.json")
    for way in (each[way] for each in document["sweeps"] for way in ("up", "down")):
        for i, end in enumerate(way["end"]):
            if end != "periodic" or way["impacts_left"][i] + way["impacts_right"][i] == 0:
                continue
            scene = {**document["scene"], document["axis"]["number"]: document["values"][i]}
            scene.update(x0=way["x"][i], v0=way["v"][i], y0=way["y"][i], w0=way["w"][i],
                         until_time=2 * math.pi / scene["force_frequency"] * way["period"][i])
            write("scene.json", scene)
            subprocess.run([str(program), "run", "--scene", "scene.json", "--engine", name, "--record", "impacts", "-o",
                            "run.json"], cwd=folder, check=True)
            walls = read_json("run.json")["impacts"]["wall"]
            demand([walls.count(0), walls.count(1)] == [way["impacts_left"][i], way["impacts_right"][i]],
                   f"{name}: impacts at {document['values'][i]} are not {walls}")
            checked += way["impacts_left"][i] != way["impacts_right"][i]
demand(checked > 0, "no motion strikes one wall more often than the other")

budget = read_json("budget.json")
demand("impact_budget" in budget["sweeps"][0]["up"]["end"] and None in budget["sweeps"][0]["up"]["amplitude"], "budget: none")

# In SI: the same rows in other units.
units = read_json("units.json")
length, time, force = (units["units"][key] for key in ("length_m", "time_s", "force_N"))
demand([round(v / time / 2 / math.pi, 9) for v in units["values"]] == [3.05, 3.15, 3.25], f"units: {units['values']}")
plain = list(csv.DictReader(read("units.csv").splitlines()))
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
    "mast": ["--scene", source / "data/examples/mast_in_wind.json", "--vary", "exciting_frequency=3.09:3.0", "--start=0:0:5:0"],
    "chaotic": [*forced, "--force-frequency", 0.9, "--vary", "force_amplitude=0.05:0.06", "--max-periods", 20],
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
demand([start["branch"] for start in found["chaotic"]["starts"]] == [None] and not found["chaotic"]["branches"], "chaotic: a branch")
demand([start["end"] for start in found["mast"]["starts"]] == ["periodic"] * 2, "mast: a start")


def event_of(name, kind, branch=0):
    """It, and the point before it."""
    all_of_it = found[name]["branches"][branch]
    event = next(each for each in all_of_it["events"] if each["kind"] == kind)
    at = event["points_before"] - 1
    return event["value"], {key: column[at] for key, column in all_of_it.items() if isinstance(column, list) and key != "events"}


def swept(words, number, low, high, point):
    """What sweep finds at two values, beginning at the lower one in the state of a point."""
    start = ":".join(str(point[key]) for key in "xvyw")
    up = json.loads(respond("swept.json", "sweep", *words, "--vary", f"{number}={low!r}:{high!r}:2", f"--start={start}",
                            "--max-periods", 50000))["sweeps"][1]["up"]
    return [{key: column[i] for key, column in up.items()} for i in (0, 1)]


def is_same(point, steady):
    keys = ("period", "impacts_left", "impacts_right", "symmetric")
    return [point[key] for key in keys] == [steady[key] for key in keys]


# Two symmetric impacts in a period, in closed form (M13.16 to M13.18): the states at phase 0.
def two_impact_states(scene):
    nu, zeta, e, omega = (scene[key] for key in ("mass_ratio", "damping_ratio", "restitution", "force_frequency"))
    root = math.sqrt(1 - zeta * zeta)

    def propagator(t):
        decay, sin, cos = math.exp(-zeta * t), math.sin(root * t), math.cos(root * t)
        return decay * (cos + zeta / root * sin), decay * sin / root, decay * (cos - zeta / root * sin)

    half = math.pi / omega
    c, s, s1 = propagator(half)
    delta, b = 1 + c + s1 + math.exp(-2 * zeta * half), (1 - e) / (1 + e)
    a, q = half + 4 * nu * s / delta, (b - nu * (1 - b) + 2 * nu * (1 + c) / delta) / omega
    amplitude = scene["force_amplitude"] / abs(complex(1 - omega * omega, 2 * zeta * omega))
    lag = math.atan2(2 * zeta * omega, 1 - omega * omega)
    for sign in (1, -1):
        inside = a * a - (a * a + 4 * q * q) * (1 - 4 * amplitude * amplitude)
        v = (a + sign * math.sqrt(max(inside, 0))) / (a * a + 4 * q * q)
        phase = lag + math.atan2((1 - a * v) / 2, q * v)  # of the force where the left wall is left
        u, u1 = 2 * nu * v * s / delta, -2 * nu * v * (1 + c) / delta

        def motion(t):
            c, s, s1 = propagator(t)
            return (amplitude * math.sin(omega * t + phase - lag) + u * c + u1 * s,
                    amplitude * omega * math.cos(omega * t + phase - lag) - u * s + u1 * s1)

        t = -phase / omega % (2 * half)
        x, v_x = motion(t % half)
        state = (x, v_x, motion(0)[0] - x + v * (t % half), v - v_x)
        yield state if t < half else (-state[0], -state[1], 1 - state[2], -state[3])


compared = 0
folds = found["folds"]["branches"][0]
for i, value in enumerate(folds["values"]):
    # The multipliers of a period are the squares of those of half a period; near the fold, where one is 1, both motions
    # are known to half of the digits.
    near_fold = min(math.hypot(1 - folds[f"multiplier_{n}_re"][i], folds[f"multiplier_{n}_im"][i]) for n in (1, 2, 3, 4)) < 0.02
    states = two_impact_states({**found["folds"]["scene"], "force_frequency": value})
    gap = min(max(abs(a - folds[key][i]) for a, key in zip(state, "xvyw")) for state in states)
    demand(gap < (1e-8 if near_fold else 1e-11), f"folds: {gap} from the closed form at {value}")
    compared += not near_fold
demand(compared > 50, f"folds: {compared} points are compared with the closed form")
demand(0 in folds["stable"] and 1 in folds["stable"], "folds: no point is stable, or all are")

# A sweep on both sides of an event.
value, point = event_of("folds", "fold")
before, beyond = swept(two_impacts, "force_frequency", value - 1e-4, value + 1e-4, point)
demand(is_same(point, before) and not is_same(point, beyond), f"folds: a sweep sees {before} and {beyond} at {value}")
value, point = event_of("flips", "symmetry_breaking")
before, beyond = swept(doubling, "force_amplitude", value * 0.999, value * 1.001, point)
demand(is_same(point, before) and (beyond["period"], beyond["symmetric"]) == (1, 0), f"flips: no symmetry breaking at {value}")
value, point = event_of("flips", "flip", 1)
before, beyond = swept(doubling, "force_amplitude", value * 0.999, value * 1.001, point)
demand(is_same(point, before) and beyond["period"] == 2, f"flips: no flip at {value}: {before}, {beyond}")
value, point = event_of("flips", "grazing", 2)  # of the stable motion of twice the period
before, beyond = swept(doubling, "force_amplitude", value - 1e-7, value + 1e-7, point)
demand(is_same(point, before) and not is_same(point, beyond), f"flips: no grazing at {value}: {before}, {beyond}")

# And at a point where one wall is struck more often than the other.
stable = next({key: column[0] for key, column in each.items() if isinstance(column, list) and key != "events"}
              for each in found["flips"]["branches"] if each["impacts_left"][0] != each["impacts_right"][0] and each["stable"][0])
there, _ = swept(doubling, "force_amplitude", stable["values"], stable["values"] * 1.0001, stable)
demand(is_same(stable, there), f"flips: a sweep finds {there} at {stable}")
demand(math.isclose(stable["amplitude"], there["amplitude"], rel_tol=1e-8), f"flips: amplitude {stable['amplitude']}")

# Lyapunov exponents: on a stable orbit the logarithms of the multipliers, divided by the period.
orbit = found["flips"]["branches"][0]
on_orbit = [*doubling, "--force-amplitude", repr(orbit["values"][0])]
for option, key in (("--x0", "x"), ("--v0", "v"), ("--y0", "y"), ("--w0", "w")):
    on_orbit.append(f"{option}={orbit[key][0]!r}")
document = examined(respond("exponents.json", "lyapunov", *on_orbit, "--periods", 400, "--discard", 300), "exponents")
period = 2 * math.pi / 0.9
moduli = [math.hypot(orbit[f"multiplier_{n}_re"][0], orbit[f"multiplier_{n}_im"][0]) for n in (1, 2, 3, 4)]
alone = [orbit[f"multiplier_{n}_im"][0] == 0 for n in (1, 2, 3, 4)]
for exponent, error, modulus, is_real in zip(document["exponents"], document["standard_errors"], moduli, alone):
    expected = math.log(modulus) / period
    # Of a conjugate pair each period's stretch varies as the pair turns.
    demand(math.isclose(exponent, expected, rel_tol=1e-9 if is_real else 0.03), f"exponents: {exponent}, not {expected}")
    demand(error < (1e-12 if is_real else 0.01), f"exponents: a standard error of {error}")
impacts = orbit["impacts_left"][0] + orbit["impacts_right"][0]
expected = -2 * 0.02 + 2 * impacts * math.log(document["scene"]["restitution"]) / period
demand(math.isclose(sum(document["exponents"]), expected, rel_tol=1e-9), f"exponents: their sum is not {expected}")
plain = list(csv.DictReader(respond("exponents.csv", "lyapunov", *on_orbit, "--periods", 400, "--discard", 300, "--format",
                                    "csv").splitlines()))
demand([[float(row[key]) for row in plain] for key in ("exponent", "standard_error")] ==
       [document["exponents"], document["standard_errors"]], "exponents.csv: other numbers")
document = examined(respond("several_orbits.json", "orbits", "--scene", "boxes.json", "--vary", "force_frequency=1:1.01",
                            "--max-points", 4, "--max-branches", 1), "orbits of several dampers")
demand(len(document["branches"][0]["dampers"]) == 2 and len(document["branches"][0]["values"]) > 1,
       f"orbits of several dampers: {document['branches']}")

# Of several dampers each impact contracts by its own restitution.
boxes = ["--scene", "boxes.json", "--engine", "restitution", "--force-frequency", 0.95]
document = examined(respond("several.json", "lyapunov", *boxes, "--periods", 10, "--discard", 0), "exponents of several dampers")
demand(len(document["exponents"]) == 6, f"exponents of several dampers: {document['exponents']}")
duration = 10 * 2 * math.pi / 0.95
scene = {**read_json("boxes.json"), "force_frequency": 0.95, "until_time": duration}
write("ten_periods.json", scene)
done = subprocess.run([str(program), "run", "--scene", "ten_periods.json", "--engine", "restitution", "--record", "impacts"],
                      cwd=folder, capture_output=True, text=True)
impacts = len(json.loads(done.stdout)["impacts"]["time"])
expected = -2 * 0.01 + 2 * impacts * math.log(0.6) / duration
demand(impacts > 20 and math.isclose(sum(document["exponents"]), expected, rel_tol=1e-9),
       f"exponents of several dampers: {impacts} impacts, sum {sum(document['exponents'])}, not {expected}")
ended = examined(respond("ended.json", "lyapunov", *forced, "--force-frequency", 0.9, "--max-impacts", 1), "ended")
demand((ended["stop_reason"], ended["exponents"], ended["standard_errors"]) == ("impact_budget", [], []), "ended: exponents")

# In SI.
mast = ["--scene", source / "data/examples/mast_in_wind.json"]
units = found["mast"]["units"]
length, time = units["length_m"], units["time_s"]
plain = list(csv.DictReader(read("mast.csv").splitlines()))
text = respond("mast_si.csv", "orbits", *branches["mast"], "--format", "csv", "--si")
SI = {"force_frequency_Hz": ("force_frequency", 1 / (2 * math.pi * time)), "amplitude_m": ("amplitude", length),
      "slowest_impact_m_per_s": ("slowest_impact", length / time), "nearest_miss_m": ("nearest_miss", length),
      "y_m": ("y", length), "w_m_per_s": ("w", length / time), "multiplier_1_re": ("multiplier_1_re", 1)}
for row, own in zip(csv.DictReader(text.splitlines()), plain):
    for column, (name, scale) in SI.items():
        demand((row[column] == "") == (own[name] == "") and
               (not row[column] or math.isclose(float(row[column]), float(own[name]) * scale, rel_tol=1e-12)),
               f"mast_si.csv: {column} is {row[column]}")
plain, in_si = (list(csv.DictReader(respond(f"{name}.csv", "lyapunov", *mast, "--periods", 50, "--format", "csv", *more).splitlines()))
                for name, more in (("rates", []), ("rates_si", ["--si"])))
for row, own in zip(in_si, plain):
    for column in ("exponent", "standard_error"):
        demand(math.isclose(float(row[f"{column}_per_s"]), float(own[column]) / time, rel_tol=1e-12), f"rates_si.csv: {row}")


# All of them are valid to `check`, whose complaint about an altered one names it and the place.
def check(*words):
    return subprocess.run([str(program), "check", "response", *words], cwd=folder, capture_output=True, text=True)


files = sorted(file.name for file in folder.glob("*.json") if '"impact-damper/response/1"' in file.read_text())
demand(len(files) > 15, f"check: only {files}")
done = check(*files)
demand((done.returncode, done.stderr) == (0, "") and done.stdout == "".join(f"{name}: valid\n" for name in files), f"check: {done}")
text = read("exact.json")
altered = text.replace('"mass_ratio": 0.1', '"mass_ratio": 0.11', 1)
write("altered.json", altered)
done = check("altered.json")
demand(done.returncode == 3 and "altered.json: /locked_amplitude/0: must be " in done.stderr, f"check: {done}")
altered = text.replace('"end": ["periodic"', '"end": ["step_budget"', 1) if '"end": ["periodic"' in text else \
    text.replace('"end": ["not_periodic"', '"end": ["step_budget"', 1)
write("altered.json", altered)
done = check("altered.json")
demand(done.returncode == 3 and "must be null, got " in done.stderr, f"check: {done}")

# Tables and verdicts use a response only if it is the catalogue's.
scenes = source / "data/scenes"
(folder / "runs").mkdir()
(folder / "catalogue.json").write_text(json.dumps({
    "schema": "impact-damper/catalogue/1", "scenes": [{"scene": "nu2-e06", "record": ["half_cycles"]}],
    "responses": [{"name": "low", "scene": "nu2-e06", "set": {"x0": 0, "force_amplitude": 0.008}, "kind": "sweep",
                   "rule": {"max_periods": 100, "mean_periods": 10, "nudge": 1e-6},
                   "vary": [{"number": "force_frequency", "from": 0.95, "to": 1.01, "count": 3}],
                   "start": [{"x": 2, "v": 0, "y": 0, "w": 0}]}],
    "figures": [{"figure": "1", "title": "t", "table": "response", "responses": ["low"], "script": "fig01.gp"}]}))


def series(code, says):
    done = subprocess.run([str(program), "series", "--catalogue", "catalogue.json", "--runs", "runs", "--scenes", str(scenes)],
                          cwd=folder, capture_output=True, text=True)
    demand(done.returncode == code and says in done.stderr + done.stdout, f"series: not {says}: {done}")


asked = ["--scene", scenes / "nu2-e06.json", "--quiet", "--x0", 0, "--force-amplitude", 0.008, "--max-periods", 100, "--mean-periods", 10]
varied = ["--vary", "force_frequency=0.95:1.01:3", "--start=2:0:0:0", "--nudge=1e-6"]
series(5, "figure 1: runs/low.json: cannot be read: No such file or directory; made by: impact-damper response sweep --scene ")
respond("runs/low.json", "sweep", *asked, *varied)
series(0, "# empty-1")
for words, says in ((["--restitution", 0.7], "/scene/restitution: must be 0.6 as in response low of the catalogue, got 0.7"),
                    (["--engine", "restitution"], "/engine: must be "), (["--tolerance", 1e-6], "/rule: must be "),
                    (["--start=1:0:0:0"], "/sweeps/2/start: must be none as in response low of the catalogue, got ")):
    respond("runs/low.json", "sweep", *asked, *varied, *words)
    series(3, f"figure 1: runs/low.json: {says}")
respond("runs/low.json", "sweep", *asked, *varied[:-1], "--nudge=2e-6")
series(3, "/sweeps/1/nudge: must be 1e-06 as in response low of the catalogue, got 2e-06")
respond("runs/low.json", "sweep", *asked, "--vary", "force_frequency=0.95:1.02:3", *varied[2:])
series(3, "/axis: must be ")
respond("runs/low.json", "orbits", *asked[:-2], "--vary", "force_frequency=0.95:1.01")
series(3, "/kind: must be sweep as in response low of the catalogue, got orbits")

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

finish()
