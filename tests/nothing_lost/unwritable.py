"""Places that cannot be written: a full disk, a read-only one, a folder without permission, a closed pipe.

One line on stderr that names the file and says what is wrong, exit code 5, the old file as it was and nothing
unfinished beside it; and with room again the same command completes. /dev/full and closed pipes need nothing; the
small and the read-only disk are tmpfs, mounted in a mount namespace of this test's own where that is permitted.
Exit code 77: what could be tested here passed, but not all could.
"""

import os
import shutil
import signal
import subprocess
import sys

import scratch
from packed_files import read
from trial import demand, finish, folder, program

FULL, READ_ONLY, DENIED = "No space left on device", "Read-only file system", "Permission denied"


class Programs:
    def __init__(self, tree):
        self.tree = tree
        self.draw = str(tree / "figures" / "draw")
        self.runs = str(tree / "build" / "runs" / "exact")
        self.scenes = str(tree / "data" / "scenes")
        self.catalogue = str(tree / "figures" / "catalogue.json")
        self.table = str(tree / "build" / "series" / "exact" / "fig07.dat")
        self.claims = str(tree / "claims.json")

    def run(self, *more):
        return [program, "run", "--until-time", "50", "--record", "impacts,history", "--history", "0:50:2000",
                *more]

    def series(self, *more):
        return [program, "series", "--catalogue", self.catalogue, "--runs", self.runs, "--scenes", self.scenes, *more]

    def verify(self, *more):
        return [program, "verify", "--claims", self.claims, "--runs", self.runs, "--scenes", self.scenes, *more]

    def report(self, *more):
        return [program, "report", "--until-time", "10", "--members", "2", *more]

    def drawing(self, stem):
        return [self.draw, str(self.tree / "figures" / "fig07.gp"), self.table, "A figure", stem, scratch.VERSION]

    def rejected(self, command, words, **more):
        """The command fails with exit code 5 and one line that holds the words."""
        done = subprocess.run(command, text=True, capture_output="stdout" not in more,
                              **({"stderr": subprocess.PIPE} if "stdout" in more else {}), **more)
        told = " ".join(map(str, command))
        demand(done.returncode == 5, f"{told}: exit code {done.returncode}: {done.stderr}")
        lines = scratch.complaints(done.stderr)
        demand(len(lines) == 1 and all(word in lines[0] for word in words),
               f"{told}: says {done.stderr!r} instead of {words}")


