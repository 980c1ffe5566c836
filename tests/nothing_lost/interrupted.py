"""Ctrl-C: run, series, verify with threads, and `make figures`.

Exit code 130, one line on stderr that says what is left, nothing partial and nothing unfinished; and what was
interrupted goes on to the same bytes. Then two and three `make figures` at once in one tree, and whatever else works in
build/ while another make does.
"""

import fcntl
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import scratch
from trial import demand, finish, folder, program


def catches_interrupts(process):
    """Whether the program has got so far as to say something when it is interrupted."""
    try:
        for line in Path(f"/proc/{process.pid}/status").read_text().splitlines():
            if line.startswith("SigCgt:"):
                return bool(int(line.split()[1], 16) & (1 << (signal.SIGINT - 1)))
    except OSError:
        pass
    return False


def interrupt(name, command, here, files, code, wait):
    """After a time `wait`, with the signal `code`. Returns whether it was met alive."""
    before = {file: (here / file).read_bytes() if (here / file).exists() else None for file in files}
    process = subprocess.Popen(command, cwd=here, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               env=scratch.ENVIRONMENT)
    while process.poll() is None and not catches_interrupts(process):
        pass
    time.sleep(wait)
    process.send_signal(code)
    _, error = process.communicate()
    demand(not scratch.unfinished_in(here), f"{name}: unfinished files remain: {scratch.unfinished_in(here)}")
    if process.returncode in (0, 1):  # done before
        return False
    lines = scratch.complaints(error)
    demand(process.returncode == 128 + code, f"{name}: exit code {process.returncode}: {error}")
    demand(len(lines) == 1 and lines[0].startswith("impact-damper: interrupted: "), f"{name}: says {error!r}")
    whole = {file for file in files if (here / file).exists() and before[file] is None}
    return not whole or name == "series"


PROGRAMS, MAKES = ["run", "ensemble", "series", "verify"], ["make", "makes"]


def programs(options, tree, moments):
    runs, catalogue = str(tree / "build" / "runs" / "exact"), str(tree / "figures" / "catalogue.json")
    claims, scenes = str(tree / "data" / "claims.json"), str(tree / "data" / "scenes")
    commands = {
        "run": ([program, "run", "--engine", "cem", "--time-step", "1e-9", "--until-time", "10", "-o", "out.json"],
                ["out.json"]),
        "ensemble": ([program, "run", "--engine", "cem", "--until-amplitude", "5", "--members", "100", "--threads", "4",
                      "-o", "out.json"], ["out.json"]),
        "series": ([program, "series", "--catalogue", catalogue, "--runs", runs, "--scenes", scenes,
                    "--threads", "4", "-o", "."], []),
        "verify": ([program, "verify", "--claims", claims, "--catalogue", catalogue, "--runs", runs, "--scenes", scenes,
                    "--threads", "4", "-o", "verdicts.json"], ["verdicts.json"]),
    }
    for name, (command, files) in commands.items():
        if name not in options.parts:
            continue
        here = scratch.make_folder(folder / name)
        met = 0
        for code in [signal.SIGINT] * 6 + [signal.SIGTERM, signal.SIGHUP]:
            longest = 0.02 if name == "series" else 0.25
            met += interrupt(name, command, here, files, code, moments.uniform(0, longest))
            demand(all(not (here / file).exists() for file in files), f"{name}: a file was written all the same")
            for file in files:
                (here / file).unlink(missing_ok=True)
        print(f"{name}: {met} of 8 interrupts met it alive")
        demand(met > 0, f"{name} was never met alive")


