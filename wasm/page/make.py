#!/usr/bin/env python3
"""Writes the page with the damper to play with, one file that asks for nothing outside: make.py PACKAGE PAGE"""
import base64
import gzip
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def text(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


def main(package: Path, page: Path):
    parts = {
        "style": text("damper.css"),
        "module": base64.b64encode(gzip.compress((package / "impact-damper.wasm").read_bytes(), mtime=0)).decode(),
        # Opened from a folder, a browser starts no worker that is a module.
        "worker": re.sub("^export ", "", (package / "simulator.js").read_text(encoding="utf-8"), flags=re.M) + text("worker.js"),
        "script": text("damper.js") + text("start.js"),
    }
    for name, part in parts.items():
        if "</script" in part:
            raise ValueError(f"{name}: holds the end of a script")
    page.write_text(re.sub("@(style|module|worker|script)@", lambda found: parts[found[1]], text("damper.html")), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
