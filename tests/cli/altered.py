"""`check` and `verify` find a run that was altered, and `verify` and `series` one of another scene or engine.

Each alteration is tried twice: as it is, which the digest tells, and with the digest made anew, which only what follows from
the rest of the run can tell (all of that: ../consistency.cpp), or the scene of its name, or nothing.
"""
import json
import re
import shutil

import trial
from trial import demand, finish, folder, read, sealed, source, write

SCENE = "nu2-e06"
scenes = source / "data" / "scenes"


def call(code, *words, says=""):
    said = trial.call(*words, code=code)
    if code:
        demand(says in said, f"{words}: does not say \"{says}\": {said}")
        demand(re.fullmatch(r"([^\n]+\n)+", said), f"{words}: not one line for each problem: {said}")


def scaled(column, row):
    """Element `row` of a column, 1 % larger."""
    return rf'("{column}": \[(?:[^,]*,){{{row}}})([^,]*)', lambda found: f"{found[1]}{float(found[2]) * 1.01!r}"


# What, its text, by what it is replaced, whether it contradicts the rest of the run or the scene.
ALTERATIONS = [
    ("an amplitude later on", *scaled("amplitude", 100), True),
    ("an impact's speed", *scaled("relative_velocity", 50), False),
    ("stop reason", r'"stop_reason": "\w*"', '"stop_reason": "half_cycle_budget"', True),
    ("calibration", '"fixed-wall"', '"two-body"', False),
    ("wall stiffness", '"wall_stiffness": 10000', '"wall_stiffness": 20000', True),
    ("restitution", '"restitution": 0.6', '"restitution": 0.61', True),
    ("x0", '"x0": 6,', '"x0": 6.5,', True),
    ("version", r'"version": "[^"]*"', '"version": "9.9.9"', False),
]

(folder / "runs").mkdir()
run = f"runs/{SCENE}.json"
record = ["--record", "half_cycles,impacts,contacts"]


def simulate(scene, *options):
    call(0, "run", "--scene", scenes / f"{scene}.json", *record, *options, "-o", f"runs/{scene}.json")


simulate(SCENE)
simulate("nu1-e06")
claims = json.loads((source / "data" / "claims.json").read_text())
claim = next(claim for claim in claims["claims"] if claim["measure"].get("scenes") == [SCENE])
other = {**claim, "id": "other", "measure": {**claim["measure"], "scenes": ["nu1-e06"]}}
write("claims.json", {**claims, "claims": [claim]})
check = ["check", "run", run, "--scenes", scenes]
verify = ["verify", "--claims", "claims.json", "--runs", "runs", "--scenes", scenes, "--members", "1"]
series = ["series", "--catalogue", source / "figures" / "catalogue.json", "--runs", "runs", "--scenes", scenes,
          "--figure", "15"]
text = read(run)
call(0, *check)
call(0, *verify)
call(0, *series)
for what, pattern, replacement, follows in ALTERATIONS:
    altered = re.sub(pattern, replacement, text, count=1)
    assert altered != text, what
    write(run, altered)
    for command in (check, verify, series):
        call(3, *command, says=f"{SCENE}.json: /provenance/sha256: must be the digest of the content")
    write(run, sealed(altered))
    for command in (check, verify, series):
        call(3 if follows else 0, *command, says=f"{SCENE}.json: /" if follows else "")

# A further run, of the scene with another wall.
write(run, text)
soft = f"{SCENE}.soft"
entry = {"name": soft, "scene": SCENE, "set": {"wall_stiffness": 1000}, "record": ["half_cycles"]}
write("catalogue.json", {"schema": "impact-damper/catalogue/1", "scenes": [{"scene": SCENE, "record": ["half_cycles"]}],
                         "runs": [entry], "figures": []})
write("claims.json", {**claims, "claims": [{**claim, "measure": {**claim["measure"], "scenes": [soft]}}]})
further = [*verify, "--catalogue", "catalogue.json"]
call(5, *further, says=f"runs/{soft}.json: cannot be read: No such file or directory; made by: impact-damper run --scene ")
shutil.copy(folder / run, folder / "runs" / f"{soft}.json")
call(3, *further, says=f"{soft}.json: /scene/wall_stiffness: must be 1000 as in run {soft} of the catalogue, got 10000")
call(0, "run", "--scene", scenes / f"{SCENE}.json", "--wall-stiffness", "1000", *record, "-o", f"runs/{soft}.json")
call(0, *further)
write("claims.json", {**claims, "claims": [claim]})

# A run of another scene, under this one's name.
shutil.copy(folder / "runs/nu1-e06.json", folder / run)
for command in (check, verify, series):
    call(3, *command, says=f"{SCENE}.json: /scene/mass_ratio: must be 0.02 as in {scenes}/{SCENE}.json, got 0.01: "
                           "a run of another scene")

# One run of another engine, or of another wall, among the others: each is right by itself.
write("claims.json", {**claims, "claims": [claim, other]})
for options in (["--engine", "cem"], ["--calibration", "two-body"], ["--max-impacts", "100000"]):
    simulate(SCENE, *options)
    call(0, *check)
    call(3, *verify, says="/engine: must be that of runs/nu1-e06.json, exact, with its options, got ")
    call(3, *series[:-1], "8", says="runs of several engines are not put together")

finish()
