#!/usr/bin/env python3
"""Do the fast tests notice a fault in the library? Plants those of faults.txt, one at a time, and writes results.md.

In a scratch copy of the sources each fault is built and tested until a test fails: it is caught. A fault that does
not compile proves nothing and has to be replaced. What survives is either told apart by no test that could be
written, and faults.txt says why, or shows that a test is missing.

The fast tests are the doctest binaries, in the order of what they cost, those named after the faulty file sooner and
the one that has caught the fault before first; at last the command lines and files of tests/cli and tests/corpus. Not
among them are the comparisons with data/reference/, which would notice any change at all, right or wrong.

The pass takes hours, and goes on where it was stopped, on another machine, too: results.md keeps what was found of each
fault. What was caught, or has its excuse, is not done again while its line in the sources stays as it is, unless with
--afresh.
"""

import argparse
import fcntl
import functools
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGE = HERE / "results.md"
SOURCE = HERE.parents[1]
LIBRARY = Path("src")
BUILD_TIMEOUT = 900
FLAGS = "-O1"
CLI_TESTS = ["ctest", "-R", "^(cli|corpus): ", "-E", "1 GB|schemas", "--stop-on-failure", "--output-on-failure"]


@dataclass
class Fault:
    file: str
    kind: str
    meaning: str
    fragment: str
    replacement: str
    excuse: str  # why no test can catch it

    def line(self, text):
        """The lines that the fragment is part of: while they are as they were the fault is the same one."""
        begin = text.index(self.fragment)
        end = begin + len(self.fragment)
        return text[text.rfind("\n", 0, begin) + 1:text.find("\n", end)].strip()

    def digest(self, text):
        return hashlib.sha256(" | ".join((self.file, self.line(text), self.fragment, self.replacement)).encode()).hexdigest()[:8]


def read_faults(file):
    faults = []
    for block in re.split(r"\n\s*\n", file.read_text()):
        lines = [line for line in block.splitlines() if not line.startswith("#")]
        if not lines:
            continue
        part = {mark: "\n".join(line[2:] for line in lines[1:] if line[:1] == mark) for mark in "-+="}
        faults.append(Fault(*lines[0].split(": ", 2), part["-"], part["+"], part["="]))
    return faults


def stale(faults):
    """The fragments that the sources no longer hold, or hold more than once."""
    lines = []
    for fault in faults:
        file = SOURCE / LIBRARY / fault.file
        count = file.read_text().count(fault.fragment) if file.exists() else 0
        if count != 1 or fault.fragment == fault.replacement:
            lines.append(f"{fault.file}: must be there once, is {count} times: {fault.fragment}")
    return lines


def synchronise(source, target):
    """Copies what differs, so that what does not is not built anew; removes what is gone."""
    target.mkdir(parents=True, exist_ok=True)
    names = {each.name for each in source.iterdir() if not each.name.startswith((".", "build", "__pycache__"))}
    for each in target.iterdir():
        if each.name not in names and each.name != "build":
            shutil.rmtree(each) if each.is_dir() else each.unlink()
    for name in names:
        here, there = source / name, target / name
        if here.is_dir():
            synchronise(here, there)
        elif not there.exists() or here.read_bytes() != there.read_bytes():
            shutil.copy(here, there)


def run(command, folder, timeout=None):
    """Exit code, None where it took too long, and all that was printed."""
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               errors="replace", start_new_session=True)
    try:
        out, _ = process.communicate(timeout=timeout)
        return process.returncode, out
    except BaseException as problem:
        os.killpg(process.pid, signal.SIGKILL)
        out, _ = process.communicate()
        if isinstance(problem, subprocess.TimeoutExpired):
            return None, out
        raise


