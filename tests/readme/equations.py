#!/usr/bin/env python3
"""Every equation (M7.2) and lemma (L2) that the code cites stands in docs/mathematics.md, and each of these is cited.

    equations.py SOURCE

Exit code 1: numbers that lead nowhere, or that no file of src/ cites, one a line.
"""
import re
import sys
from collections import Counter
from pathlib import Path

EQUATION = r"\bM\d+\.\d+\b"
LEMMA = r"\bLemmas?\s+(?://\s*)?(L\d+)\b"


def main() -> int:
    source = Path(sys.argv[1]).resolve()
    text = (source / "docs/mathematics.md").read_text(encoding="utf-8")
    stated = re.findall(r"\\tag\{(" + EQUATION + r")\}", text) + re.findall(r"\*\*" + LEMMA, text)
    faults = [f"docs/mathematics.md: {number} stands {count} times" for number, count in Counter(stated).items() if count > 1]
    faults += [f"docs/mathematics.md: there is no {number}" for number in sorted(set(re.findall(EQUATION, text)) - set(stated))]

    cited = set()
    for folder in ("src", "tests", "figures", "paper"):
        for file in sorted((source / folder).rglob("*.?pp" if folder in ("src", "tests") else "*.gp")):
            code = file.read_text(encoding="utf-8")
            numbers = set(re.findall(EQUATION, code)) | set(re.findall(LEMMA, code))
            faults += [f"{file.relative_to(source)}: there is no {number}" for number in sorted(numbers - set(stated))]
            cited |= numbers if folder == "src" else set()
    faults += [f"docs/mathematics.md: nothing in src/ cites {number}" for number in stated if number not in cited]
    print("\n".join(faults + [f"{len(stated)} equations and lemmas, {len(faults)} faults"]))
    return 1 if faults or len(stated) < 40 else 0


if __name__ == "__main__":
    sys.exit(main())
