"""The schemas of data/schema/ and the program allow the same files, except for what no schema can express: the
files of this folder, the project's own, a fresh run of each engine, and whatever becomes of the allowed ones of this folder
if one value after the other is changed, left out or doubled.

    agree.py PROGRAM FOLDER [NTH]      about every NTH changed file is tried, drawn with a fixed seed

The schemas take nearly all the time, in Python; so a document is kept small, and all processors have their share.
"""
import json
import math
import multiprocessing
import os
import random
import re
import shutil
import sys

import trial
from packed_files import unpack
from trial import call, demand, faults, finish, folder, run, source, validator

nth = int(trial.words[0]) if trial.words else 1
KINDS = ("scene", "run", "plan", "catalogue", "claims", "manifest")

# Why a schema cannot reject a file, and what the program says of such, as regular expressions.
BEYOND_SCHEMAS = {
    "It sees objects, in which each key stands once.": ["duplicate key,"],
    "It sees no bytes.": [r"too long, allowed are \d+ bytes", "must be the digest of the content"],
    "It counts only within one array or object.": [r"too many objects, arrays, keys and texts, allowed are \d+$"],
    "To it 3.0 is the integer 3.": ["written without point or exponent"],
    "It compares no numbers.": ["contradicts the rest of the run"],
    "It compares no lengths.": [
        "must be as long as the section's first column", "must hold a loss for each of the",
        r"/(half_cycles|energy|history)/dampers: must be as many as in the scene, \d+, got"],
    "It compares no elements.": [
        "must rise from pair to pair", r"must (begin with|have) the pair \[0, 0\]",
        "must not be below the one before it", "must not be before its begin", "must be below that of the window before",
        "must be two different numbers", "must name each number once",
        r"must be \[least, most\].* got \[-?[0-9.e+-]+, -?[0-9.e+-]+\]$",
        r"must be two amplitudes, the lower first, got \S+ and", "/digits: must ascend"],
    "It compares no values.": [
        'must differ from "from"', "must be > from,", "must be > 0 for a logarithmic scale", 'must be above "from"'],
    "It multiplies nothing.": [r"must give at most \d+ points", r"must make at most \d+ runs in all"],
    "A range that depends on another part of the file.": [
        r"/(grid|samples/numbers)/\d+/(from|to|values/\d+): must be a number .*, got -?\d",
        r"/wall/speed: must be >= ", r"/spring/cubic: must be >= 0 and <= 1e\+12, got \d", r"/spring/cubic: must be 0 or of .*, got \d",
        "must have lengths up to", r"must have speeds that rise, from 0 to 1e\+12, got \[(\d|-0\.0)",
        r"/restitution: must be >= 0\.001 beside a wall with a law of its own, got",
        "with the restitution engine, whose walls are rigid, got", ", its clearance, as walls are rigid, got",
        r"/damper/\d+: must be a whole number >= 1 and <= \d+, got ([1-9]\d{0,2}|1000)(\.0)?$"],
    "One of two lists must not be empty.": ["/grid: a number that varies must be given"],
    "It does not know what stands elsewhere in the file.": [
        "/frequencies: missing, the range must be given",
        "must be exact or restitution for quantities of motions under a force", "must be a response of this catalogue",
        'must be (a sweep|a basin) .*, got "', "must come after a sweep with its force"],
    "It reads no braces and does not know what stands elsewhere in the file.": [
        "/(words|explanation|evidence): (must name|must have|must show|has a)"],
    "It does not add.": ["must be the sum of its parts"],
    "It multiplies no numbers.": ["with the mass must make a stiffness", r"/units/\w+: must be (length_m|mass_kg|energy_J) (divided by|times)"],
    "A limit that is computed.": [r"/engine/(time_step|large_step): must be (<= |> \S+, the time step)"],
    "It holds elements apart only as a whole.": ["must be given once(, got| among)", "must differ from the scripts before it"],
    "What is named elsewhere in the file.": [
        "must draw (a scene|runs) of this catalogue", "must be a scene of this catalogue",
        "in the (scene's record, which|record of run)", "must be the amplitude of a history window"],
    "It divides no masses, lengths or times.": [r": made dimensionless, as [][.a-z0-9_]+, must be (?!2 to \d+ pairs)"],
    "It takes no values from elsewhere in the file.": ['/stamp: must be "[0-9a-f]{8}'],
}
VALIDATORS = {kind: validator(kind) for kind in KINDS}