class Tree:
    """A copy of the sources and its build, which can be put back as it was."""

    def __init__(self, folder, jobs):
        self.sources, self.build, self.sound = folder / "tree", folder / "tree/build", folder / "sound"
        self.jobs, self.compiled_from = str(jobs), {}
        synchronise(SOURCE, self.sources)
        if self.sound.exists():
            self.restore_build()
        if not (self.build / "build.ninja").exists():
            code, out = run(["cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None", "-DBUILD_TESTING=ON", "-DPYTHON_MODULE=OFF",
                             f"-DCMAKE_CXX_FLAGS={FLAGS}"], self.sources)
            if code != 0:
                sys.exit(out)
        code, out = run(["ninja", "-t", "targets", "all"], self.build)
        found = re.findall(r"^tests/(\w+/)?test_(\w+): CXX_EXECUTABLE", out, re.MULTILINE)
        self.binaries = {name: f"tests/{folder}test_{name}" for folder, name in found} | {"cli": "src/impact-damper"}

    @functools.cached_property
    def program(self):
        """The program of each file with test cases (../together.cmake)."""
        return {file: together.stem.removeprefix("together_") for together in self.build.rglob("together_*.cpp")
                for file in re.findall(r'^#include ".*/(\w+)[.]cpp"$', together.read_text(), re.MULTILINE)}

    def make(self, test):
        return run(["ninja", "-j", self.jobs, self.binaries[test]], self.build, BUILD_TIMEOUT)

    def digest(self, test):
        return hashlib.sha256((self.build / self.binaries[test]).read_bytes()).hexdigest()

    def check(self, test, timeout=None):
        if test == "cli":
            return run(CLI_TESTS + ["-j", self.jobs], self.build, timeout)
        return run([str(self.build / self.binaries[test]), "--abort-after=1", "--no-colors"], self.build / "tests",
                   timeout)

    def includes(self, test, file):
        """Whether the test's own source includes a file of the library, so that it takes compiling."""
        if not self.compiled_from:
            _, out = run(["ninja", "-t", "deps"], self.build)
            for block in out.split("\n\n"):
                if found := re.match(r"tests/(?:\w+/)?CMakeFiles/test_(\w+)\.dir/", block):
                    self.compiled_from[found[1]] = block
        return f"{LIBRARY}/{file}\n" in self.compiled_from.get(test, "") + "\n"

    def keep(self):
        half = self.sound.with_suffix(".tmp")
        for folder in half, self.sound:
            shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(self.build, half, symlinks=True)
        half.rename(self.sound)

    def restore(self, file, text, times):
        """With the old time stamps: nothing is built anew."""
        file.write_text(text)
        os.utime(file, ns=times)
        self.restore_build()

    def restore_build(self):
        for folder, _, names in os.walk(self.sound):
            place = self.build / Path(folder).relative_to(self.sound)
            place.mkdir(parents=True, exist_ok=True)
            for name in names:
                sound, now = Path(folder, name), place / name
                kept, found = sound.lstat(), now.lstat() if now.exists() else None
                if not found or (kept.st_size, kept.st_mtime_ns) != (found.st_size, found.st_mtime_ns):
                    shutil.copy2(sound, now, follow_symlinks=False)


def first_failure(test, out):
    if test == "cli":
        found = (re.search(r"^FAILED \d+ (.*)", out, re.MULTILINE) or  # tests/cli/command_lines.py
                 re.search(r"The following tests FAILED:\s+\d+ - (.*) \(", out))
        return found[1] if found else "cli"
    found = re.search(r"(\w+)[.]cpp:\d+:\nTEST CASE:\s+(.*)", out)
    return f"{found[1]}: {found[2]}" if found else f"{test}: crashed"


def check_sound(tree, state, memory):
    """Every test passes without a fault; how long it takes, and the bytes of its binary."""
    sound = state.setdefault("sound", {})
    for number, test in enumerate(tree.binaries, 1):
        print(f"no fault: {test} ({number} of {len(tree.binaries)})", file=sys.stderr)
        code, out = tree.make(test)
        if code != 0:
            sys.exit(out)
        begin, digest = time.monotonic(), tree.digest(test)
        if sound.get(test, {}).get("digest") == digest:
            continue
        code, out = tree.check(test)
        if code != 0:
            sys.exit(f"{test} fails without a fault:\n{out}")
        sound[test] = {"digest": digest, "run": round(time.monotonic() - begin, 2)}
        memory.write_text(json.dumps(state, indent=1))
    tree.keep()


def examine(tree, fault, sound, before):
    """Who catches the fault: (verdict, by whom)."""
    stem = Path(fault.file).stem
    caught = before[1].split(": ")[0] if before else ""
    caught = tree.program.get(caught, caught)

    def cost(test):
        seconds = sound[test]["run"] + 1 + 5 * tree.includes(test, fault.file)  # linking, compiling
        return seconds / 10 if test == tree.program.get(stem) else seconds

    order = sorted(tree.binaries, key=lambda test: (test != caught, test == "cli", cost(test)))
    for test in order:
        code, out = tree.make(test)
        if code is None:
            return "caught", "compiling takes for ever"
        if code != 0:
            return ("not compiled", out) if "error:" in out else ("caught", f"{test}: (crashed)")
        if tree.digest(test) == sound[test]["digest"]:
            continue
        code, out = tree.check(test, 30 + 10 * sound[test]["run"])
        if code is None:
            return "caught", f"{test}: takes too long"
        if code != 0:
            return "caught", first_failure(test, out)
    return "survived", ""