def devices(p):
    for command in (p.run("-o", "/dev/full"), p.series("--figure", "7", "-o", "/dev/full"), p.report("-o", "/dev/full"),
                    p.verify("-o", "/dev/full"), p.verify("--markdown", "/dev/full")):
        p.rejected(command, ["/dev/full: cannot be written", FULL])
    to_stdout = [p.run(), p.series("--figure", "7"), p.verify(), p.report(), [program, "scenes", str(p.tree / "data/scenes")],
                 [program, "figures", p.catalogue], [program, "--help"], [program, "run", "--help"],
                 [program, "--version"]]
    with open("/dev/full", "w") as full:
        for command in to_stdout:
            p.rejected(command, ["standard output: cannot be written", FULL], stdout=full)
    for command in to_stdout:
        p.rejected(["sh", "-c", '"$0" "$@" >&-', *command], ["standard output: cannot be written"])
    # What is told is lost, what is written is not.
    verdicts = p.tree / "verdicts.json"
    with open("/dev/full", "w") as full:
        p.rejected(p.verify("-o", str(verdicts)), ["standard output"], stdout=full)
    demand(verdicts.exists(), "verify with standard output on a full disk has lost its verdicts")

    # A reader that has seen enough: more than a pipe holds is written, and one line read.
    command = [program, "run", "--until-time", "50", "--record", "history", "--history", "0:50:100000"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.readline()
        process.stdout.close()
        error = process.stderr.read()
    demand(process.returncode == -signal.SIGPIPE and error == b"", f"a closed pipe: {process.returncode}, {error}")
    quiet = subprocess.run(["sh", "-c", '"$0" "$@" | head -n 1', *command], capture_output=True, text=True)
    demand(quiet.returncode == 0 and quiet.stderr == "" and quiet.stdout == "{\n", f"| head -n 1: {quiet}")


def mount(place, size):
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", str(place)], check=True)


def resize(place, options):
    subprocess.run(["mount", "-o", f"remount,{options}", str(place)], check=True)


def made_here(here, files):
    return {file: (here / file).read_bytes() for file in files if (here / file).exists()}


def small_disk(p, here):
    """Each command on disks of many sizes, so that it fails at each of the places where it can."""
    wanted = {"run": ["out.json"], "series": ["fig07.dat"], "verify": ["verdicts.json"], "report": ["page.html"],
              "draw": ["fig.svg", "fig.pdf", "fig.png"]}
    commands = {"run": p.run("-o", "out.json"), "series": p.series("--figure", "7", "-o", "fig07.dat"),
                "verify": p.verify("-o", "verdicts.json"), "report": p.report("-o", "page.html"), "draw": p.drawing("./fig")}
    for name, command in commands.items():
        mount(here, "16m")
        done = subprocess.run(command, cwd=here, capture_output=True, text=True)
        demand(done.returncode == 0, f"{name}: {done.stderr}")
        new = made_here(here, wanted[name])
        subprocess.run(["umount", str(here)], check=True)
        total = sum(len(content) for content in new.values())
        failures = 0
        for part in (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0, 1.1, 1.3):
            # Whole pages, and those of the old files.
            pages = int(part * total) // 4096 + len(new) * (1 if part < 1 else 2)
            mount(here, f"{pages * 4}k")
            old = {file: b"old\n" for file in new}
            for file, content in old.items():
                (here / file).write_bytes(content)
            done = subprocess.run(command, cwd=here, capture_output=True, text=True)
            left = made_here(here, wanted[name])
            told = f"{name} on {pages} pages"
            if done.returncode == 0:
                demand(left == new, f"{told}: done, but with other bytes")
            else:
                failures += 1
                demand(done.returncode == 5, f"{told}: exit code {done.returncode}: {done.stderr}")
                lines = scratch.complaints(done.stderr)
                demand(len(lines) == 1 and "cannot be written" in lines[0] and FULL in lines[0],
                       f"{told}: says {done.stderr!r}")
                for file in new:
                    demand(left[file] in (old[file], new[file]), f"{told}: {file} is partial")
            demand(not scratch.unfinished_in(here), f"{told}: unfinished: {scratch.unfinished_in(here)}")
            resize(here, "size=16m")
            done = subprocess.run(command, cwd=here, capture_output=True, text=True)
            demand(done.returncode == 0 and made_here(here, wanted[name]) == new, f"{told}, then with room: {done}")
            subprocess.run(["umount", str(here)], check=True)
        demand(failures > 0, f"{name} never met a full disk")
        print(f"{name}: {failures} of 9 disks too small for it")


def read_only_disk(p, here):
    mount(here, "16m")
    for file in ("out.json", "fig07.dat", "verdicts.json"):
        (here / file).write_text("old\n")
    resize(here, "ro")
    for file, command in (("out.json", p.run("-o", "out.json")), ("new.json", p.run("-o", "new.json")),
                          ("fig07.dat", p.series("--figure", "7", "-o", "fig07.dat")),
                          ("fig07.dat", p.series("--figure", "7", "-o", ".")),
                          ("verdicts.json", p.verify("-o", "verdicts.json")),
                          ("page.html", p.report("-o", "page.html")), ("./fig.", p.drawing("./fig"))):
        p.rejected(command, [file, "cannot be written", READ_ONLY], cwd=here)
    demand((here / "out.json").read_text() == "old\n", "a read-only file was changed")
    subprocess.run(["umount", str(here)], check=True)


def make_on_small_disk(wanted):
    tree = scratch.make_tree(folder / "small", program, FIGURES)
    build = tree / "build"
    mount(build, "64m")
    (build / "src").mkdir()
    shutil.copy(program, build / "src" / "impact-damper")
    scratch.make(tree, "build/build.ninja")
    used = sum(file.stat().st_size // 4096 + 1 for file in build.rglob("*") if file.is_file())
    failed = 0
    for room in (10, 60, 150, 250):
        resize(build, f"size={(used + room) * 4}k")
        done = scratch.make(tree, "figures")
        failed += done.returncode != 0
        for file, content in scratch.made_in(tree).items():
            demand(content == wanted[file], f"make figures with {room} pages: {file} is partial")
        demand(not scratch.unfinished_in(tree), f"make figures with {room} pages: {scratch.unfinished_in(tree)}")
    demand(failed > 0, "make figures never met a full disk")
    resize(build, "size=64m")
    done = scratch.make(tree, "figures")
    demand(done.returncode == 0 and scratch.made_in(tree) == wanted, f"make figures with room again: {done}")
    print(f"make figures: {failed} of 4 disks too small for it")
    subprocess.run(["umount", str(build)], check=True)


def without_permission(p, here):
    """As nobody, who may read the program and the input, in a folder that is another's."""
    nobody = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
    if subprocess.run([*nobody, program, "--version"], capture_output=True).returncode != 0:
        return False
    scratch.make_folder(here)
    here.chmod(0o755)
    if subprocess.run([*nobody, "ls", str(here)], capture_output=True).returncode != 0:
        return False
    for name, command in (("out.json", p.run("-o", "out.json")), ("page.html", p.report("-o", "page.html")),
                          ("./fig.", p.drawing("./fig"))):
        p.rejected(nobody + command, [name, "cannot be written", DENIED], cwd=here)
    return True


FIGURES = ["5", "7"]


def main():
    inside = "NOTHING_LOST_INSIDE" in os.environ
    if not inside and scratch.may_mount():
        os.environ["NOTHING_LOST_INSIDE"] = "1"
        os.execvp("unshare", ["unshare", "-m", sys.executable, *sys.argv])
    tree = scratch.make_tree(folder / "tree", program, FIGURES)
    first = scratch.make(tree, "figures")
    if first.returncode != 0:
        sys.exit(first.stdout + first.stderr)
    (tree / "claims.json").write_bytes(read(scratch.SOURCE / "tests/cli/files.packed")["claims.json"][1])
    p = Programs(tree)
    skipped = []
    devices(p)
    if inside:
        here = scratch.make_folder(folder / "disk")
        small_disk(p, here)
        read_only_disk(p, here)
        make_on_small_disk(scratch.made_in(tree))
    else:
        skipped.append("the small and the read-only disk: no mount namespace is permitted here")
    if os.getuid() != 0 or not shutil.which("setpriv") or not without_permission(p, folder / "anothers"):
        skipped.append("the folder without permission: nobody cannot be played here")
    finish("places that cannot be written, ", skipped)


if __name__ == "__main__":
    main()