def reject_constant(word):
    raise ValueError(word)


def schema_allows(kind, file):
    try:
        value = json.loads(file.read_bytes().decode("utf-8-sig"), parse_constant=reject_constant)
        json.dumps(value, ensure_ascii=False).encode()  # half a surrogate is no character
    except (ValueError, RecursionError):
        return False
    return VALIDATORS[kind].is_valid(value)


def complaints(kind, files):
    """What the program says of each file, a thousand in one call: the system bounds the length of a command."""
    said = {str(file): [] for file in files}
    names = list(said)
    for first in range(0, len(names), 1000):
        done = run(trial.program, "check", kind, *names[first : first + 1000], code=None)
        demand(done.returncode in (0, 3), f"check {kind}: exit code {done.returncode}: {done.stderr}")
        for line in done.stderr.splitlines():
            if ": warning: " in line:
                continue
            if re.search(r": and \d+ more problems$", line):  # like those before it
                continue
            said[line.split(": ", 1)[0]].append(line)
    return said


def places(value, path=()):
    """The path to each part of a document, the document itself first; of columns only to the first and last numbers."""
    yield path
    items = list(value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ())
    is_column = isinstance(value, list) and not any(isinstance(part, (dict, str)) for part in value)
    for key, part in items[:1] + items[-1:] if is_column and len(items) > 1 else items:
        yield from places(part, path + (key,))


def neighbours(bound):
    return [bound, math.nextafter(bound, -math.inf), math.nextafter(bound, math.inf)]


# Around every limit that a schema states, and what is a number like no other.
BOUNDS = [0.0, 1e-15, 1e-3, 0.5, 1.0, 2.0, -10.0, 10.0, 18.0, 180.0, 1e3, 1e4, 1e6, -1e12, 1e12, -1e15, 1e15]
NUMBERS = [near for bound in BOUNDS for near in neighbours(bound)] + [
    0, -0.0, 1, -1, 2, 3, 8, 9, 17, 19, 1001, 10**6, 10**6 + 1, 2**63 - 1, 2**63, 2**64, 1.5, 1e300, sys.float_info.max]
TEXTS = ["", "a", ".a", "a/b", "a b", "a\n", "a\u0000", "\u007f", "\u00e9", "a" * 8, "a" * 9, "a" * 64, "a" * 65, "\u03bd" * 4000,
         "\u03bd" * 4001, "exact", "cem", "time", "motion", "drawing", "history", "corrected", "reproduced", "step_limit"]
OTHERS = [None, True, [], {}, [0], "1", 1]


def replaced(value, path, *new):
    """The document with another part at this path, or with none. What does not change is shared, not copied."""
    if not path:
        return new[0]
    changed = value.copy()
    if len(path) == 1 and not new:
        del changed[path[0]]
    else:
        changed[path[0]] = replaced(value[path[0]], path[1:], *new)
    return changed


def changes(value, paths):
    """Documents that differ from this one at one of these paths."""
    for path in paths:
        here = value
        for key in path:
            here = here[key]
        if isinstance(here, (bool, int, float)) or here is None:
            others = NUMBERS
        elif isinstance(here, str):
            others = TEXTS
        elif isinstance(here, list):
            others = [here + here[:1], here[:1], here[::-1], here + here[-1:], here + ["x"], here * 120]
        else:
            others = [{**here, "surplus": 1}]
        for other in OTHERS + others:
            yield replaced(value, path, other)
        if path:
            yield replaced(value, path)


