"""Kills run, series, drawing, verify and whole `make figures` at random moments.

After each: no file under its final name is anything but what stood there before or what an undisturbed process
makes. Then the same is done again, undisturbed: it completes, with the same bytes, and nothing that the killed one
left unfinished remains.

Half of the kills come at any time of a process's life; that a machine meets these moments differently each time is
the point of them. The other half meets the writing of a file: the program is stopped at one of the points of it that
hold.cpp knows, and killed there; figures/draw when an unfinished file has been seen. All are drawn from the seed.
"""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import scratch
from processes import adopt_orphans, descendants, end_all, kill
from trial import demand, finish, folder, program


class Victim:
    """A command, and the files that it makes in a folder."""

    def __init__(self, name, command, folder, files):
        self.name, self.command, self.folder, self.files = name, command, folder, files
        self.old = None  # what stands there before
        self.process = None

    def start(self, **environment):
        self.process = subprocess.Popen(self.command, cwd=self.folder, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.PIPE, env={**scratch.ENVIRONMENT, **environment},
                                        start_new_session=True)

    def contents(self):
        return {file: (self.folder / file).read_bytes() if (self.folder / file).exists() else None
                for file in self.files}

    def measure(self):
        """Undisturbed: what it makes and how long it takes."""
        begin = time.monotonic()
        self.start()
        _, error = self.process.communicate()
        if self.process.returncode not in (0, 1):
            sys.exit(f"{self.name}: exit code {self.process.returncode}: {error.decode()}")
        self.duration = time.monotonic() - begin
        self.new = self.contents()

    def put_back(self, old):
        for file, content in old.items():
            if content is None:
                (self.folder / file).unlink(missing_ok=True)
            else:
                (self.folder / file).parent.mkdir(exist_ok=True)
                (self.folder / file).write_bytes(content)


POINTS = 5  # of each file's writing (hold.cpp)


def stop_while_writing(victim, hold, random_moments):
    """Starts the victim and stops it at one of its points. Whether it got there."""
    at = random_moments.randrange(POINTS * len(victim.files))
    victim.start(LD_PRELOAD=str(hold), HOLD_AT=str(at))
    _, status = os.waitpid(victim.process.pid, os.WUNTRACED)
    if not os.WIFSTOPPED(status):
        victim.process.returncode = os.waitstatus_to_exitcode(status)
    return demand(os.WIFSTOPPED(status), f"{victim.name}: not stopped at point {at} of its writing: {status}")


def see_unfinished(victim, random_moments):
    """Waits until the victim has begun so many files. Whether it still lives then."""
    wait = random_moments.choice([0, 0, 0, random_moments.uniform(0, 0.003), random_moments.uniform(0, 0.03)])
    nth = random_moments.randint(1, len(victim.files))
    seen = set()
    while victim.process.poll() is None:
        seen.update(scratch.unfinished_in(victim.folder))
        if len(seen) >= nth:
            time.sleep(wait)
            break
    return victim.process.poll() is None


def kill_once(victim, hold, aimed, random_moments, tally):
    """Aimed at the writing, or at any time."""
    # Where the bytes are there already nothing is written.
    old = {file: random_moments.choice([None, b"old\n"] + [victim.new[file]] * (not aimed)) for file in victim.files}
    victim.put_back(old)
    if aimed and victim.name != "draw":
        alive = stop_while_writing(victim, hold, random_moments)
    else:
        victim.start()
        if aimed:
            alive = see_unfinished(victim, random_moments)
        else:
            time.sleep(random_moments.uniform(0, victim.duration))
            alive = victim.process.poll() is None
    if alive:
        os.killpg(victim.process.pid, signal.SIGKILL)
    end_all()
    victim.process.stderr.close()
    left = scratch.unfinished_in(victim.folder)
    tally["alive"] += alive
    tally["unfinished"] += bool(left)
    for file, content in victim.contents().items():
        demand(content in (old[file], victim.new[file]), f"{victim.name}: {file} is partial after a kill")
    victim.start()
    _, error = victim.process.communicate()
    demand(victim.process.returncode in (0, 1), f"{victim.name}, again: {error.decode()}")
    demand(victim.contents() == victim.new, f"{victim.name}, again: other bytes than undisturbed")
    left = scratch.unfinished_in(victim.folder)
    demand(not left, f"{victim.name}, again: unfinished files remain: {left}")


def kill_make(tree, wanted, random_moments, tally, duration):
    """All that it began, make and ninja alone, or one process of all."""
    whom = random_moments.choice(["all", "all", "group", "one"])
    gone = random_moments.choice([0.3, 0.7, 1])
    for file in scratch.made_in(tree):
        if random_moments.random() < gone:
            (tree / file).unlink()
    if random_moments.random() < 0.15:
        (tree / "build" / "build.ninja").unlink(missing_ok=True)
    make = subprocess.Popen(["make", "figures"], cwd=tree, env=scratch.ENVIRONMENT, stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL, start_new_session=True)
    time.sleep(random_moments.uniform(0, 0.8 * gone * duration))
    tally["alive"] += make.poll() is None
    if whom == "one":
        below = descendants(make.pid)
        kill(random_moments.sample(below, 1) if below else [])
        make.wait()
    elif make.poll() is None:
        os.killpg(make.pid, signal.SIGKILL)
        make.wait()
    if whom == "all":
        end_all()
    tally["unfinished"] += bool(scratch.unfinished_in(tree))
    for file, content in scratch.made_in(tree).items():
        demand(content == wanted.get(file), f"make figures, {whom} killed: {file} is partial")


