#!/usr/bin/env python3
"""examples/cluster/parallel makes the table that one process makes, on this machine and on two others, one of which dies.

The other machines are folders: instead of ssh a script runs here, in such a folder, what ssh would run there.
Exit code 1: faults, or GNU parallel or rsync is not here.
"""
import contextlib
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

from trial import demand, finish, folder, program, run, source, write

missing = [each for each in ("parallel", "rsync") if not shutil.which(each)]
if missing:
    sys.exit(f"{' and '.join(missing)} missing: make deps-cluster cluster-check")

SSH = """#!/bin/sh
# ssh [OPTION...] [USER@]HOST [--] COMMAND...
while :; do case $1 in -l) shift 2 ;; -*) shift ;; *) break ;; esac; done
cd "$MACHINES/${1#*@}" 2>/dev/null || exit 255
export HOME="$PWD" SHELL=/bin/sh
shift
[ "$1" != -- ] || shift
exec sh -c "$*"
"""
plan = {"schema": "impact-damper/plan/1", "scene_file": "scene.json",
        "grid": [{"number": "restitution", "from": 0.4, "to": 0.8, "count": 1000}],
        "quantities": ["time_to_amplitude=0.6", "impact_energy_share"]}
work, machines = folder / "work", folder / "machines"
for each in (work, machines / "near", machines / "far", folder / "home"):
    each.mkdir(parents=True)
write("work/plan.json", plan)
write("work/scene.json", {"mass_ratio": 0.02, "until_amplitude": 0.03})
(folder / "ssh").write_text(SSH)
(folder / "ssh").chmod(0o755)
environment = {**os.environ, "IMPACT_DAMPER": str(program), "MACHINES": str(machines), "PARALLEL_SSH": str(folder / "ssh"),
               "HOME": str(folder / "home"), "PARALLEL_HOME": str(folder / "home")}


def start(table, on):
    (work / "machines").write_text("".join(f"{each}\n" for each in on))
    return subprocess.Popen([source / "examples/cluster/parallel", "plan.json", table, "6", "machines", "scene.json"], cwd=work,
                            env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def end(process, code, expected):
    said = process.communicate(timeout=300)[0]
    demand(process.returncode == code and expected in said, f"exit code {process.returncode}: {said}")


def demand_equal(table):
    for name in (table, table + ".json"):
        serial = work / name.replace(table, "serial.csv")
        demand((work / name).exists() and (work / name).read_bytes() == serial.read_bytes(), f"{name} is not {serial.name}")
    left = [each for machine in machines.iterdir() for each in machine.rglob("*") if each.is_file()]
    demand(not left, f"{table}: left behind: {left}")


def processes_in(place):
    found = []
    for link in pathlib.Path("/proc").glob("[0-9]*/cwd"):
        with contextlib.suppress(OSError):
            if pathlib.Path(os.readlink(link)).is_relative_to(place):
                found.append(int(link.parent.name))
    return found


def lose(machine):
    """Once the program works there: what runs there ends, and nothing can be reached."""
    until = time.monotonic() + 60
    while not list((machines / machine).rglob("*.part-*")) and time.monotonic() < until:
        time.sleep(0.02)
    lost = list((machines / machine).rglob("*.part-*"))
    demand(lost, f"{machine} got no part")
    (machines / machine).rename(folder / f"{machine}-dead")
    for pid in processes_in(folder / f"{machine}-dead"):
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


run(program, "sweep", "plan.json", "-o", "serial.csv", cwd=work)

end(start("here.csv", ["2/:"]), 0, "here.csv is written")
demand_equal("here.csv")

process = start("several.csv", ["1/:", "1/user@near", "1/far"])
lose("far")
end(process, 0, "several.csv is written")
demand_equal("several.csv")

# Without any machine no table, and with one again the same command makes what is missing.
process = start("again.csv", ["2/near"])
lose("near")
end(process, 2, "the same command again makes what is missing")
demand(not (work / "again.csv").exists(), "a table without all parts")
(machines / "near").mkdir()
end(start("again.csv", ["2/near"]), 0, "again.csv is written")
demand_equal("again.csv")

# Another plan is not mixed with the parts that are there.
write("work/plan.json", {**plan, "quantities": ["impacts"]})
end(start("again.csv", ["2/near"]), 2, "holds runs of another plan, part or program")

finish()
