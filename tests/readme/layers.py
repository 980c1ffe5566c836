#!/usr/bin/env python3
"""The folders of src/ include only themselves and those above them in the table of docs/architecture.md.

    layers.py SOURCE

Exit code 1: includes that lead down the table, or folders that are not in it, one a line.
"""
import re
import sys
from pathlib import Path


def layer_of(path: str, layers: list):
    """The first row that fits: a folder, else a beginning of names, else the files of the library's own folder."""
    for number, layer in enumerate(layers):
        if layer.endswith("/") and path.startswith(layer):
            return number
    for number, layer in enumerate(layers):
        if layer.endswith("*") and layer != "impact_damper/*" and path.startswith(layer[:-1]):
            return number
    return layers.index("impact_damper/*") if path.count("/") == 1 and path.startswith("impact_damper/") else None


def main() -> int:
    source = Path(sys.argv[1]).resolve()
    layers = re.findall(r"^\| `([\w/*]+)` \|", (source / "docs/architecture.md").read_text(encoding="utf-8"), re.M)
    layers = [layer for layer in layers if "/" in layer]
    faults, includes = [], 0
    for file in sorted((source / "src").rglob("*.?pp")):
        path = str(file.relative_to(source / "src")).removeprefix("include/")
        own = layer_of(path, layers)
        if own is None:
            faults.append(f"src/{path}: docs/architecture.md does not name its folder")
            continue
        for included in re.findall(r'^#include "((?:impact_damper|application)/[^"]+)"', file.read_text(encoding="utf-8"), re.M):
            includes += 1
            if layer_of(included, layers) is None or layer_of(included, layers) > own:
                faults.append(f"src/{path}: includes {included}, which stands below it")
    print("\n".join(faults + [f"{len(layers)} folders, {includes} includes, {len(faults)} faults"]))
    return 1 if faults or includes < 200 else 0


if __name__ == "__main__":
    sys.exit(main())