def main():
    parser = scratch.arguments(__doc__)
    parser.add_argument("--hold", type=Path, required=True, help="hold.cpp, as it is built")
    parser.add_argument("--kills", type=int, default=110)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--figures", nargs="*", help="only these; default all of the catalogue")
    options = parser.parse_args()
    seed = options.seed if options.seed is not None else random.SystemRandom().randrange(2**32)
    print(f"seed {seed}", flush=True)
    random_moments = random.Random(seed)
    adopt_orphans()
    scratch.count_lines_in(folder)

    tree = scratch.make_tree(folder / "tree", program, options.figures)
    configured = scratch.make(tree, "build/build.ninja")
    begin = time.monotonic()
    undisturbed = scratch.make(tree, "figures")
    if undisturbed.returncode != 0:
        sys.exit(configured.stdout + configured.stderr + undisturbed.stdout + undisturbed.stderr)
    duration = time.monotonic() - begin
    wanted = scratch.made_in(tree)

    runs = str(tree / "build" / "runs" / "exact")
    catalogue, scenes = str(tree / "figures" / "catalogue.json"), str(tree / "data" / "scenes")
    # What claims rest on: the runs of the figures, and the further ones that measures compare with.
    other_tree = scratch.make_tree(folder / "runs", program, options.figures)
    scratch.make(other_tree, "build/build.ninja")
    subprocess.run(["cmake", "--build", "build", "--target", "runs-exact"], cwd=other_tree, check=True,
                   stdout=subprocess.DEVNULL)
    claimed = str(other_tree / "build" / "runs" / "exact")
    tables = sorted(file.name for file in (tree / "build" / "series" / "exact").glob("*.dat"))
    loss = next(file for file in reversed(tables) if file[3:5].isdigit() and file != "fig15.dat")
    number = str(int(loss[3:5]))
    script = str(tree / "figures" / loss.replace(".dat", ".gp"))

    def victim(name, command, files):
        here = folder / name
        here.mkdir()
        return Victim(name, command, here, files)

    victims = [
        victim("run", [program, "run", "--until-time", "300", "--record", "impacts,contacts,energy,history",
                       "--history", "0:300:30000", "--members", "3", "-o", "out.json"],
               ["out.members/02.json", "out.members/03.json", "out.json"]),
        victim("series", [program, "series", "--catalogue", catalogue, "--runs", runs, "--scenes", scenes, "-o",
                          "."], tables),
        victim("draw", [str(tree / "figures" / "draw"), script,
                        str(tree / "build" / "series" / "exact" / loss), f"Figure {number}", "./fig",
                        scratch.VERSION],
               ["fig.svg", "fig.pdf", "fig.png"]),
        victim("verify", [program, "verify", "--claims", str(tree / "data" / "claims.json"), "--catalogue", catalogue,
                          "--runs", claimed, "--scenes", scenes, "--members", "1", "-o", "verdicts.json", "--markdown", "claims.md"],
               ["verdicts.json", "claims.md"]),
    ]
    for each in victims:
        each.measure()
    # A kill counts if it met a living process.
    shares = {each.name: options.kills * 9 // 40 for each in victims}
    shares["make figures"] = options.kills - sum(shares.values())
    for each in victims:
        tally = {"alive": 0, "unfinished": 0}
        aimed = False
        while tally["alive"] < shares[each.name]:
            aimed = not aimed
            kill_once(each, options.hold.resolve(), aimed, random_moments, tally)
        print(f"{each.name}: {tally['alive']} kills, {tally['unfinished']} left something unfinished", flush=True)

    tally = {"alive": 0, "unfinished": 0}
    while tally["alive"] < shares["make figures"]:
        kill_make(tree, wanted, random_moments, tally, duration)
        # Mostly undisturbed to the end; else the next is killed going on from here.
        if random_moments.random() < 0.7 or tally["alive"] == shares["make figures"]:
            again = scratch.make(tree, "figures")
            demand(again.returncode == 0, f"make figures, again: {again.stdout}{again.stderr}")
            demand(scratch.made_in(tree) == wanted, "make figures, again: other files or bytes than undisturbed")
            left = scratch.unfinished_in(tree)
            demand(not left, f"make figures, again: unfinished files remain: {left}")
    print(f"make figures: {tally['alive']} kills, {tally['unfinished']} left something unfinished")
    finish(f"{options.kills} kills, ")


if __name__ == "__main__":
    main()
