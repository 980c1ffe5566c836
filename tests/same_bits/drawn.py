#!/usr/bin/env python3
"""Whether two pictures by figures/draw show the same, however their gnuplots wrote them: the same texts, axes and curves.

    drawn.py ONE OTHER FILE...      two folders with pictures of these names; exit code 1 if any two differ

Positions may differ by a pixel. gnuplot 5 and 6 join and divide lines in different ways, so a curve is compared by its
vertices; and where a band leaves the frame they cut it at different points, so one vertex of a curve may be elsewhere. On
a short logarithmic axis gnuplot 6 labels more ticks, so numbers alone are no texts here: the ends of axes are compared.
"""
import json
import re
import sys
from pathlib import Path
from typing import NamedTuple, Optional


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


def main() -> int:
    if len(sys.argv) < 4:
        print(f"usage: {sys.argv[0]} ONE OTHER FILE...", file=sys.stderr)
        return 2
    found = [text for name in sys.argv[3:] if (text := difference_in_files(name, *map(Path, sys.argv[1:3])))]
    for text in found:
        print(text)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
