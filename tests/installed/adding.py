#!/usr/bin/env python3
"""docs/adding.md as it stands: its files are written, its commands run, with the installed program.

    adding.py PREFIX SOURCE FOLDER
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

PREFIX, SOURCE, FOLDER = (Path(each).resolve() for each in sys.argv[1:4])
PARTS = PREFIX / "share/impact-damper/figures"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)


def demand(holds: bool, what):
    if not holds:
        sys.exit(f"adding.py: {what}")


def shell(script: str):
    environment = dict(os.environ, PATH=f"{PREFIX / 'bin'}:{os.environ['PATH']}")
    return subprocess.run(["sh", "-euc", script], cwd=FOLDER, env=environment, capture_output=True, text=True)


page = (SOURCE / "docs/adding.md").read_text(encoding="utf-8")
shutil.rmtree(FOLDER, ignore_errors=True)
FOLDER.mkdir(parents=True)
commands, end = "", 0
for block in BLOCK.finditer(page):
    if block[1] == "sh":
        commands += block[2]
    else:
        name = re.findall(r"`(own/\S+)`:\s*$", page[end:block.start()])
        demand(len(name) == 1, f"the file before this is not named: {block[2]}")
        file = FOLDER / name[0]
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(block[2], encoding="utf-8")
    end = block.end()
demand(commands.startswith("parts=/usr/local/share/impact-damper/figures\n"), commands)
commands = commands.replace("/usr/local", str(PREFIX), 1)

done = shell(commands)
demand(done.returncode == 0 and not done.stderr, done.stderr + done.stdout)
demand("1 claims of the paper: 1 reproduced" in done.stdout and "all as recorded" in done.stdout, done.stdout)
picture = (FOLDER / "own/fig16.svg").read_text(encoding="utf-8")
for text in ("Loss factor with a mass ratio of 8 %", "ν = 8 %", "loss factor η", "closed forms"):
    demand(text in picture, f"the picture does not say {text}")
for form in ("pdf", "png"):
    demand((FOLDER / f"own/fig16.{form}").stat().st_size > 5000, form)

# What goes wrong first, with somebody's own figure.
draw = "own/fig16.dat Title own/other 0.1.0"
done = shell(f"{PARTS}/draw {PARTS}/fig08.gp {draw}")
demand(done.returncode == 1 and done.stderr == "other: own/fig16.dat: gnuplot failed: block curve-2 is not in the table\n", done.stderr)
(FOLDER / "own/missing.gp").write_text('load folder."/mising.gp"\n')
done = shell(f"{PARTS}/draw own/missing.gp {draw}")
demand(done.returncode == 1 and f"{PARTS}/mising.gp" in done.stderr and done.stderr.count("\n") < 6, done.stderr)
done = shell(f"{PARTS}/draw own/none.gp {draw}")
demand(done.returncode == 1 and done.stderr == "other: own/none.gp: is missing or empty\n", done.stderr)
demand(not list((FOLDER / "own").glob("other*")), "a failed drawing leaves files")

# A scene that no figure draws.
catalogue = (FOLDER / "own/catalogue.json").read_text(encoding="utf-8")
idle = catalogue.replace('"scenes": [', '"scenes": [{"scene": "idle", "record": ["half_cycles"]}, ')
(FOLDER / "own/catalogue.json").write_text(idle, encoding="utf-8")
done = shell("impact-damper figures own/catalogue.json && impact-damper check catalogue own/catalogue.json")
demand(done.returncode == 0 and idle != catalogue, done.stderr)
