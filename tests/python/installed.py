"""The Python module is installed where the Python that runs this looks for modules by itself; where it does not look, the
installation says what has it found.

    installed.py BUILD FOLDER VERSION
"""
import os
import re
import sys

import trial
from trial import demand, finish, folder, run

USE = "import impact_damper as d; d.run(until_time=5).text(); print(d.__version__, d.__file__.rpartition('/')[0])"


def python(code: str, **environment) -> str:
    """What this Python prints, started elsewhere, as by somebody who has set nothing else."""
    return run(sys.executable, "-B", "-c", code, cwd="/", env=environment).stdout


def install(prefix: str, **environment) -> str:
    """Installs the module alone; standard error."""
    return run("cmake", "--install", trial.program, "--prefix", prefix, "--component", "python", env=dict(os.environ, **environment)).stderr


searched = python("import sys; print(*sys.path, sep='\\n')").splitlines()
prefixes = {prefix for prefix in (sys.prefix, "/usr/local") if any(each.startswith(f"{prefix}/lib") for each in searched)}
demand(sys.prefix in prefixes, searched)
for number, prefix in enumerate(sorted(prefixes)):
    root = folder / str(number)
    said = install(prefix, DESTDIR=str(root))
    files = [str(file.relative_to(root).parent) for file in root.rglob("*") if file.is_file()]
    demand(len(files) == 1 and f"/{files[0]}" in searched, f"{files} under {prefix}, this Python looks in {searched}")
    demand(f"/{files[0]}".startswith(f"{prefix}/lib") and not said, said)
    there = f"{root}/{files[0]}"
    demand(python(USE, PYTHONPATH=there).split() == [trial.words[0], there], "another module")

said = install(str(folder / "it"))
told = re.fullmatch(r"The Python module is in (\S+), where \S+ does not look by itself: set (PYTHONPATH)=(\1)\n", said)
demand(told and python(USE, PYTHONPATH=told[3]).split() == [trial.words[0], told[1]], said)
finish()
