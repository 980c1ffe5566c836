"""What the tests of this folder share: a tree to work in.

A scratch tree is the project as far as `make figures` and `make verify` go: its Makefile, figures/, data/ and the
program as it is built, but no sources. What is made there is made by the project's own rules.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]

VERSION = re.search(r"project\(impact-damper VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]
CMAKE_LISTS = f"""cmake_minimum_required(VERSION 3.25)
project(scratch VERSION {VERSION} LANGUAGES NONE)
add_executable(impact-damper IMPORTED GLOBAL)
set_target_properties(impact-damper PROPERTIES IMPORTED_LOCATION "${{PROJECT_BINARY_DIR}}/src/impact-damper")
add_subdirectory(figures ${{PROJECT_BINARY_DIR}}/figure-rules)
"""
# A make above this one shall not tell those below what to do.
ENVIRONMENT = {name: value for name, value in os.environ.items()
               if name not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS", "CMAKE_BUILD_PARALLEL_LEVEL")}


def arguments(description):
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("program", help="impact-damper as it is built")
    parser.add_argument("folder", help="to work in; it is made anew")
    return parser


def count_lines_in(folder):
    """Where the program counts the lines it runs (tests/checks/coverage): one that is killed as it writes its counts
    leaves a file that every later program complains of on stderr. So it is none of the build's."""
    ENVIRONMENT["GCOV_PREFIX"] = str(folder / "counts")


def make_folder(folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder.resolve()


def make_tree(folder, program, figures=None):
    """A scratch tree with the catalogue's figures of these numbers, or with all; nothing is made in it yet."""
    make_folder(folder)
    (folder / "CMakeLists.txt").write_text(CMAKE_LISTS)
    for name in ("Makefile", "CMakePresets.json"):
        shutil.copy(SOURCE / name, folder)
    for name in ("figures", "data"):
        shutil.copytree(SOURCE / name, folder / name)
    if figures:
        file = folder / "figures" / "catalogue.json"
        catalogue = json.loads(file.read_text())
        catalogue["figures"] = [each for each in catalogue["figures"] if each["figure"] in figures]
        drawn = {curve["scene"] for each in catalogue["figures"] for curve in each.get("curves", [])}
        others = {each["scene"] for each in catalogue["scenes"]} - drawn  # not those that are of no list
        for runs in ("scenes", "runs", "responses"):
            catalogue[runs] = [each for each in catalogue[runs] if each["scene"] not in others]
        file.write_text(json.dumps(catalogue))
    (folder / "build" / "src").mkdir(parents=True)
    shutil.copy(program, folder / "build" / "src" / "impact-damper")
    return folder


def make(tree, *targets, **more):
    return subprocess.run(["make", "--no-print-directory", *targets], cwd=tree, env=ENVIRONMENT, text=True,
                          capture_output=True, **more)


def made_in(tree):
    """What stands under final names in a tree: runs and the members of their ensembles, tables, figures, verdicts."""
    files = {}
    for pattern in ("runs/*/*.json", "runs/*/*.members/*.json", "series/*/*.dat", "figures/*.*", "verdicts-*.json"):
        for file in (tree / "build").glob(pattern):
            if not file.name.startswith("."):
                files[str(file.relative_to(tree))] = file.read_bytes()
    return files


def may_mount():
    """Whether this process may mount disks, in a mount namespace of its own. An ordinary container's may not."""
    return bool(shutil.which("unshare")) and subprocess.run(
        ["unshare", "-m", "sh", "-c", "mount -t tmpfs none /mnt"], capture_output=True).returncode == 0


def unfinished_in(folder):
    """Temporary files and folders of the program and of figures/draw."""
    return sorted(os.path.join(place, name) for place, folders, files in os.walk(folder) for name in folders + files
                  if name.startswith(".") and name.endswith((".tmp", ".draw")))


def complaints(error: str):
    """The lines on stderr but for progress, which a program tells where it takes longer than ten seconds, and for
    complaints about counts of lines that another interrupt has cut off."""
    return [line for line in error.splitlines() if not line.startswith(("report: ", "verify: ", "profiling: "))]
