#!/usr/bin/env python3
"""What differs between two results, in the words of the result: a scene and a column, not byte 81234.

    differences.py ONE OTHER                    two files, or two folders of them
    differences.py --drawn ONE OTHER FILE...    whether pictures of these names in two folders show the same
    differences.py --reference COMMITTED NEW    two folders like data/reference/, NEW by paper/refresh

Exit code 1 if any two differ. Results are run files (*.json, all but their provenance), tables (*.dat, *.csv) and pictures (*.svg).
Bytes are compared first. Where they differ, three things are told: what the first differing byte belongs to, how many numbers
differ, and the worst of them with the digits that the two values have in common. Digits count from the largest magnitude in the
column: where a motion passes through zero, the last bits of its amplitude are no loss of digits.

Every byte of the committed tables and verdicts has to be the same, and of the figures where gnuplot is the one that drew the
committed ones; another one rounds and writes in its own way, so what is drawn has to be the same, and the manifest, which has the
figures' sums, is not compared. The committed files must have their committed SHA-256 sums.
"""
import hashlib
import json
import math
import os
import re
import sys
from itertools import zip_longest
from pathlib import Path
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


# Whether two pictures by figures/draw show the same, however their gnuplots wrote them: the same texts, axes and curves.
# Positions may differ by a pixel. gnuplot 5 and 6 join and divide lines in different ways, so a curve is compared by its
# vertices; and where a band leaves the frame they cut it at different points, so one vertex of a curve may be elsewhere. On
# a short logarithmic axis gnuplot 6 labels more ticks, so numbers alone are no texts here: the ends of axes are compared.
class Drawn(NamedTuple):
    texts: list
    axes: list      # name, lower and upper end, of x and y of each plot, and whether they are logarithmic
    positions: list  # of the axes' ends
    curves: dict    # gnuplot's name -> its vertices, those of its markers, too, in whole pixels


def group(text: str) -> str:
    """The element <g> that a text begins with."""
    depth = 0
    for tag in re.finditer("<(/?)g\\b", text):
        depth += -1 if tag[1] else 1
        if depth == 0:
            return text[:tag.start()]
    return text


def vertices(text: str) -> set:
    shapes = " ".join(re.findall("<(?:path|polygon|use)[^>]*>", text))
    return {(round(float(x)), round(float(y))) for x, y in re.findall(r"(-?\d+\.\d+),(-?\d+\.\d+)", shapes)}


def drawn(picture: str) -> Drawn:
    metadata = re.search("<metadata>(.*)</metadata>", picture, re.S)
    plots = json.loads(metadata[1])["axes"] if metadata else []
    curves = {part.split('"', 2)[1]: vertices(part)
              for part in map(group, re.split(r'(?=<g id="\S*gnuplot_plot_\w+")', picture)[1:])}
    texts = (re.sub("<[^>]*>", "", text) for text in re.findall("<text[^>]*>(.*?)</text>", picture, re.S))
    return Drawn(sorted(text for text in texts if not re.fullmatch(r"\s*-?[\d.]+\s*", text)),
                 [[plot["x"][:3], plot["y"][:3], plot.get("log")] for plot in plots],
                 [end for plot in plots for axis in "xy" for end in plot[axis][3:]], curves if plots else {"schematic": vertices(picture)})


def elsewhere(one: set, other: set) -> int:
    """How many vertices of the one are not within a pixel of one of the other's."""
    near = {(x + dx, y + dy) for x, y in other for dx in (-1, 0, 1) for dy in (-1, 0, 1)}
    return len(one - near)


def difference_in(name: str, one: str, other: str) -> Optional[str]:
    a, b = drawn(one), drawn(other)
    if a.texts != b.texts:
        return f"{name}: another text, {sorted(set(a.texts) ^ set(b.texts))}"
    if a.axes != b.axes or any(abs(p - q) > 1 for p, q in zip(a.positions, b.positions)):
        return f"{name}: other axes, {a.axes} and {b.axes}"
    if a.curves.keys() != b.curves.keys():
        return f"{name}: other curves, {sorted(a.curves.keys() ^ b.curves.keys())}"
    for curve, points in a.curves.items():
        count = max(elsewhere(points, b.curves[curve]), elsewhere(b.curves[curve], points))
        if count > 1:
            return f"{name}: {curve} runs elsewhere in {count} of {len(points)} vertices"
    return None


def difference_in_files(name: str, one: Path, other: Path) -> Optional[str]:
    for folder in (one, other):
        if not (folder / name).exists():
            return f"{folder / name} is missing"
    return difference_in(name, *((folder / name).read_text(encoding="utf-8") for folder in (one, other)))


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
    option = sys.argv.pop(1) if sys.argv[1:2] in (["--drawn"], ["--reference"]) else ""
    if len(sys.argv) < 3 or (len(sys.argv) > 3) != (option == "--drawn"):
        print(__doc__, file=sys.stderr)
        return 2
    one, other, *names = map(Path, sys.argv[1:])
    if option == "--reference":
        for folder in (one, other):
            if not (folder / "made_with.txt").exists():
                print(f"{folder}: holds no reference, made_with.txt is missing", file=sys.stderr)
                return 1
        found = differences(one, other)
        found += [f"{len(found)} differences from {one}; if the new ones are right: make reference"] * bool(found)
    elif option:
        found = [text for name in names if (text := difference_in_files(str(name), one, other))]
    elif not one.is_dir():
        found = list(filter(None, [compare_files(one.name, str(one), str(other))]))
    elif not names_in(str(one), str(other)):
        print("nothing to compare", file=sys.stderr)
        return 2
    else:
        found = compare_folders(str(one), str(other))
    for each in found:
        print(each)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
