#!/usr/bin/env python3
"""Holds the committed reference against what the program makes.

    reference.py COMMITTED NEW      two folders like data/reference/, NEW by paper/refresh

Every byte of tables and verdicts has to be the same, and of the figures where gnuplot is the one that drew the
committed ones; another one rounds and writes in its own way, so what is drawn has to be the same (drawn.py), and the
manifest, which has the figures' sums, is not compared. Exit code 1 if anything differs, with the first and the worst difference of each file, or if the
committed files do not have their committed SHA-256 sums.
"""
import hashlib
import sys
from pathlib import Path

from differences import compare_files, names_in
from drawn import difference_in_files


def sums_of(file: Path) -> dict:
    """Name -> sum, of a list as sha256sum writes it."""
    if not file.exists():
        return {}
    return {name: digest for digest, name in (line.split("  ", 1) for line in file.read_text().splitlines())}


def wrong_sums(folder: Path) -> list:
    listed = sums_of(folder / "SHA256SUMS")
    there = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()} - {"SHA256SUMS"}
    return ([f"{name}: has no sum in SHA256SUMS" for name in sorted(there - listed.keys())] +
            [f"{name}: has a sum in SHA256SUMS, but is missing" for name in sorted(listed.keys() - there)] +
            [f"{name}: does not have the sum in SHA256SUMS" for name in sorted(there & listed.keys())
             if hashlib.sha256((folder / name).read_bytes()).hexdigest() != listed[name]])


def differences(committed: Path, new: Path) -> list:
    """What is wrong, as text. Says on standard output what could not be compared."""
    found = [f"committed {text}" for text in wrong_sums(committed)]
    drawn_with = [(folder / "made_with.txt").read_text().strip() for folder in (committed, new)]
    same_gnuplot = drawn_with[0] == drawn_with[1]
    if not same_gnuplot:
        print(f"The committed figures were drawn with {drawn_with[0]}, here is {drawn_with[1]}: compared is what they "
              "show, not their bytes.")
    for name in names_in(str(committed), str(new)):
        if same_gnuplot or not name.endswith((".svg", "manifest.json")):
            difference = compare_files(name, str(committed / name), str(new / name))
        else:
            difference = name.endswith(".svg") and difference_in_files(name, committed, new)
        if difference:
            found.append(str(difference))
    for listed in ("csv.sha256", "other-engines.sha256"):
        sums = [sums_of(folder / listed) for folder in (committed, new)]
        found += [f"{name}: another SHA-256 sum than in {listed}"
                  for name in sorted(sums[0].keys() | sums[1].keys()) if sums[0].get(name) != sums[1].get(name)]
    return found


def main() -> int:
    if len(sys.argv) != 3:
        print(f"usage: {sys.argv[0]} COMMITTED NEW", file=sys.stderr)
        return 2
    committed, new = map(Path, sys.argv[1:])
    for folder in (committed, new):
        if not (folder / "made_with.txt").exists():
            print(f"{folder}: holds no reference, made_with.txt is missing", file=sys.stderr)
            return 1
    found = differences(committed, new)
    for text in found:
        print(text)
    if found:
        print(f"{len(found)} differences from {committed}; if the new ones are right: make reference")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
