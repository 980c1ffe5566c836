#!/usr/bin/env python3
"""The folders of src/ include only themselves and those to which arrows lead in the picture of docs/architecture.md.

    layers.py SOURCE

Exit code 1: includes against the arrows, arrows in a circle or without an include, folders that the page's table lacks, one a line.
"""
import re
import sys
from pathlib import Path


def folder_of(path: str, rows: list):
    """The node of the first row of the table that fits: a folder, else a beginning of names, else the library's own folder."""
    for row in sorted(rows, key=lambda row: (not row.endswith("/"), row == "impact_damper/*")):
        if path.startswith(row.rstrip("*")) and (row.endswith("/") or path.count("/") == 1):
            return "model" if row == "impact_damper/*" else row.rstrip("/*").split("/")[-1]
    return None


def reached(node: str, arrows: dict) -> set:
    found, left = set(), [node]
    while left:
        new = arrows.get(left.pop(), set()) - found
        found |= new
        left += new
    return found


def main() -> int:
    source = Path(sys.argv[1]).resolve()
    page = (source / "docs/architecture.md").read_text(encoding="utf-8")
    rows = [row for row in re.findall(r"^\| `([\w/*]+)` \|", page, re.M) if "/" in row]
    arrows = {}
    for node, others in re.findall(r"^ *(\w+) --> ([\w& ]+)$", page, re.M):
        arrows.setdefault(node, set()).update(others.split(" & "))
    faults, used, includes = [f"{node}: arrows lead back to it" for node in arrows if node in reached(node, arrows)], set(), 0
    for file in sorted((source / "src").rglob("*.?pp")):
        path = str(file.relative_to(source / "src")).removeprefix("include/")
        own = folder_of(path, rows)
        if own is None:
            faults.append(f"src/{path}: docs/architecture.md does not name its folder")
        for included in re.findall(r'^#include "((?:impact_damper|application)/[^"]+)"', file.read_text(encoding="utf-8"), re.M):
            includes += 1
            used.add((own, folder_of(included, rows)))
            if folder_of(included, rows) not in {own} | reached(own, arrows):
                faults.append(f"src/{path}: includes {included}, to which no arrow leads")
    faults += [f"{node} --> {other}: nothing is included" for node in arrows for other in arrows[node] if (node, other) not in used]
    print("\n".join(faults + [f"{len(rows)} folders, {includes} includes, {len(faults)} faults"]))
    return 1 if faults or includes < 200 else 0


if __name__ == "__main__":
    sys.exit(main())