def known_results():
    """What results.md says: verdict and by whom, by the digest of a fault."""
    rows = re.findall(r"^\| .* \| ([0-9a-f]{8}) \| (?:\*\*(.*?)\*\*.*|(.*)) \|$", PAGE.read_text() if PAGE.exists() else "", re.MULTILINE)
    return {digest: (verdict or "caught", by) for digest, verdict, by in rows}


def page(faults, results):
    """The table as Markdown, and whether all is well."""
    def row(fault, digest, verdict, by):
        end = by if verdict == "caught" else f"**{verdict}**{fault.excuse and ': ' + fault.excuse}"
        return f"| {fault.file} | {fault.kind}: {fault.meaning} | {digest} | {end} |".replace("\n", " ")

    left = [result for result in results if result[2] != "caught"]
    caught = [result for result in results if result[2] == "caught"]
    share = 100 * len(caught) / len(results)
    well = len(results) == len(faults) and share >= 95 and all(
        verdict == "survived" and fault.excuse for fault, _, verdict, _ in left)
    lines = ["# Planted faults and who caught them", "",
             f"By `make mutation` ([mutate.py](mutate.py) says how), which also reads this page. {len(results)} faults of {len(faults)} "
             f"have been tried, {len(caught)} caught ({share:.1f} %), {len(left)} survived. What each changes: "
             "[faults.txt](faults.txt). The digest is of the fault and its line in the sources.", "",
             "| file | fault | digest | caught by |", "|---|---|---|---|"]
    return "\n".join(lines + [row(*result) for result in left + caught]) + "\n", well


def keep(text):
    half = PAGE.with_suffix(".tmp")
    half.write_text(text)
    half.rename(PAGE)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, default=SOURCE / "build/mutation", help="to work in")
    parser.add_argument("--only", default="", metavar="REGEX", help="only faults whose file or meaning matches")
    parser.add_argument("--afresh", action="store_true", help="also what is known to be caught")
    parser.add_argument("--check", action="store_true", help="plant none; only whether each can be, which a test asks")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="for compiling")
    options = parser.parse_args()

    signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended from outside"))  # not without what it began

    faults = read_faults(HERE / "faults.txt")
    if lines := stale(faults):
        sys.exit("faults.txt: these fragments have to be renewed:\n" + "\n".join(lines))
    if options.check:
        return
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    lock = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        sys.exit(f"{folder}: another pass works here")
    tree = Tree(folder, options.jobs)
    memory = folder / "state.json"
    state = json.loads(memory.read_text()) if memory.exists() else {}
    check_sound(tree, state, memory)

    known = known_results()
    digests = [fault.digest((tree.sources / LIBRARY / fault.file).read_text()) for fault in faults]

    def told():  # without faults that are no more
        return page(faults, [(fault, digest, *known[digest]) for fault, digest in zip(faults, digests) if digest in known])

    for number, fault in enumerate(faults, 1):
        file = tree.sources / LIBRARY / fault.file
        text, times = file.read_text(), (file.stat().st_atime_ns, file.stat().st_mtime_ns)
        before = known.get(digests[number - 1])
        wanted = re.search(options.only, f"{fault.file}: {fault.meaning}")
        finished = before and (before[0] == "caught" or fault.excuse)
        if wanted and (options.afresh or not finished):
            print(f"[{number}/{len(faults)}] {fault.file}: {fault.kind}: {fault.meaning}", file=sys.stderr, end=" ",
                  flush=True)
            begin = time.monotonic()
            try:
                file.write_text(text.replace(fault.fragment, fault.replacement))
                verdict, by = examine(tree, fault, state["sound"], before)
            finally:
                tree.restore(file, text, times)
            known[digests[number - 1]] = (verdict, by)
            keep(told()[0])
            print(f"- {verdict}, {time.monotonic() - begin:.0f} s: {by[:2000]}", file=sys.stderr)
    if known.keys().isdisjoint(digests):
        sys.exit("no fault matches")
    text, well = told()
    keep(text)
    print(text.splitlines()[2])
    sys.exit(0 if well else 1)


if __name__ == "__main__":
    main()
