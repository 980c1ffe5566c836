#!/usr/bin/env python3
"""Writes the page with the damper to play with, one file that asks for nothing outside: damper_page.py MODULE PAGE"""
import base64
import gzip
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


def text(*names: str) -> str:
    return "".join((HERE / name).read_text(encoding="utf-8") for name in names)


def pieces(module: Path = None) -> dict:
    """What a page with a damper holds, also the report's; without a module its places for a damper stay empty."""
    packed = base64.b64encode(gzip.compress(module.read_bytes(), mtime=0)).decode() if module else ""
    # Opened from a folder, a browser starts no worker that has imports and exports.
    worker = re.sub("^export ", "", text("../package/simulator.js"), flags=re.M) + text("worker.js")
    return {"style": text("damper.css"), "module": packed, "worker": worker, "script": text("damper.js", "start.js")}


def main(module: Path, page: Path):
    parts = pieces(module)
    page.write_text(re.sub("@(style|module|worker|script)@", lambda found: parts[found[1]], text("damper.html")), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
