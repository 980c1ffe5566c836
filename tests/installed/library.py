"""The installed library, used as a stranger uses it: by find_package and by pkg-config, without the source folder.

    library.py PROGRAM FOLDER COMPILER

PROGRAM is where it was installed, under a DESTDIR: not where it was meant to be, so a path that was written down leads
nowhere. examples/ must print what their README.md shows; an engine that is compiled by the stranger must give the
program's bytes, also for a processor with fused multiply-add; no compilation may read Eigen or nlohmann-json.
"""
import itertools
import os
import re
import shutil
from pathlib import Path

import trial
from trial import call, demand, finish, folder, program, skip, source, words

PREFIX, COMPILER = program.parents[1], words[0]
QUICK = ["-O1"]
# With all instructions that this processor has. g++ fuses products with sums from -O2 on, unless the package's options
# forbid it.
FUSING = ["-O2", "-march=native"]
STRANGER = """cmake_minimum_required(VERSION 3.16)
project(stranger LANGUAGES CXX)
find_package(impact_damper 0.1 REQUIRED)
add_executable(columns columns.cpp)
target_link_libraries(columns PRIVATE impact_damper::impact_damper)
"""
PRIVATE = re.compile(r"eigen3?/|nlohmann", re.I)
# Name of an example -> what it prints.
SHOWN = dict(re.findall(r"^## \[(\S+)\]\S+\n\n```text\n(.*?)```$", (source / "examples/README.md").read_text(), re.M | re.S))


def run(*command, **options) -> str:
    done = trial.run(*command, **options)
    demand(not done.stderr, f"{command}: {done.stderr}")
    return done.stdout


def built(name: str, sources: Path, flags: list) -> Path:
    """A project as its folder alone, configured, built; nothing it was compiled from is another package's."""
    shutil.copytree(sources, folder / name / "source")
    build = folder / name / "build"
    run("cmake", "-S", folder / name / "source", "-B", build, "-G", "Ninja", f"-DCMAKE_CXX_COMPILER={COMPILER}",
        "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_CXX_FLAGS_RELEASE={' '.join(flags)}", f"-DCMAKE_PREFIX_PATH={PREFIX}",
        "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON")
    run("cmake", "--build", build)
    commands = (build / "compile_commands.json").read_text()
    demand(str(PREFIX / "include") in commands, f"{name}: not compiled with the installed headers")
    demand(not PRIVATE.search(commands) and not re.search(r"-W[a-z]|-DEIGEN|-I\S*/src\b", commands), commands)
    read = run("ninja", "-C", build, "-t", "deps")
    demand("impact_damper/run.hpp" in read and not PRIVATE.search(read) and f"{source}/src" not in read, read)
    return build


def the_examples_print_what_is_shown():
    build = built("examples", source / "examples", QUICK)
    sources = sorted((source / "examples").glob("*.c*"))
    demand(len(sources) >= 4, sources)
    for file in sources:
        printed = run(build / file.stem)
        demand(printed == SHOWN[file.name], f"{file.stem} prints\n{printed}")
        demand(len(file.read_text().splitlines()) <= 40, f"{file} is no short example")


def an_engine_compiled_here_gives_the_programs_bytes():
    project = folder / "own"
    project.mkdir()
    (project / "CMakeLists.txt").write_text(STRANGER)
    shutil.copy(source / "tests/installed/columns.cpp", project)
    columns = built("stranger", project, FUSING) / "columns"
    scenes = [source / f"tests/same_bits/scenes/{name}.json" for name in ("forced-near-resonance", "dampers-forced")]
    for engine, scene in itertools.product(("exact", "restitution", "cem"), scenes):
        wanted = call("run", "--engine", engine, "--scene", scene, "--history", "0:150:301",
                     "--record", "half_cycles,impacts,contacts,energy,history")
        demand(len(wanted) > 50000 and run(columns, engine, scene) == wanted, f"{engine}, {scene.name}: not the program's bytes")


def pkg_config_is_enough():
    library = next(PREFIX.glob("lib*/**/pkgconfig"))
    environment = dict(os.environ, PKG_CONFIG_PATH=str(library))
    flags, libraries = (run("pkg-config", what, "impact_damper", env=environment).split() for what in ("--cflags", "--libs"))
    demand(not PRIVATE.search(" ".join(flags + libraries)), flags + libraries)
    example, binary = folder / "examples/source/observer", folder / "by_pkg_config"
    # As README.md says, and with the warnings that somebody might have turned on.
    run(COMPILER, *QUICK, "-Wall", "-Wextra", "-Werror", f"{example}.cpp", *flags, *libraries, "-o", binary)
    demand(run(binary) == SHOWN["observer.cpp"], "by pkg-config the example prints something else")
    # Each public header has all that it includes, and no two of them are at odds.
    headers = sorted(str(file.relative_to(PREFIX / "include")) for file in (PREFIX / "include").rglob("*.h*"))
    demand(len(headers) > 40 and not any("json" in name or "reproduction" in name for name in headers), headers)
    every = folder / "every_header.cpp"
    every.write_text("".join(f'#include "{name}"\n' for name in reversed(headers)))
    run(COMPILER, *flags, "-fsyntax-only", every)


def nothing_names_the_build():
    files = [file for file in PREFIX.rglob("*") if file.suffix in (".cmake", ".pc")]
    demand(len(files) >= 5, files)
    for file in files:
        named = re.search(rf"{source}|{PREFIX}|/usr/local|/opt/it", file.read_text())
        demand(not named, f"{file} names {named and named[0]}")


missing = [tool for tool in ("ninja", "pkg-config") if not shutil.which(tool)]
if missing:
    skip(f"for want of {missing}: make deps-check")
nothing_names_the_build()
the_examples_print_what_is_shown()
an_engine_compiled_here_gives_the_programs_bytes()
pkg_config_is_enough()
finish()
