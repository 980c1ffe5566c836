"""The tests of this folder, seen to fail: on a program, or a Makefile, with a planted fault each must report it.

A fault of the program is a script that stands between the test and impact-damper; one of the Makefile is planted in a
copy of what the tests read.
"""

import re
import shutil
import subprocess
import sys

import scratch
from trial import demand, finish, folder, program

# The arguments with -o FILE taken out, what was made then stands in $made.
AFTERWARDS = """#!/bin/sh
case $1 in run | series | verify) ;; *) exec {program} "$@" ;; esac
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
output= previous=
for argument; do
  [ "$previous" != -o ] || output=$argument
  previous=$argument
done
[ -n "$output" ] && [ -f "$output" -o ! -e "$output" ] || exec {program} "$@"
command=
for argument; do
  shift
  [ "$argument" != "$output" ] || argument=$made/output
  set -- "$@" "$argument"
done
{program} "$@" || exit
{fault}
"""
# The same program, with other arguments or after something else.
BEFORE = """#!/bin/sh
{fault}
exec {program} "$@"
"""
# Interrupted it does what it should, and the fault comes instead of its end.
INTERRUPTED = """#!/bin/sh
{program} "$@" &
end() {{
  kill -KILL $!
  {{ wait $!; }} 2>/dev/null
  {fault}
}}
trap 'end 130' INT
trap 'end 143' TERM
trap 'end 129' HUP
wait $!
"""
SAYS = 'echo "impact-damper: interrupted: out.json is not written" >&2\n'
KILLED = ["killed.py", "--seed", "1", "--figures", "7", "10", "13"]
RUN_INTERRUPTED = ["interrupted.py", "--seed", "1", "--parts", "run"]
MAKE_INTERRUPTED = ["interrupted.py", "--seed", "1", "--figures", "5", "7", "--parts"]
SHORTEST = ["bounds.py", "--scenes", "0", "--only"]  # with commands that are done in no time

# What is planted; where and how; which tests must find it, and what they must say.
FAULTS = {
    "writes to the final name, in two halves": (
        AFTERWARDS, 'half=$(($(wc -c <"$made/output") / 2))\nhead -c $half "$made/output" >"$output"\nsleep 0.2\n'
        'tail -c +$((half + 1)) "$made/output" >>"$output"',
        [([*KILLED, "--kills", "24"], "is partial after a kill")]),
    "writes although the bytes are the same": (
        AFTERWARDS, 'cat "$made/output" >"$made/copy"\nmv "$made/copy" "$output"', [(["stamps.py"], "wrote")]),
    "leaves an unfinished file behind": (
        AFTERWARDS, 'cp "$made/output" "$(dirname "$output")/.$(basename "$output").1.tmp"\n'
        'mv "$made/output" "$output"',
        [(["unwritable.py"], "unfinished"), ([*KILLED, "--kills", "5"], "unfinished")]),
    "does not tell that the disk is full": (
        AFTERWARDS, 'cat "$made/output" >"$output" 2>/dev/null\nexit 0',
        [(["unwritable.py"], "done, but with other bytes")]),

    "goes on although it is interrupted": (
        INTERRUPTED, "exit 0", [(RUN_INTERRUPTED, "run was never met alive")]),
    "is interrupted with another exit code": (
        INTERRUPTED, SAYS + "exit 2", [(RUN_INTERRUPTED, "run: exit code 2")]),
    "says nothing when it is interrupted": (
        INTERRUPTED, "exit $1", [(RUN_INTERRUPTED, "run: says ''")]),
    "is interrupted with half a file": (
        INTERRUPTED, SAYS + "echo half >out.json\nexit $1", [(RUN_INTERRUPTED, "a file was written all the same")]),
    "is interrupted with a file unfinished": (
        INTERRUPTED, SAYS + "touch .out.json.1.tmp\nexit $1", [(RUN_INTERRUPTED, "unfinished files remain")]),

    "never ends": (
        BEFORE, "while :; do :; done", [([*SHORTEST, "0:1:300000", "--seconds", "1"], "exit code -24 after")]),
    "takes more memory than is allowed": (
        BEFORE, "head -c 260000000 /dev/zero | tail -c 260000000 >/dev/null", [([*SHORTEST, "0:1:300000"], "MB")]),
    "begins what it should reject": (
        BEFORE, 'for argument; do\n  shift\n  case $argument in 1000000000*) argument=10 ;; esac\n'
        '  set -- "$@" "$argument"\ndone',
        [([*SHORTEST, "--max-impacts 1000000000"], "wrote a file")]),
    "gives another reason than the budget that ended it": (
        AFTERWARDS, "sed 's/ \"stop_reason\": \"[a-z]*_budget\"/ \"stop_reason\": \"time\"/' $made/output >\"$output\"",
        [([*SHORTEST, "--engine restitution --x0 0.01 --y0 0.5"], "stopped by time")]),
}
# What is replaced in the Makefile, by what; the test, and what it must say.
MAKEFILE_FAULTS = {
    "lets two work at once": (
        r"if command -v flock .*?\nfi;", "", [([*MAKE_INTERRUPTED, "makes"], "0 waited and said so")]),
    "has a target that does not wait": (
        r"@\$\(alone\) (?=\$\(with_tests\) cmake --build \$\(BUILD\) --target same-bits)", "@",
        [([*MAKE_INTERRUPTED, "makes"], "make same-bits: says")]),
    "does not say what is left": (
        r"echo \"make \$@: interrupted[^\n]*", r":; \\", [([*MAKE_INTERRUPTED, "make"], "make figures: says")]),
}


