#!/usr/bin/env python3
"""The Python module is installed where the Python that runs this looks for modules by itself; where it does not look, the
installation says what has it found.

    installed.py BUILD VERSION FOLDER
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

BUILD, VERSION, FOLDER = sys.argv[1:3] + [Path(sys.argv[3])]
USE = "import impact_damper as d; d.run(until_time=5).text(); print(d.__version__, d.__file__.rpartition('/')[0])"


def demand(holds: bool, what):
    if not holds:
        sys.exit(f"installed.py: {what}")


def python(code: str, **environment) -> str:
    """What this Python prints, started elsewhere, as by somebody who has set nothing else."""
    return subprocess.run([sys.executable, "-B", "-c", code], cwd="/", env=environment, check=True, capture_output=True,
                          text=True).stdout


def install(prefix: str, **environment) -> str:
    """Installs the module alone; standard error."""
    return subprocess.run(["cmake", "--install", BUILD, "--prefix", prefix, "--component", "python"], check=True,
                          capture_output=True, text=True, env=dict(os.environ, **environment)).stderr


shutil.rmtree(FOLDER, ignore_errors=True)
searched = python("import sys; print(*sys.path, sep='\\n')").splitlines()
prefixes = {prefix for prefix in (sys.prefix, "/usr/local") if any(each.startswith(f"{prefix}/lib") for each in searched)}
demand(sys.prefix in prefixes, searched)
for number, prefix in enumerate(sorted(prefixes)):
    root = FOLDER / str(number)
    said = install(prefix, DESTDIR=str(root))
    files = [str(file.relative_to(root).parent) for file in root.rglob("*") if file.is_file()]
    demand(len(files) == 1 and f"/{files[0]}" in searched, f"{files} under {prefix}, this Python looks in {searched}")
    demand(f"/{files[0]}".startswith(f"{prefix}/lib") and not said, said)
    there = f"{root}/{files[0]}"
    demand(python(USE, PYTHONPATH=there).split() == [VERSION, there], "another module")

said = install(str(FOLDER / "it"))
told = re.fullmatch(r"The Python module is in (\S+), where \S+ does not look by itself: set (PYTHONPATH)=(\1)\n", said)
demand(told and python(USE, PYTHONPATH=told[3]).split() == [VERSION, told[1]], said)
