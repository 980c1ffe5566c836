#!/usr/bin/env python3
"""Writes damper.html, a damper to play with, and own.html, the form for one's own damper, into the folder WASM, from what is
built there: pages.py WASM. Each is one file that asks for nothing outside."""
import base64
import gzip
import json
import re
import sys
from html import escape
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[2]


def text(*names: str) -> str:
    return "".join((HERE / name).read_text(encoding="utf-8") for name in names)


def packed(content: bytes) -> str:
    return base64.b64encode(gzip.compress(content, mtime=0)).decode()


def damper_pieces(wasm: Path = None, module: str = "impact-damper.wasm") -> dict:
    """What a page with a damper holds, also the report's, from what is built in a folder; without it the page's places for a
    damper stay empty. Friction, weight and drag need the larger module."""
    # Opened from a folder, a browser starts no worker that has imports and exports.
    worker = text("unpacked.js") + re.sub("^export ", "", text("../package/simulator.js"), flags=re.M) + text("worker.js")
    content = packed((wasm / "package" / module).read_bytes()) if wasm else ""
    return {"style": text("damper.css"), "module": content, "worker": worker, "script": text("page.js", "damper.js")}


def project_pieces(wasm: Path = None, commands: Path = None) -> dict:
    """The program in a page, likewise, and what it makes the report's tables and verdicts from; `commands` is
    build/commands.json, without which the page can have none of them made."""
    pieces = {"program": "", "archive": "", "worker": "", "script": text("check.js", "own.js"), "style": text("project.css")}
    if not wasm:
        return pieces
    sources = [] if not commands else [*(SOURCE / "data/scenes").glob("*.json"), *(SOURCE / "figures").glob("*.json"), SOURCE / "data/claims.json"]
    archive = {"files": {str(file.relative_to(SOURCE)): file.read_text(encoding="utf-8") for file in sorted(sources)},
               "commands": json.loads(commands.read_text(encoding="utf-8")) if commands else []}
    start_code = (wasm / "program/impact-damper.js").read_text(encoding="utf-8")
    return pieces | {"program": packed((wasm / "program/impact-damper.wasm").read_bytes()), "worker": text("unpacked.js") + start_code + text("project.js"),
                     "archive": packed(json.dumps(archive, ensure_ascii=False).encode())}


def own_html() -> str:
    """The first scene of the form for one's own damper, for an attribute."""
    scene = json.loads((SOURCE / "data/examples/mast.json").read_text(encoding="utf-8"))
    del scene["description"]  # it would be none of what the form is filled with
    return escape(json.dumps({"name": "mast", "scene": scene}, ensure_ascii=False))


def main(wasm: Path):
    own = project_pieces(wasm)
    own |= {"own": own_html(), "script": text("page.js") + own["script"]}
    for page, parts in (("damper.html", damper_pieces(wasm, "impact-damper-lists.wasm")), ("own.html", own)):
        whole = re.sub("@([a-z]+)@", lambda found: parts[found[1]], text(page))
        (wasm / page).write_text(whole, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
