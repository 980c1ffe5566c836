#!/usr/bin/env python3
"""docs/report.html is the report of this state of the sources, but for commits and days.

    page_is_kept.py SOURCE NEW PAGE

PAGE is the report as it was just made, NEW what paper/refresh made. Figures by another gnuplot are left out: what they
show is compared by same_bits/reference.py. Exit code 1: it differs.
"""
import re
import sys
from pathlib import Path

SOURCE, NEW, PAGE = (Path(each) for each in sys.argv[1:4])


made_with = "data/reference/made_with.txt"
same_gnuplot = (SOURCE / made_with).read_text() == (NEW / made_with).read_text()


def lines_of(file: Path) -> list:
    text = file.read_text(encoding="utf-8")
    if not same_gnuplot:
        text = re.sub("<svg.*?</svg>", "SVG", text, flags=re.S)
    text = re.sub(r"\b[0-9a-f]{12}\b(\s+with\s+changes)?|\bunknown\b", "COMMIT", text)
    return re.sub(r"\b\d{4}-\d\d-\d\d\b", "DAY", text).split("\n")


kept, made = lines_of(SOURCE / "docs/report.html"), lines_of(PAGE)
for number, (old, new) in enumerate(zip(kept + [""] * len(made), made), 1):
    if old != new:
        at = next(i for i, (a, b) in enumerate(zip(old + "\0", new + "\0")) if a != b)
        sys.exit(f"docs/report.html is not the report, make report-page: line {number}, {old[at:at + 80]!r} instead of {new[at:at + 80]!r}")
if len(kept) != len(made):
    sys.exit("docs/report.html is longer than the report: make report-page")
