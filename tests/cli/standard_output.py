"""With the name - a command writes to its standard output what it otherwise writes to a file, and nothing else.

    standard_output.py PROGRAM SOURCE FOLDER        FOLDER, made anew, is for the files
"""
import pathlib
import shutil
import subprocess
import sys

from trial import demand, finish, folder, program, source

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from packed_files import unpack  # noqa: E402

unpack(source / "tests/cli/files.packed", folder)


def call(*words):
    done = subprocess.run([str(program), *map(str, words)], cwd=folder, capture_output=True, text=True)
    demand(done.returncode in (0, 1), f"{words}: exit code {done.returncode}: {done.stderr}")  # 1: a check failed, and all is written
    return done.stdout


forced = ["--mass-ratio", 0.1, "--force-amplitude", 0.05, "--max-periods", 50]
quick = ["--scene", "mast.json", "--to", 30, "--within", 5, "--share", 0.5, "--neighbours", 100, "--clearance", "20:21",
         "--tolerance", "restitution=0.2", "--engine", "restitution"]
call("sweep", "--until-time", 20, "--vary", "x0=1,2", "--vary", "restitution=0.4,0.6", "--keep", "impacts", "-o", "map.csv")
commands = [
    (["run", "--until-time", 5], "--output", "run.json"),
    (["run", "--until-time", 5, "--format", "csv"], "--output", "run.csv"),
    (["report", "--until-time", 20, "--members", 2, "--without-figures"], "--output", "page.html"),
    (["response", "sweep", *forced, "--vary", "force_frequency=0.9:1.1:2"], "--output", "sweep.json"),
    (["series", "--catalogue", "figures.json", "--runs", "runs", "--figure", 8], "--output", "fig08.dat"),
    (["design", "--scene", "mast.json", "--to", 10, "--dampers", 1], "--output", "boxes.json"),
    (["design", *quick], "--output", "designs.json"),
    (["design", *quick], "--write-plan", "plan.json"),
    (["verify", "--claims", "claims.json"], "--output", "verdicts.json"),
    (["verify", "--claims", "claims.json"], "--markdown", "verdicts.md"),
]
if shutil.which("gnuplot"):
    commands.append((["map", "map.csv", "--x", "x0", "--y", "restitution", "--z", "impacts"], "--output", "map.svg"))
for words, option, file in commands:
    call(*words, option, file)
    made = (folder / file).read_text(encoding="utf-8") if (folder / file).exists() else None
    there = sorted(folder.rglob("*"))
    printed = call(*words, option, "-")
    demand(printed == made, f"{words} {option} -: {printed[:300]!r}, not {made and made[:300]!r}")
    demand(sorted(folder.rglob("*")) == there, f"{words} {option} -: files {set(folder.rglob('*')) - set(there)}")
finish()
