"""Scenes and wishes beyond all bounds: each ends soon and below 200 MB, by a stop reason or an error.

Soon is measured as processor time, and with room for a slow machine and an unoptimised build; memory is the
largest resident set. First cases that are known to be hard, then scenes drawn at random from all that is allowed.
"""

import os
import random
import re
import resource
import subprocess
import sys

import scratch
from trial import demand, finish, folder, program

MEGABYTES = 200


class Bounds:
    def __init__(self, options):
        self.seconds, self.only = options.seconds, options.only
        self.seconds_of, self.megabytes_of = {}, {}  # by command

    def leaves_out(self, command):
        return self.only is not None and self.only not in " ".join(command)

    def run(self, command, codes):
        """Returns what stands on stderr."""
        if self.leaves_out(command):
            return ""
        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (self.seconds, self.seconds + 1))
        error = folder / "error"
        with open(error, "w") as file:
            process = subprocess.Popen([program, *command], stdout=subprocess.DEVNULL, stderr=file,
                                       preexec_fn=limit, cwd=folder)
            _, status, usage = os.wait4(process.pid, 0)
        process.returncode = code = os.waitstatus_to_exitcode(status)
        seconds, megabytes = usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024
        told, words = " ".join(command), error.read_text()
        self.seconds_of[told], self.megabytes_of[told] = seconds, megabytes
        demand(code in codes, f"{told}: exit code {code} after {seconds:.1f} s: {words}")
        demand(megabytes < MEGABYTES, f"{told}: {megabytes:.0f} MB")
        return words

    def tell(self, what):
        print(what)
        for unit, worst, count in (("s", self.seconds_of, 5), ("MB", self.megabytes_of, 2)):
            for told in sorted(worst, key=worst.get, reverse=True)[:count]:
                print(f"  {worst[told]:5.1f} {unit}: {told}")

    def stops(self, reasons, command, read=False):
        """A run that is done, by one of these stop reasons; its file can be read."""
        if self.leaves_out(command):
            return
        self.run([*command, "-o", "out.json"], [0])
        out = folder / "out.json"
        if out.exists():
            with open(out) as file:
                matches = map(re.compile(r' "stop_reason": "(\w+)"').match, file)
                reason = next((match[1] for match in matches if match), "")
            demand(reason in reasons, f"{' '.join(command)}: stopped by {reason}")
            if read:
                done = subprocess.run([program, "check", "run", out], capture_output=True, text=True)
                demand(done.returncode == 0, f"{' '.join(command)}: cannot be read: {done.stderr}")
            out.unlink()

    def rejects(self, words, command, codes=(2,)):
        if self.leaves_out(command):
            return
        said = self.run([*command, "-o", "out.json"], codes)
        demand(words in said, f"{' '.join(command)}: says {said!r}")
        demand(not (folder / "out.json").exists(), f"{' '.join(command)}: wrote a file")


EVERYTHING = ["--record", "half_cycles,impacts,contacts,energy"]
FOR_EVER = ["run", "--until-time", "1e12"]
BUDGETS = ["impact_budget", "half_cycle_budget", "time_budget", "step_budget"]