def planted_tree(folder, pattern, replacement):
    """A copy of what the tests read of the project, with a fault in its Makefile. Where its tests are."""
    scratch.make_folder(folder)
    for name in ("figures", "data", "tests/nothing_lost"):
        shutil.copytree(scratch.SOURCE / name, folder / name)
    for name in ("CMakePresets.json", "CMakeLists.txt"):
        shutil.copy(scratch.SOURCE / name, folder)
    text, count = re.subn(pattern, replacement, (scratch.SOURCE / "Makefile").read_text(), flags=re.S)
    if count != 1:
        sys.exit(f"{pattern!r} stands {count} times in the Makefile")
    (folder / "Makefile").write_text(text)
    return folder / "tests" / "nothing_lost"


def main():
    parser = scratch.arguments(__doc__)
    parser.add_argument("--hold", required=True, help="as killed.py wants it")
    parser.add_argument("--only", default="", help="faults with this text in their names")
    options = parser.parse_args()
    may_mount, skipped = scratch.may_mount(), []

    def find(name, program, tests_folder, tests):
        for (script, *more), expected in tests:
            if script == "unwritable.py" and not may_mount:  # finds these on the disks that it mounts
                skipped.append(f"{script} on what {name}: no mount namespace is permitted here")
                continue
            hold = ["--hold", options.hold] if script == "killed.py" else []
            command = [sys.executable, "-B", str(tests_folder / script), str(program),
                       str(folder / "work"), *hold, *more]
            done = subprocess.run(command, capture_output=True, text=True)
            faults = [line for line in done.stdout.splitlines() if line.startswith("FAULT:")]
            found = [fault for fault in faults if expected in fault]
            demand(done.returncode == 1 and found,
                   f"{script} has not found what {name}, by {expected!r}: {done.stdout}{done.stderr}")
            print(f"{script}: {len(found)} faults of {len(faults)} say that it {name}", flush=True)

    here = scratch.SOURCE / "tests" / "nothing_lost"
    for number, (name, (script, fault, tests)) in enumerate(FAULTS.items()):
        faulty = folder / f"program-{number}"
        faulty.write_text(script.format(program=program, fault=fault))
        faulty.chmod(0o755)
        if options.only in name:
            find(name, faulty, here, tests)
    for name, (pattern, replacement, tests) in MAKEFILE_FAULTS.items():
        if options.only in name:
            find(name, program, planted_tree(folder / "planted", pattern, replacement), tests)
    finish("planted faults, ", skipped)


if __name__ == "__main__":
    main()