def documents(file):
    """The changes of a file. Of several claims each stands alone, or a schema would go through all for each change."""
    document = json.loads(file.read_bytes().decode("utf-8-sig"))
    if file.parent.name != "claims" or len(document["claims"]) < 2:
        yield from changes(document, places(document))
        return
    yield from changes(document, [(), ("schema",), ("claims",)])
    known = set()
    for claim in document["claims"]:
        alone = {**document, "claims": [claim]}
        paths = [path for path in places(alone) if path[:2] == ("claims", 0)]
        if file.stem == "every_measure":
            # Each number of a measure in the first measure that has it: one name means the same in all.
            measure = ("claims", 0, "measure")
            paths = [measure] + [measure + (key,) for key in claim["measure"] if key not in known]
            known |= set(claim["measure"]) - {"scenes"}
        yield from changes(alone, paths)


def main():
    (folder / "fresh").mkdir()
    corpus = {}  # of each file what the program says of it; of an allowed one nothing
    for kind in KINDS:
        notes = unpack(source / f"tests/corpus/{kind}.packed", folder / "corpus" / kind)
        corpus |= {folder / "corpus" / kind / name: note for name, note in notes.items()}
    files = {kind: [file for file in corpus if file.parent.name == kind] for kind in KINDS}

    scenes = [*(source / "data/scenes").glob("*.json"),
              *(file for file in (source / "data/examples").glob("*.json") if "schema" not in json.loads(file.read_text()))]
    own = {"scene": sorted(scenes),
           "run": [], "plan": [source / "data/examples/mast_plan.json"], "catalogue": [source / "figures/catalogue.json"], "claims": [source / "data/claims.json"],
           "manifest": [file for file in [source / "data/reference/manifest.json"] if file.exists()]}
    for engine in ("exact", "restitution", "cem"):
        fresh = folder / "fresh" / f"{engine}.json"
        call("run", "--until-time", "20", "--engine", engine, "--force-amplitude", "0.1", "--record",
             "half_cycles,impacts,contacts,energy,history", "--history", "0:20:11", "-o", fresh)
        own["run"].append(fresh)
    several = folder / "fresh" / "several.json"
    call("run", "--scene", folder / "corpus/scene/dampers_every_key.json", "--engine", "restitution", "--record",
         "half_cycles,impacts,contacts,energy,history", "--history", "0:5:11", "-o", several)
    own["run"].append(several)

    changed = 0
    drawn = random.Random(1)
    for file, text in corpus.items():
        if text or file.stat().st_size > 20_000:
            continue
        for document in documents(file):
            if drawn.randrange(nth):
                continue
            new = folder / file.parent.name / f"{file.stem}-{changed}.json"
            new.parent.mkdir(exist_ok=True)
            new.write_text(json.dumps(document), encoding="utf-8")
            files[file.parent.name].append(new)
            changed += 1
    print(f"{len(corpus)} files of the corpus, {changed} changed ones", flush=True)

    beyond = [re.compile(each) for said in BEYOND_SCHEMAS.values() for each in said]
    exceptions = 0
    pairs = [(kind, file) for kind in KINDS for file in files[kind] + own[kind]]
    with multiprocessing.Pool(os.cpu_count()) as processes:
        allowed = dict(zip(pairs, processes.starmap(schema_allows, pairs, chunksize=100)))
    for kind in KINDS:
        said = complaints(kind, files[kind] + own[kind])
        for file in own[kind]:
            if not allowed[kind, file]:
                faults.append(f"{file}: rejected by the {kind} schema")
            faults.extend(f"rejected: {line}" for line in said[str(file)])
        for file in files[kind]:
            lines = said[str(file)]
            beyond_schemas = all(any(each.search(line) for each in beyond) for line in lines)
            exceptions += bool(lines) and beyond_schemas
            if allowed[kind, file] != beyond_schemas:
                verdict = "allows" if allowed[kind, file] else "rejects"
                faults.append(f"the {kind} schema {verdict} {file}, of which the program says: {lines}")
    if not faults:
        shutil.rmtree(folder)
    finish(f"{exceptions} rejected for what no schema can express, ", most=20)


main()
