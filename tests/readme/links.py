#!/usr/bin/env python3
"""Every relative link of every Markdown file leads to a file of the project, and every anchor to a heading.

    links.py SOURCE

The sources of the report are left out: their links are the report's, which the test of the report in a browser follows.
Exit code 1: links that lead nowhere, one a line.
"""
import os
import re
import sys
from pathlib import Path
from urllib.parse import unquote


def without_code(text: str) -> str:
    text = re.sub(r"^( *)(```+|~~~+).*?^\1\2 *$", "", text, flags=re.M | re.S)
    return re.sub(r"(`+)(?!`).*?(?<!`)\1(?!`)", "", text, flags=re.S)


def anchors_of(text: str) -> set:
    """What a heading is called in a link, as GitHub and GitLab call it, and ids that are given."""
    text = re.sub(r"^(```+).*?^\1 *$", "", text, flags=re.M | re.S)
    found, counted = set(re.findall(r"\{#([\w-]+)|<a (?:id|name)=\"([\w-]+)\"", text)), {}
    found = {one or other for one, other in found}
    for heading in re.findall(r"^#{1,6} +(.*?)[ #]*$", text, re.M):
        heading = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"\{#.*\}$", "", heading))
        name = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        counted[name] = counted.get(name, -1) + 1
        found.add(f"{name}-{counted[name]}" if counted[name] else name)
    return found


def links_of(text: str) -> list:
    text = without_code(text)
    return re.findall(r"\]\(<?([^)\s>]+)>?(?: +\"[^\"]*\")?\)", text) + re.findall(r"^\[[^\]]+\]: *(\S+)", text, re.M) + \
        re.findall(r"(?:href|src)=\"([^\"]+)\"", text)


def faults_of(file: Path, source: Path) -> list:
    faults = []
    for link in links_of(file.read_text(encoding="utf-8")):
        if re.match(r"[a-z][a-z0-9+.-]*:", link):
            continue
        path, _, anchor = unquote(link).partition("#")
        target = (file.parent / path).resolve() if path else file
        if not target.is_relative_to(source) or not target.exists():
            faults.append(f"{file.relative_to(source)}: {link}: there is no such file")
        elif anchor and target.suffix == ".md" and anchor not in anchors_of(target.read_text(encoding="utf-8")):
            faults.append(f"{file.relative_to(source)}: {link}: there is no such heading")
    return faults


def pages(source: Path) -> list:
    found = []
    for folder, folders, files in os.walk(source):
        folders[:] = [name for name in folders if not name.startswith(".") and not (Path(folder) / name / "CMakeCache.txt").exists()]
        found += [Path(folder) / name for name in files if name.endswith(".md")]
    return [page for page in sorted(found) if page.parent != source / "paper/report"]


def main() -> int:
    source = Path(sys.argv[1]).resolve()
    found = pages(source)
    links = sum(len(links_of(page.read_text(encoding="utf-8"))) for page in found)
    faults = [fault for page in found for fault in faults_of(page, source)]
    print("\n".join(faults + [f"{len(found)} files, {links} links, {len(faults)} faults"]))
    return 1 if faults or links < 50 else 0


if __name__ == "__main__":
    sys.exit(main())