def known(b, tree):
    # 1e9 impacts: a forced mass that never rests; a lossless one that bounces as low as one likes.
    for engine in ("exact", "restitution", "cem"):
        b.stops(BUDGETS, [*FOR_EVER, *EVERYTHING, "--engine", engine, "--force-amplitude", "0.1"])
        b.stops(BUDGETS, [*FOR_EVER, *EVERYTHING, "--engine", engine, "--restitution", "1", "--x0", "1e-3"])
        b.rejects("must be <= 10000000", [*FOR_EVER, *EVERYTHING, "--engine", engine, "--max-impacts", "1000000000"])
        b.rejects("must be <= 10000000", [*FOR_EVER, "--engine", engine, "--max-half-cycles", "1000000000"])
        # No impact at all, no half cycle, nothing that is recorded.
        b.stops(BUDGETS, [*FOR_EVER, *EVERYTHING, "--engine", engine, "--x0", "0.01", "--y0", "0.5"])
        b.stops(BUDGETS, [*FOR_EVER, "--record", "contacts", "--engine", engine, "--x0", "0.01", "--y0", "0.5"])
        b.stops(BUDGETS, [*FOR_EVER, *EVERYTHING, "--engine", engine, "--x0", "0"])
        # Stuck for ever, and forced all the while.
        b.stops(BUDGETS, [*FOR_EVER, *EVERYTHING, "--engine", engine, "--x0", "0", "--restitution", "0",
                          "--force-amplitude", "1e-9", "--force-frequency", "1e-3"])
        b.stops(BUDGETS, [*FOR_EVER, "--record", "energy", "--engine", engine, "--force-amplitude", "1e-9",
                          "--force-frequency", "1e6", "--x0", "0"])
        b.stops(BUDGETS, [*FOR_EVER, *EVERYTHING, "--engine", engine, "--mass-ratio", "1e-9"])
        b.stops([*BUDGETS, "time"], ["run", "--until-time", "3e5", *EVERYTHING, "--engine", engine,
                                     "--force-amplitude", "0.05"])
        b.rejects("--mass-ratio: must be >= 1e-09", [*FOR_EVER, "--engine", engine, "--mass-ratio", "5e-324"])
        b.stops([*BUDGETS, "amplitude"], ["run", "--until-amplitude", "1e-300", *EVERYTHING, "--engine", engine])

    # A history of 1e12 points; and the longest that is allowed.
    for points in ("1000000000000", "100000000", "500001"):
        b.rejects("samples", ["run", "--until-time", "10", "--history", f"0:10:{points}"])
        b.rejects("samples", ["run", "--until-time", "10", "--history-below", f"5:10:{points}"])
    b.rejects("--history: must ask for at most 500000 samples in all",
              ["run", "--until-time", "10", "--history", "0:1:300000", "--history", "1:2:300000"])
    b.stops(["time"], ["run", "--until-time", "50", *EVERYTHING, "--history", "0:50:500000"])
    # As much as the default budgets allow of everything at once: about 100 MB.
    b.stops(BUDGETS, [*FOR_EVER, *EVERYTHING, "--history", "0:50000:500000", "--force-amplitude", "0.1"], read=True)

    # Steps of the component element method, whose squares may underflow.
    b.run([*FOR_EVER, *EVERYTHING, "--engine", "cem", "--time-step", "1e-300"], [0, 4])
    for step in ("1e-12", "1e-6"):
        b.stops(BUDGETS, [*FOR_EVER, *EVERYTHING, "--engine", "cem", "--time-step", step, "--x0", "1e3"])
    b.stops(BUDGETS, [*FOR_EVER, "--engine", "cem", "--locate", "--large-step", "0.05"])
    b.stops(BUDGETS, [*FOR_EVER, *EVERYTHING, "--engine", "cem", "--wall-stiffness", "1e15"])

    # What a sweep holds in memory does not grow with its runs, whose order is that of the table.
    b.run(["sweep", "--vary", "mass_ratio=0.005:0.08:1000", "--vary", "restitution=0.1:0.9:1000", "--keep", "impacts",
           "--engine", "restitution", "--until-time", "2", "-o", "out.csv"], [0])
    (folder / "out.csv").unlink(missing_ok=True)

    # Ensembles and threads.
    runs, claims = str(tree / "build" / "runs" / "exact"), str(scratch.SOURCE / "data" / "claims.json")
    catalogue = str(tree / "figures" / "catalogue.json")
    verify = ["verify", "--runs", runs, "--claims", claims, "--catalogue", catalogue, "--scenes", str(scratch.SOURCE / "data" / "scenes")]
    for members in ("1000000000", "10000", "101"):
        b.rejects("--members: must be a whole number >= 1 and <= 100", [*verify, "--members", members])
    for threads in ("0", "-1", "100000", "1e9", "99999999999999999999"):
        b.rejects("--threads: must be a whole number >= 1 and <= 1024", [*verify, "--threads", threads])
    b.run([*verify, "--threads", "1024"], [0, 1])
    for members in ("1000000000", "101", "0"):
        b.rejects("--members: must be a whole number >= 1 and <= 100", ["run", "--until-time", "10", "--members", members])
    b.run(["run", "--until-time", "10", "--members", "100", "--threads", "1024", "-o", "out.json"], [0])


def drawn(choose):
    """Options of a run, over all that is allowed."""
    def size(low, high):
        return repr(10 ** choose.uniform(low, high))
    engine = choose.choice(["exact", "exact", "restitution", "cem"])
    command = ["run", "--engine", engine]
    def add(option, *values):
        command.extend([option, choose.choice(values)])
    add("--mass-ratio", "0.02", "1e-9", "1", "1e6", size(-8, 6))
    add("--restitution", "0", "1", "0.6", "0.999", "0.9999999", "1e-300")
    add("--damping-ratio", "0", "0", "1e-12", "0.01", "0.999", "1", "1.0001", "50", "1e6")
    add("--wall-stiffness", "1e4", "1e-6", "1e-3", "1", "1e15", size(-6, 15))
    add("--x0", "6", "0", "1", "1e-30", "1e12", "1e6", "0.1")
    add("--v0", "0", "0", "1e12", "-3", "1e-9")
    add("--y0", "0", "0", "0.5", "1", "0.999999", "1e-30", *([] if engine == "restitution" else ["-1", "1e12"]))
    add("--w0", "0", "0", "1e-9", "-1e-9", "5", "1e12", "-1e12")
    if choose.random() < 0.5:
        add("--force-amplitude", "0.1", "1", "1e12", "1e-30", "10")
        add("--force-frequency", "1", "0.5", "1e-12", "1e-6", "1e6", "100", "1.00001")
    command += choose.choice([["--until-time", "1e12"], ["--until-amplitude", "1e-12"]])
    add("--record", "half_cycles", "contacts", "energy", EVERYTHING[1])
    if engine == "cem":
        command += choose.choice([[], [], ["--unstable"]]) + choose.choice([[], ["--locate"]])
        command += choose.choice([[], ["--large-step", "0.05"], ["--time-step", "1e-300"], ["--time-step", "1e-6"]])
    return command


def main():
    parser = scratch.arguments(__doc__)
    parser.add_argument("--seconds", type=int, default=20, help="of processor time that each may take")
    parser.add_argument("--scenes", type=int, default=40, help="drawn at random")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", help="commands with this text in them")
    options = parser.parse_args()
    bounds = Bounds(options)
    tree = scratch.make_tree(folder / "tree", program)
    if not bounds.leaves_out(["verify"]):
        made = scratch.make(tree, "build/build.ninja")
        runs = subprocess.run(["cmake", "--build", "build", "--target", "runs-exact"], cwd=tree, capture_output=True)
        if made.returncode != 0 or runs.returncode != 0:
            sys.exit(f"{made} {runs}")
    known(bounds, tree)
    bounds.tell("known to be hard")
    choose = random.Random(options.seed)
    for _ in range(options.scenes):
        command = drawn(choose)
        # Unstable steps of central differences overflow; closed forms do not.
        bounds.run([*command, "-o", "out.json"], [0, 2, 4] if "cem" in command else [0, 2])
    bounds.tell(f"and {options.scenes} drawn with seed {options.seed}")
    finish("bounds, ")


if __name__ == "__main__":
    main()
