#!/usr/bin/env python3
"""Is every number that the program gives out looked at by some test? Alters each, and writes who noticed: BUILD/outputs.md.

    outputs.py BUILD

The program build/tests/mutation/outputs lists what is given out, and which faults can be planted in it; planter.cpp,
which is linked into every test program, plants the one that PLANTED_FAULT names. Nothing is built anew, so that the
two thousand faults take minutes, and about one where BUILD/outputs.md says who noticed them before: that test is tried
first. Then come those of MOSTLY and OWN, whose tests compare with closed forms and integrations of their own, then all others. Not
among them are the comparisons with data/reference/, which would notice any change, right or wrong.

Exit code 1 if a fault survives.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
# Where faults are planted, and the test programs that look there.
OWN = {"exact": ["recorded"], "restitution": ["recorded"], "cem": ["recorded"], "exact-dampers": ["recorded"],
       "restitution-dampers": ["recorded"], "cem-dampers": ["recorded"], "file": ["run_file"], "read": ["run_file"], "table": ["series"],
       "measure": ["measures", "measures_of_runs"]}
# The case that notices nearly all of them, where others of its program take far longer.
MOSTLY = {engine: f"recorded: all that the {name} records is*"
          for engine, name in (("exact", "exact engine"), ("restitution", "restitution engine"), ("cem", "component element method"))}
MOSTLY |= {f"{engine}-dampers": case.replace("records is", "records of several") for engine, case in MOSTLY.items()}
FIRST = list(dict.fromkeys(sum(OWN.values(), [])))
HEAD = """# Faults planted in what is given out, and who noticed

By tests/mutation/outputs.py, a test: {faults} faults in {outputs} numbers and columns, {caught} caught. What is altered \
where, and how: planter.hpp. Below each test stands which faults it caught, in which numbers; the first word is where they are \
planted: in what an engine returns (`exact`, `restitution`, `cem`; of several dampers `exact-dampers` and so on), in what is written to a run \
file (`file`) or read from one (`read`), in a figure's table (`table`, with block and column), in a measure (`measure`).
"""


def failing_case(program, fault, case=""):
    """The first test case of the program (and its options) that fails with the fault, or none; of all of them, or of one."""
    # Tests of one name write files of one name: each has a folder of its own, or they fail for no fault.
    with tempfile.TemporaryDirectory() as folder:
        # A comma would divide the name into two.
        only = [f"--test-case={case.replace(',', '*')}"] if case else []
        done = subprocess.run([*program, "--abort-after=1", "--no-colors", *only], cwd=program[0].parent, text=True,
                              env=os.environ | {"PLANTED_FAULT": fault, "TMPDIR": folder}, capture_output=True,
                              errors="replace", timeout=600)
    if done.returncode == 0:
        return None
    found = re.search(r"^TEST CASE:\s+(.*)", done.stdout, re.MULTILINE)
    return found[1] if found else "(ends with an error)"


def noticed_before(file):
    """What outputs.md says: the test by fault, as "program: case"; nothing where there is none yet."""
    text = file.read_text() if file.exists() else ""
    return {(f"{place}/{name}", kind): by for by, lines in re.findall(r"^## (.*)\n\n((?:- .*\n)*)", text, re.MULTILINE)
            for place, kinds, names in re.findall(r"^- (\S+) (.*?): (.*)$", lines, re.MULTILINE)
            for kind in kinds.split(", ") for name in names.split(", ")}


def page(found):
    """outputs.md for what was found: pairs of a fault and the test that noticed it, or none."""
    kinds, lines = defaultdict(list), defaultdict(list)
    for (output, kind), by in found:
        if by:
            kinds[output, by].append(kind)
    for (output, by), those in kinds.items():
        place, name = output.split("/", 1)
        lines[by, f"{place} {', '.join(those)}"].append(name)
    text = HEAD.format(faults=len(found), outputs=len({output for (output, _), _ in found}), caught=sum(1 for _, by in found if by))
    for test in dict.fromkeys(by for by, _ in lines):
        text += f"\n## {test}\n\n" + "".join(f"- {what}: {', '.join(names)}\n" for (by, what), names in lines.items() if by == test)
    return text


def who_notices(programs, before, output, kind):
    place = output.split("/")[0]
    name, _, case = (before or MOSTLY.get(place, "")).partition(": ")
    if name in programs and (found := failing_case(programs[name], f"{output}/{kind}", case)):
        return f"{name}: {found}"
    for name, program in sorted(programs.items(), key=lambda item: item[0] not in OWN[place]):
        if case := failing_case(program, f"{output}/{kind}"):
            return f"{name}: {case}"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("--only", default="", metavar="REGEX", help="only faults that match")
    parser.add_argument("--first", action="store_true", help="by no other programs than " + ", ".join(FIRST))
    options = parser.parse_args()

    tests = options.build.resolve() / "tests"
    # The files of a program are included by one source (../together.cmake). Not among them are those of steady/ and sweeps/.
    everything = {file: [tests / together.stem.replace("together_", "test_"), f"--source-file=*/{file}.cpp"]
                  for together in sorted(tests.glob("together_*.cpp"))
                  for file in re.findall(r'^#include ".*/tests/(\w+)[.]cpp"$', together.read_text(), re.MULTILINE)}
    rest = [] if options.first else [name for name in everything if name not in FIRST]
    programs = {name: everything[name] for name in FIRST + rest}
    file = options.build.resolve() / "outputs.md"
    before = noticed_before(file)
    listed = subprocess.run([tests / "mutation/outputs", SOURCE], stdout=subprocess.PIPE, text=True)
    if listed.returncode != 0:
        sys.exit("an output cannot be altered: planter.cpp has to know it")
    faults = [(output, kind) for output, *kinds in map(str.split, listed.stdout.splitlines()) for kind in kinds
              if re.search(options.only, f"{output}/{kind}")]
    with ThreadPoolExecutor(2) as threads:
        # Of a few faults the time is not taken: CTest runs the same tests.
        unplanted = [] if options.only else FIRST
        for name, case in zip(unplanted, threads.map(lambda name: failing_case(programs[name], ""), unplanted)):
            if case:
                sys.exit(f"without a fault there fails {name}: {case}")
        found = list(threads.map(
            lambda fault: who_notices(programs, before.get(fault, ""), *fault), faults))

    for (output, kind), by in zip(faults, found):
        if not by:
            print(f"survives: {output}/{kind}")
    print(f"{len(faults)} faults, {found.count(None)} survive")
    if not options.only:
        file.write_text(page(list(zip(faults, found))))
    sys.exit(1 if None in found else 0)


if __name__ == "__main__":
    main()