def make_interrupted(tree, wanted, moments):
    """The terminal's Ctrl-C reaches make, its shell, CMake and ninja, which ends what it began."""
    for file in (tree / "build" / "figures").glob("*.*"):
        file.unlink()
    begun = moments.randint(0, 2)
    make = subprocess.Popen(["make", "figures"], cwd=tree, env=scratch.ENVIRONMENT, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True)
    while make.poll() is None and len(list((tree / "build" / "figures").glob("*.svg"))) < begun:
        time.sleep(0.001)
    time.sleep(moments.uniform(0.05, 0.15))
    os.killpg(make.pid, signal.SIGINT)
    text, _ = make.communicate()
    # Make ends itself by the signal, which a shell reports as 130.
    demand(make.returncode in (130, -signal.SIGINT), f"make figures: exit code {make.returncode}: {text}")
    demand("make figures: interrupted, at most " in text, f"make figures: says {text!r}")
    for file, content in scratch.made_in(tree).items():
        demand(content == wanted[file], f"make figures: {file} is partial after an interrupt")
    demand(not scratch.unfinished_in(tree), f"make figures: unfinished: {scratch.unfinished_in(tree)}")
    again = scratch.make(tree, "figures")
    demand(again.returncode == 0 and scratch.made_in(tree) == wanted, "make figures does not go on to the same bytes")


def makes_at_once(figures, wanted, count):
    tree = scratch.make_tree(folder / "crowded", program, figures)
    makes = [subprocess.Popen(["make", "figures"], cwd=tree, env=scratch.ENVIRONMENT, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT) for _ in range(count)]
    texts = [make.communicate()[0] for make in makes]
    for make, text in zip(makes, texts):
        demand(make.returncode == 0, f"{count} makes at once: {text}")
    waited = sum("waiting for another make in this folder to end" in text for text in texts)
    demand(waited >= count - 1, f"{count} makes at once: {waited} waited and said so")
    made = scratch.made_in(tree)
    demand(sum(file.endswith(".svg") for file in made) == len(figures), f"{count} makes at once: only {sorted(made)}")
    for file, content in made.items():
        demand(content == wanted[file], f"{count} makes at once: {file} has other bytes")
    demand(not scratch.unfinished_in(tree), "makes at once: unfinished files remain")


def all_wait(tree):
    """Whatever works in build/ waits for the lock on the folder, which is held here."""
    makefile = (tree / "Makefile").read_text().replace("\\\n", " ")
    targets = set(re.search(r"^\.PHONY:(.*)", makefile, re.M)[1].split())
    targets -= {name for name in targets if name.split("-")[0] == "deps"}  # these work elsewhere, at least at first
    targets -= {"help", "check", "check-all", "archive"}  # these call others
    lock = os.open(tree, os.O_RDONLY)
    fcntl.flock(lock, fcntl.LOCK_EX)
    for target in sorted(targets):
        ready = [word for each in {"bench", "sanitize", "paper", "wasm"} - {target} for word in ("-o", each)]
        with subprocess.Popen(["make", *ready, target], cwd=tree, env=scratch.ENVIRONMENT, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True) as process:
            said = process.stdout.readline()
            os.killpg(process.pid, signal.SIGKILL)
        demand(said == f"make {target}: waiting for another make in this folder to end\n",
               f"make {target}: says {said!r}")
    os.close(lock)
    print(f"{len(targets)} targets wait for one another")


def main():
    parser = scratch.arguments(__doc__)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--figures", nargs="*", default=["5", "7", "8", "9", "10", "13"])
    parser.add_argument("--parts", nargs="*", default=PROGRAMS + MAKES, choices=PROGRAMS + MAKES)
    options = parser.parse_args()
    seed = options.seed if options.seed is not None else random.SystemRandom().randrange(2**32)
    print(f"seed {seed}", flush=True)
    moments = random.Random(seed)
    scratch.count_lines_in(folder)
    tree = scratch.make_tree(folder / "tree", program, options.figures)
    if not set(options.parts) <= {"run", "ensemble"}:
        first = scratch.make(tree, "figures")
        ensembles = subprocess.run(["cmake", "--build", "build", "--target", "runs-exact"], cwd=tree, capture_output=True)
        if first.returncode != 0 or ensembles.returncode != 0:
            sys.exit(f"{first} {ensembles}")
    wanted = scratch.made_in(tree)
    programs(options, tree, moments)
    if "make" in options.parts:
        for _ in range(3):
            make_interrupted(tree, wanted, moments)
    if "makes" in options.parts:
        for count in (2, 3):
            makes_at_once(options.figures[:2], wanted, count)
        all_wait(tree)
    finish("interrupts and makes at once, ")


if __name__ == "__main__":
    main()
