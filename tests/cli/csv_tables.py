"""Each figure's table as CSV, read by Python's csv module, holds the numbers of the table that gnuplot reads.

    csv_tables.py CATALOGUE TABLES        TABLES has those of the catalogue, as the build makes them in both forms

Both are read by their own rules: of the one the header, block names, quoted headings and blank lines, of the other
rows of six cells. Numbers are compared as texts: both have every digit.
"""
import csv
import json
import pathlib
import re
import sys

catalogue, tables = (pathlib.Path(word) for word in sys.argv[1:3])
faults = []
# Columns that are ends of an interval at x, by block and number; all others are curves.
ENDS = {("band", 2): "low", ("band", 3): "high", ("spread", 2): "low", ("spread", 3): "high"}
ENDS_OF_PHASES = {("stuck", 2): "low", ("stuck", 3): "high"}
ENDS_OF_CHARTS = {("curve", 3): "low", ("curve", 4): "high"}
ENDS_OF_SETS = {("set", 3): "low", ("set", 4): "high"}
GAP = ("", "", "", "")


def gnuplot_blocks(text):
    """Name, headings and rows of each block; None where a blank line interrupts the rows."""
    for part in text.split("\n\n\n")[1:]:
        lines = part.rstrip("\n").split("\n")
        body = [line for line in lines if not line.startswith("#")]
        yield lines[0][2:], re.findall(r'"([^"]*)"', body[0]), [line.split(" ") if line else None for line in body[1:]]


def wanted_rows(kind, name, headings, rows):
    """(block, curve, x, y, low, high) of each row, in the order of the file."""
    own = {"phase": ENDS_OF_PHASES, "design_charts": ENDS_OF_CHARTS, "damper_sets": ENDS_OF_SETS}
    ends = {} if kind == "largest_response" else {**ENDS, **own.get(kind, {})}
    family = re.sub(r"(-\d+)+$", "", name)
    role = {column: ends.get((family, column), "y") for column in range(2, len(headings) + 1)}
    low, high = ([c for c in role if role[c] == end] for end in ("low", "high"))
    curves = [c for c in role if role[c] == "y"]
    for column in curves or high:
        for row in rows:
            if row is None:
                yield (name, headings[column - 1], *GAP)
                continue
            beside = column == (curves or high)[-1]
            yield (name, headings[column - 1], row[0], row[column - 1] if curves else "",
                   row[low[0] - 1] if low and beside else "", row[high[0] - 1] if high and beside else "")


def demand(holds, what):
    if not holds:
        faults.append(what)


seen = set()
for figure in json.loads(catalogue.read_text(encoding="utf-8"))["figures"]:
    if figure["table"] == "drawing":
        continue
    stem = pathlib.Path(figure["script"]).stem
    text = (tables / f"{stem}.dat").read_text(encoding="utf-8")
    wanted = [row for block in gnuplot_blocks(text) for row in wanted_rows(figure["table"], *block)]
    with open(tables / f"{stem}.csv", newline="", encoding="utf-8") as file:
        header, *given = map(tuple, csv.reader(file))
    demand(header == ("block", "curve", "x", "y", "low", "high"), f"{stem}.csv: its header is {header}")
    at = next((i for i, pair in enumerate(zip(given, wanted)) if pair[0] != pair[1]), min(len(given), len(wanted)))
    demand(given == wanted, f"{stem}.csv: {len(given)} rows, {len(wanted)} in {stem}.dat; the first that differs is number {at + 1}: "
                            f"{given[at:at + 1]} and {wanted[at:at + 1]}")
    for cells in given:
        seen.add("".join("-" if cell == "" else "n" for cell in cells[2:]))
        list(map(float, filter(None, cells[2:])))
# Values, bands, a value with its band: each kind is there. Gaps depend on a chaotic decay; tests/series.cpp has one.
demand(seen - {"----"} == {"nn--", "n-nn", "nnnn"}, f"kinds of rows: {sorted(seen)}")
print("\n".join(fault[:600] for fault in faults))
sys.exit(bool(faults))
