"""The tests of this folder, seen to fail: on programs with a planted fault each must report faults.

A fault is a script that stands between the test and impact-damper.
"""

import subprocess
import sys

import scratch

# The arguments with -o FILE taken out, what was made then stands in $made.
PLANTED = """#!/bin/sh
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
FAULTS = {
    "writes to the final name, in two halves": (
        'half=$(($(wc -c <"$made/output") / 2))\nhead -c $half "$made/output" >"$output"\nsleep 0.05\n'
        'tail -c +$((half + 1)) "$made/output" >>"$output"',
        [["killed.py", "--kills", "40", "--seed", "1", "--figures", "7", "10", "13"]]),
    "writes although the bytes are the same": (
        'cat "$made/output" >"$made/copy"\nmv "$made/copy" "$output"', [["stamps.py"]]),
    "leaves an unfinished file behind": (
        'cp "$made/output" "$(dirname "$output")/.$(basename "$output").1.tmp"\nmv "$made/output" "$output"',
        [["unwritable.py"], ["killed.py", "--kills", "5", "--seed", "1", "--figures", "7", "10", "13"]]),
    "does not tell that the disk is full": (
        'cat "$made/output" >"$output" 2>/dev/null\nexit 0', [["unwritable.py"]]),
}


def main():
    options = scratch.arguments(__doc__).parse_args()
    folder = scratch.make_folder(options.folder)
    check = scratch.Check()
    for number, (name, (fault, tests)) in enumerate(FAULTS.items()):
        program = folder / f"program-{number}"
        program.write_text(PLANTED.format(program=options.program.resolve(), fault=fault))
        program.chmod(0o755)
        for script, *more in tests:
            done = subprocess.run([sys.executable, str(scratch.SOURCE / "tests" / "nothing_lost" / script), "--program",
                                   str(program), "--folder", str(folder / "work"), *more], capture_output=True, text=True)
            found = done.stderr.count("FAULT:")
            check(done.returncode == 1 and found > 0, f"{script} is content with a program that {name}: {done.stdout}{done.stderr}")
            print(f"{script}: {found} faults in a program that {name}", flush=True)
    check.end(f"planted faults, {check.count} tests")


if __name__ == "__main__":
    main()
