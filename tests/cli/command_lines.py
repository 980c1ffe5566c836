#!/usr/bin/env python3
"""Runs the command lines of command_lines.txt, or `check` of each file that is packed in a folder, and holds what they print,
leave and end with against what is expected.

    command_lines.py PROGRAM LIST FOLDER [--share K/N] [--only NUMBER,...]

LIST is command_lines.txt, whose cases run among the files of files.packed, or a folder with a KIND.packed for each kind of
files that `check` knows (packed_files.py). FOLDER is made anew, for the files. --share takes the K-th of N parts; --only
takes the cases with these numbers, which failures name. A command that fails leaves stdout empty and no new file; one that
is done leaves stderr empty (where a ! stands behind the exit code it warns), and makes its -o file. None changes a file
that it was given.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys

from packed_files import read, unpack

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("program", type=lambda text: pathlib.Path(text).resolve())
parser.add_argument("list", type=lambda text: pathlib.Path(text).resolve())
parser.add_argument("folder", type=lambda text: pathlib.Path(text).resolve())
parser.add_argument("--share", default="1/1")
parser.add_argument("--only")
options = parser.parse_args()

# What takes longer than ten seconds says how far it is: on a slow machine, or under the sanitizers.
PROGRESS = re.compile(r"(verify|response|sweep): [0-9]+ (of [0-9]+|branches) [^\n]*\n|compare: (fitting|simulating|drawing)[^\n]*\n|"
                      r"design: (searched|checking) [^\n]*\n|report: (release [0-9]|simulating|recording|drawing)[^\n]*\n")


def cases():
    """Of each its number, the packed files among which it runs, the words, exit code, whether it warns (absent: it may), and
    the text."""
    if options.list.is_dir():
        checked = [(packed, file, note) for packed in sorted(options.list.glob("*.packed"))
                   for file, (note, _) in read(packed).items()]
        for number, (packed, file, note) in enumerate(checked, 1):
            yield number, packed, f"check {packed.stem} {file}", 3 if note else 0, None, note or f"{file}: valid"
    else:
        lines = options.list.read_text(encoding="utf-8").splitlines()
        for number, line in enumerate((line for line in lines if re.match("[0-9]", line)), 1):
            code, warned, words, said = re.fullmatch(r"([0-9])(!?) \|(.*) \|(.*)", line).groups()
            yield number, options.list.parent / "files.packed", words.strip(), int(code), bool(warned), said.strip()


def files_in(folder):
    """Names, dot files' too, which temporary files are, and by what a change is seen."""
    found = {}
    for path, _, names in os.walk(folder):
        for name in names:
            status = os.lstat(os.path.join(path, name))
            found[os.path.relpath(os.path.join(path, name), folder)] = (status.st_size, status.st_mtime_ns, status.st_ino)
    return found


fresh = {}  # the folders that are as they were unpacked


def faults_of(packed, words, code, warned, said):
    folder = options.folder / packed.stem
    if packed not in fresh:
        unpack(packed, folder)
        fresh[packed] = files_in(folder)
    before = fresh[packed]
    try:
        # By a shell that leaves [] and * as they are.
        done = subprocess.run(["sh", "-fc", f'exec "$0" {words}', str(options.program)], cwd=folder, timeout=60,
                              stdin=subprocess.DEVNULL, capture_output=True, check=False)
    except subprocess.TimeoutExpired:
        del fresh[packed]
        return ["not done after 60 s"]
    out, err = done.stdout.decode("utf-8", "replace"), PROGRESS.sub("", done.stderr.decode("utf-8", "replace"))
    after = files_in(folder)
    if after != before:
        del fresh[packed]
    faults = []
    if done.returncode != code:
        faults.append(f"exit code {done.returncode} instead of {code}")
    output = re.search("-o ([A-Za-z0-9][A-Za-z0-9.-]*)", words) if code == 0 else None
    if code == 0:
        place = err if warned else out
        if err and not warned and not (warned is None and ": warning: " in err):
            faults.append("stderr is not empty")
    else:
        place = err
        if out:
            faults.append("stdout is not empty")
        if "\n\n" in err or not re.fullmatch(r"[^\n][\s\S]*\n", err):
            faults.append("stderr is not one line for each problem")
    if said not in place:
        faults.append(f"the expected text is missing: {said}")
    new = sorted(after.keys() - before.keys())
    if new != ([output[1]] if output else []):
        faults.append(f"new files are {new} instead of {[output[1]] if output else []}")
    changed = [name for name in before if after.get(name) != before[name]]
    if changed:
        faults.append(f"changed files: {changed}")
    return faults + [f"stdout: {out}", f"stderr: {err}"] if faults else []


nth, shares = map(int, options.share.split("/"))
only = {int(number) for number in options.only.split(",")} if options.only else None
shutil.rmtree(options.folder, ignore_errors=True)
ran = failed = 0
for number, *case in cases():
    if number not in only if only else number % shares != nth % shares:
        continue
    ran += 1
    faults = faults_of(*case)
    if faults:
        failed += 1
        print(f"FAILED {number} impact-damper {case[1]}", *faults, sep="\n  ", flush=True)
print(f"{ran} command lines, {failed} failed" + (f"; alone: {sys.argv[0]} {' '.join(sys.argv[1:4])} --only NUMBER" if failed else ""))
sys.exit(failed > 0 or ran == 0)
