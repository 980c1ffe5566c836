#!/usr/bin/env python3
"""What differs between two results, in the words of the result: a scene and a column, not byte 81234.

    differences.py ONE OTHER        two files, or two folders of them; exit code 1 if any two differ

Results are run files (*.json, all but their provenance), tables (*.dat, *.csv) and pictures (*.svg). Bytes are compared
first. Where they differ, three things are told: what the first differing byte belongs to, how many numbers differ,
and the worst of them with the digits that the two values have in common. Digits count from the largest magnitude
in the column: where a motion passes through zero, the last bits of its amplitude are no loss of digits.
"""
import json
import math
import os
import re
import sys
from itertools import zip_longest
from typing import Iterator, NamedTuple, Optional


class Piece(NamedTuple):
    """One number or one line of text, and where it stands; `column` only if it is a number."""
    place: str
    column: Optional[str]
    text: str


class Difference(NamedTuple):
    name: str
    first: str            # what the first differing byte belongs to, and both values
    count: int            # of numbers that differ
    worst: Optional[str]  # the same for the number with the fewest digits in common
    digits: float         # that those two have in common; -inf if one is missing or is no number

    def __str__(self):
        text = f"{self.name}: first at {self.first}"
        if self.worst:
            text += f"\n    worst of {self.count}: {self.worst}, {self.digits:.1f} digits in common"
        return text


class NumberText(str):
    """A number of a JSON file as it is written."""


def compared_bytes(name: str, data: bytes) -> bytes:
    """What has to be the same: of a run file all but the line that says which program made it."""
    if name.endswith(".json"):
        return b"".join(line for line in data.splitlines(True) if not line.startswith(b' "provenance"'))
    return data


def run_pieces(data: bytes) -> Iterator[Piece]:
    def walk(value, path):
        if isinstance(value, dict):
            for key, inner in value.items():
                yield from walk(inner, path + [key])
        elif isinstance(value, list):
            for row, inner in enumerate(value):
                named = inner.get("claim") if isinstance(inner, dict) else None
                yield from walk(inner, path + [(named or row,)])
        else:
            names = [part for part in path if isinstance(part, str)]
            rows = [str(part[0]) for part in path if isinstance(part, tuple)]
            column = "/".join(names)
            place = f"column {column}, row {'/'.join(rows)}" if rows else column
            yield Piece(place, column if isinstance(value, NumberText) else None, str(value))

    whole = json.loads(data, parse_float=NumberText, parse_int=NumberText)
    whole.pop("provenance", None)
    yield from walk(whole, [])


def table_pieces(data: bytes) -> Iterator[Piece]:
    block, headings, row, blanks = "", [], 0, 0
    for number, line in enumerate(data.decode().split("\n"), 1):
        if blanks == 2:  # so gnuplot tells one block from the next; the name follows
            block, headings, row = line[2:], [], 0
        blanks = 0 if line else blanks + 1
        if line.startswith('"'):
            headings = re.findall(r'"([^"]*)"', line)
        if line.startswith(("#", '"')) or not line:
            yield Piece(f"line {number}", None, line)
            continue
        row += 1
        for index, text in enumerate(line.split(" ")):
            heading = headings[index] if index < len(headings) else str(index + 1)
            yield Piece(f'block {block}, column "{heading}", row {row}', f"{block} {heading}", text)


def line_pieces(data: bytes) -> Iterator[Piece]:
    for number, line in enumerate(data.decode(errors="replace").split("\n"), 1):
        yield Piece(f"line {number}", None, line)


def pieces(name: str, data: bytes) -> Iterator[Piece]:
    if name.endswith(".json"):
        return run_pieces(data)
    return table_pieces(data) if name.endswith(".dat") else line_pieces(data)


def number(piece: Optional[Piece]) -> float:
    try:
        return float(piece.text) if piece and piece.column else math.nan
    except ValueError:
        return math.nan


def shown(piece: Optional[Piece]) -> str:
    return (piece.text if len(piece.text) < 120 else piece.text[:117] + "...") if piece else "nothing"


def compare(name: str, one: bytes, other: bytes) -> Optional[Difference]:
    """None if the bytes that have to be the same are. `name` ends with the kind of file."""
    if compared_bytes(name, one) == compared_bytes(name, other):
        return None
    try:
        pairs = list(zip_longest(pieces(name, one), pieces(name, other)))
    except ValueError as problem:
        return Difference(name, f"a file that cannot be read: {problem}", 0, None, -math.inf)
    scale = {}
    for pair in pairs:
        for piece in pair:
            if piece and piece.column and math.isfinite(number(piece)):
                scale[piece.column] = max(scale.get(piece.column, 0.0), abs(number(piece)))
    first, worst, digits, count = None, None, math.inf, 0
    for a, b in pairs:
        if a == b:
            continue
        told = f"{(a or b).place}: {shown(a)} and {shown(b)}"
        first = first or told
        if not (a or b).column:
            continue
        count += 1
        x, y = number(a), number(b)
        if math.isfinite(x) and math.isfinite(y) and a.place == b.place:
            common = -math.log10(max(abs(x - y) / scale[a.column], 1e-17)) if x != y else 17.0
        else:
            common = -math.inf
        if worst is None or common < digits:
            worst, digits = told, common
    return Difference(name, first or "the way numbers or blanks are written", count, worst, digits)


def compare_files(name: str, one: str, other: str) -> Optional[Difference]:
    for path in (one, other):
        if not os.path.exists(path):
            return Difference(name, f"{path} is missing", 0, None, -math.inf)
    with open(one, "rb") as first, open(other, "rb") as second:
        return compare(name, first.read(), second.read())


def names_in(*folders: str) -> list:
    """The results in either folder, by their path below it."""
    found = set()
    for folder in folders:
        for place, _, files in os.walk(folder):
            found |= {os.path.relpath(os.path.join(place, file), folder)
                      for file in files if file.endswith((".json", ".dat", ".csv", ".svg"))}
    return sorted(found)


def compare_folders(one: str, other: str) -> list:
    found = (compare_files(name, os.path.join(one, name), os.path.join(other, name))
             for name in names_in(one, other))
    return [difference for difference in found if difference]


def main() -> int:
    if len(sys.argv) != 3:
        print(f"usage: {sys.argv[0]} ONE OTHER", file=sys.stderr)
        return 2
    one, other = sys.argv[1:]
    if os.path.isdir(one):
        if not names_in(one, other):
            print("nothing to compare", file=sys.stderr)
            return 2
        differences = compare_folders(one, other)
    else:
        difference = compare_files(os.path.basename(one), one, other)
        differences = [difference] if difference else []
    for difference in differences:
        print(difference)
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
