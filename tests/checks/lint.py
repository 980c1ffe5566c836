#!/usr/bin/env python3
"""clang-tidy and cppcheck over the sources; any finding fails.

    lint.py BUILD [WORD...]     clang-tidy only over the groups with one of these words in them

BUILD is the build folder, whose compile_commands.json says how each source is compiled. clang-tidy's checks are those
of .clang-tidy, with the reason for each that is left out; cppcheck's are below and in cppcheck.txt. Headers are
looked at with the sources that include them. clang-tidy spends its time on the headers of others, so sources that are
compiled as one are looked at as one, and so are those of ALONE, each of which takes long to compile.

Exit code 1: something was found, 2: a tool or the build is missing.
"""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
CPPCHECK = ["cppcheck", "--enable=warning,style,performance,portability", "--std=c++20", "--error-exitcode=1", "--quiet",
            "--inline-suppr", "--suppressions-list=tests/checks/cppcheck.txt", "--template={file}:{line}: {message} [{id}]",
            "-Isrc", "-Isrc/include", "src"]
ALONE = {"recorded": "/engines/recorded_", "singles": "/(c_interface|steady_state)[.]",
         "application": "/(damper_set_design|hdf5_table|kept_quantities)[.]"}


def missing(text):
    print(f"lint: {text}", file=sys.stderr)
    sys.exit(2)


def compiled(build):
    """What is looked at as one: its name, its sources, the file that includes them, the options."""
    database = build / "compile_commands.json"
    if not database.exists():
        missing(f"{database} is missing: make build")
    alone = {name: [] for name in ALONE}
    for entry in json.loads(database.read_text()):
        file = Path(entry["file"])
        sources = re.findall('#include "(.*[.]cpp)"', file.read_text()) if "Unity" in file.parts else [str(file)]
        if any(SOURCE / "src" not in Path(source).parents for source in sources):
            continue  # generated, or of the tests
        if " -o tests/" in entry["command"]:
            continue  # compiled once more, for a test
        # Without the precompiled header: a source that lacks an include is found so, and clang cannot read g++'s.
        options = [word for word in shlex.split(entry["command"])[1:] if re.match("-(D|I|isystem|f|m|std)", word) or
                   not word.startswith("-") and "/include" in word and not word.endswith(".o")]
        name = next((name for name, pattern in ALONE.items() if re.search(pattern, entry["file"])), None)
        if name:
            alone[name].append((sources, options))
        else:
            yield file.stem, sources, file, options
    for name, entries in alone.items():
        sources = sum((sources for sources, _ in entries), [])
        file = build / f"lint-{name}.cpp"
        file.write_text("".join(f'#include "{source}"\n' for source in sources))
        yield name, sources, file, sum((options for _, options in entries), [])


def tidy(name, file, options):
    done = subprocess.run(["clang-tidy", "--quiet", f"--config-file={SOURCE}/.clang-tidy", str(file), "--", *options],
                          capture_output=True, text=True, cwd=SOURCE)
    found = [text for text in re.split(r"^(?=/\S+:\d+:\d+: (?:warning|error): )", done.stdout, flags=re.MULTILINE)
             if text.strip()]
    return found or ([f"{name}: clang-tidy failed: {done.stderr}"] if done.returncode else [])


def cppcheck():
    done = subprocess.run(CPPCHECK, capture_output=True, text=True, cwd=SOURCE)
    found = [line for line in done.stderr.splitlines() if line.strip()]
    return found or ([f"cppcheck failed: {done.stdout}"] if done.returncode else [])


def main():
    if len(sys.argv) < 2:
        missing("usage: lint.py BUILD [WORD...]")
    for tool in ("clang-tidy", "cppcheck"):
        if not shutil.which(tool):
            missing(f"{tool} is missing: make deps-check installs it")
    build, words = Path(sys.argv[1]).resolve(), sys.argv[2:]
    groups = [group for group in compiled(build) if not words or any(word in str(group[:2]) for word in words)]
    jobs = [(f"clang-tidy, {name} ({len(sources)} sources)", lambda each=(name, file, options): tidy(*each))
            for name, sources, file, options in groups] + [("cppcheck, src", cppcheck)]
    begin, ended, findings = time.monotonic(), [], set()

    def look(job):
        name, find = job
        start = time.monotonic()
        found = find()
        ended.append(name)
        print(f"lint: {len(ended)} of {len(jobs)}: {name}: {len(found)} findings, {time.monotonic() - start:.0f} s",
              file=sys.stderr, flush=True)
        findings.update(found)  # a header's come once for each group that includes it

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(look, jobs))
    for text in sorted(findings):
        print(text.rstrip())
    count = sum(len(sources) for _, sources, _, _ in groups)
    print(f"lint: {count} sources, {len(findings)} findings, {time.monotonic() - begin:.0f} s")
    sys.exit(1 if findings else 0)


main()
