"""From a picture back to its data: what `impact-damper cite` says of every stamp is held against the files themselves,
and the commands that it prints are run and make the same picture again.

    leads_back.py PROGRAM FOLDER NEW      NEW like the source folder, by paper/refresh
"""
import hashlib
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import trial
from trial import demand, finish, folder, program, run, source

sys.path.insert(0, str(source / "tests/nothing_lost"))
from scratch import make_tree  # noqa: E402

new = Path(trial.words[0])
MANIFEST = new / "data/reference/manifest.json"

def cite(*typed) -> str:
    done = run(program, "cite", "--manifest", MANIFEST, *typed)
    demand(not done.stderr, f"cite {typed}: {done.stderr}")
    return done.stdout


def rows(text: str, label: str) -> list:
    """What stands beside a label of the comment, line by line."""
    found, inside = [], False
    for line in text.splitlines():
        if re.match(r"%   \S", line):
            inside = line[4:13].strip() == label
        elif not line.startswith("%    "):
            inside = False
        if inside:
            found.append(line[13:])
    return found


def commands(text: str) -> list:
    return [line.split(" ") for line in rows(text, "made by")]


def sum_of(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def git(*arguments, content: bytes = None) -> str:
    """What git says; nothing without a repository of this project."""
    done = subprocess.run(["git", "-C", source, *arguments], input=content, capture_output=True)
    return done.stdout.decode().strip() if done.returncode == 0 else ""


def without_breaks(text: str) -> str:
    return text.replace(r"\allowbreak{}", "")


def said_by_bibtex(text: str, folder: Path) -> str:
    """What BibTeX complains of in an entry, with a style that every installation has; nothing where it is not installed."""
    if not shutil.which("bibtex"):
        return ""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "entry.bib").write_text(text)
    key = re.search(r"^@misc\{([^,]*),", text, re.M)[1]
    (folder / "entry.aux").write_text(f"\\citation{{{key}}}\n\\bibstyle{{plain}}\n\\bibdata{{entry}}\n")
    done = subprocess.run(["bibtex", "entry"], cwd=folder, capture_output=True, text=True)
    printed = re.sub(r"\s+", " ", (folder / "entry.bbl").read_text())
    missing = [part for part in re.findall(r"swh:1:[a-z]+:|version [\d.]+", text) if part not in printed]
    return (done.stdout if done.returncode or "Warning" in done.stdout else "") + "".join(missing)


def bibtex_problems(text: str) -> list:
    """The entry as BibTeX reads it: a type, a key, fields in balanced braces; no @ outside."""
    found = []
    entries = re.split(r"^(?=@)", text, flags=re.M)
    for entry in entries[1:]:
        if not re.match(r"@misc\{[\w.-]+,\n(  [a-z]+ = \{.*\},?\n)+\}\n\Z", entry):
            found.append(f"no entry: {entry}")
        depth = 0
        for brace in re.findall(r"(?<!\\)[{}]", entry):
            depth += 1 if brace == "{" else -1
            if depth < 0:
                found.append(f"braces: {entry}")
        if depth or re.search(r"^  \w+ = .*\}\n  \w+ =", entry, re.M):
            found.append(f"braces or commas: {entry}")
    return found + ["an @ in a comment"] * ("@" in entries[0]) + ["not one entry"] * (len(entries) != 2)


manifest = json.loads(MANIFEST.read_text())
complaint = said_by_bibtex(cite("--figure", "8"), folder.parent / "bibtex")
demand(not complaint, f"BibTeX complains: {complaint}")
# The program knows the commit that it was built at, which need not be today's.
commit = re.search(r"\((.*)\)", trial.call("--version"))[1]
tree = git("rev-parse", f"{commit}^{{tree}}")
demand(f", commit {commit}, \\texttt{{swh:1:dir:{tree}}}}},\n" in without_breaks(cite()) if tree else "swh:1:dir" not in cite(),
       f"commit {commit}, tree {tree}: {cite()}")
version = manifest["software"]["version"]
figures = {figure["figure"]: figure for figure in manifest["figures"]}
demand(set(figures) == {*"ABCDEFGHIJ", *map(str, range(1, 16))}, f"figures {sorted(figures)}")
for number, figure in figures.items():
    table, script = figure["tables"][:1], figure["script"]["file"]
    stamped = new / table[0]["file"] if table else source / script
    stamp = f"{sum_of(stamped)[:8]} · {version}"
    picture = (new / figure["picture"]["file"]).read_text()
    demand(f">{stamp}</text>" in picture, f"figure {number}: its picture does not carry {stamp}")
    text = cite("--figure", number)
    demand(rows(text, "stamp") == [stamp], f"figure {number}: stamp {rows(text, 'stamp')}, wanted {stamp}")
    demand(rows(text, "script") == [script], f"figure {number}: script")
    demand(rows(text, "scenes") == [each["file"] for each in figure["scenes"]], f"figure {number}: scenes")
    demand(not bibtex_problems(text), f"figure {number}: {bibtex_problems(text)}")
    hashed = git("hash-object", "--stdin", content=stamped.read_bytes())
    demand(not hashed or f"swh:1:cnt:{hashed}}}}}\n" in without_breaks(text), f"figure {number}: no SWHID {hashed}")
    for typed in (stamp, stamp.upper(), stamp[:8], stamp[:8].upper(), f" {stamp[:8]}  {version} ", sum_of(stamped)):
        demand(cite("--stamp", typed) == text, f"--stamp {typed!r} does not say what --figure {number} says")
    for other in figure["tables"][1:]:
        text = cite("--stamp", other["sha256"][:8])
        demand(f"% Figure {number} of" in text and f"by the {other['engine']} engine" in text,
               f"figure {number}: {other['engine']}")
demand(bibtex_problems("% a@b\n@misc{a,\n  title = {b}\n  note = {c}\n}\n"), "a faulty entry is not found out")

# As in the folder of the sources: each command that is printed.
tree = make_tree(folder, program)
for typed in (("--figure", "5"), ("--figure", "A"), ("--stamp", figures["5"]["tables"][1]["sha256"][:8])):
    text = cite(*typed)
    for command in commands(text):
        run(*command)
    [name] = rows(text, "picture")
    made = tree / "build/figures" / Path(name).name if name.startswith("data/") else tree / name
    demand(f">{rows(text, 'stamp')[0]}</text>" in (made.read_text() if made.exists() else ""), f"{made}: its stamp")
    if name.startswith("data/"):
        demand(made.exists() and made.read_bytes() == (new / name).read_bytes(), f"{name} is not made again")
demand(not list(tree.glob("build/figures/fig08.*")), "more than the figure asked for is made")

finish(f"{len(figures)} figures, ")
