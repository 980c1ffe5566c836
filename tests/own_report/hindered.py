"""impact-damper report where something is missing or in the way: one line, the right exit code, nothing left behind.

    hindered.py PROGRAM FOLDER
"""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

program, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
faults = []
SHORT = ["--until-time", "10", "--members", "2"]


def check(condition, fault):
    if not condition:
        faults.append(fault)
        print("FAULT:", fault, file=sys.stderr)


def report(*options, code, words=(), place=None, **environment):
    done = subprocess.run([str(program), "report", *options], cwd=place or here, capture_output=True, text=True,
                          env={**os.environ, "TMPDIR": str(temporary), **environment})
    done.stderr = without_progress(done.stderr)
    told = f"report {' '.join(options)} with {environment}"
    check(done.returncode == code, f"{told}: exit code {done.returncode}: {done.stderr}")
    if code:
        check(done.stderr.count("\n") == 1 and all(word in done.stderr for word in words), f"{told}: says {done.stderr!r}")
        check(done.stdout == "", f"{told}: writes {done.stdout[:80]!r}")
        check(list(here.iterdir()) == [], f"{told}: leaves {list(here.iterdir())}")
    check(list(temporary.iterdir()) == [], f"{told}: leaves {list(temporary.iterdir())} in the temporary folder")
    return done


def without_progress(text):
    """What a slow machine says on the way is no fault."""
    return "".join(line + "\n" for line in text.splitlines() if not line.startswith("report: "))


def fake_gnuplot(body):
    tools = folder / "tools"
    shutil.rmtree(tools, ignore_errors=True)
    tools.mkdir()
    (tools / "gnuplot").write_text(f"#!/bin/sh\n{body}\n")
    (tools / "gnuplot").chmod(0o755)
    return f"{tools.resolve()}:{os.environ['PATH']}"


shutil.rmtree(folder, ignore_errors=True)
here, temporary = folder / "here", folder / "temporary"
here.mkdir(parents=True)
temporary.mkdir()
temporary = temporary.resolve()

for path in ("", "/nowhere", str(here.resolve())):
    report(*SHORT, "-o", "page.html", code=5, words=["gnuplot: cannot be found in PATH", "install it", "--without-figures"], PATH=path)
report(*SHORT, "-o", "page.html", code=4, words=["figure decay cannot be drawn", "out of ink"],
       PATH=fake_gnuplot("echo out of ink >&2; exit 1"))
real = shutil.which("gnuplot")
report(*SHORT, "-o", "page.html", code=4, words=["cannot be drawn", "not quite"],
       PATH=fake_gnuplot(f'{real} "$@"; echo not quite >&2'))
report(*SHORT, "-o", "no/such/page.html", code=5, words=["no/such/page.html: cannot be written"])
report(*SHORT, "-o", "/dev/full", code=5, words=["/dev/full: cannot be written: No space left on device"])

# Without figures the page says the same, and of the phases, which are only drawn, nothing.
whole = report(*SHORT, code=0).stdout.replace("impact-damper report</code>", "impact-damper report --without-figures</code>")
for part in ("<figure.*?</figure>\n", '<section id="phase">.*?</section>\n', '<li><a href="#phase">.*?</li>\n'):
    check(re.search(part, whole, re.S), f"the page has no {part}")
    whole = re.sub(part, "", whole, flags=re.S)
check(report(*SHORT, "--without-figures", code=0, PATH="/nowhere").stdout == whole, "a page without figures says something else")
report(*SHORT, "--without-figures", "--figures", ".", code=2, words=["--figures: must not be given with --without-figures"])

# What gnuplot is told in the user's own settings does not matter.
plain = report(*SHORT, code=0).stdout
home = folder / "home"
home.mkdir()
(home / ".gnuplot").write_text("set terminal png\nset grid\n")
check(report(*SHORT, code=0, HOME=str(home.resolve()), LC_ALL="de_DE.UTF-8", GNUTERM="png").stdout == plain,
      "the page depends on the surroundings")

# Moved away from its sources, called from elsewhere by a relative name.
away = folder / "away"
away.mkdir()
shutil.copy(program, away / "damper")
moved = subprocess.run(["./damper", "report", *SHORT], cwd=away, capture_output=True, text=True)
check(moved.returncode == 0 and moved.stdout == plain, f"moved away: {moved.returncode}: {moved.stderr}")

# The figures beside the page are those in it.
call = report(*SHORT, "--figures", ".", "-o", "page.html", code=0)
page = (here / "page.html").read_text()
pictures = sorted(here.glob("*.svg"))
check([each.name for each in pictures] == ["begin.svg", "decay.svg", "phase.svg", "prediction.svg"], f"figures: {pictures}")
for each in pictures:
    text = each.read_text()
    check(text[text.index("<svg") + 4:].strip() in page, f"{each.name} is not the page's")
    each.unlink()
(here / "page.html").unlink()

# Ended while gnuplot works: nothing is left, neither page nor folder, and no child goes on.
for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)):
    started = folder / "started"
    started.unlink(missing_ok=True)
    slow = fake_gnuplot(f"echo $$ > {started.resolve()}.new; mv {started.resolve()}.new {started.resolve()}; sleep 1")
    process = subprocess.Popen([str(program), "report", *SHORT, "-o", "page.html"], cwd=here, stderr=subprocess.PIPE,
                               env={**os.environ, "TMPDIR": str(temporary), "PATH": slow}, text=True)
    while not started.exists() and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(number)
    error = without_progress(process.communicate()[1])
    check(process.returncode == code, f"{number.name}: exit code {process.returncode}")
    check(error == "impact-damper: interrupted: page.html is not written\n", f"{number.name}: says {error!r}")
    check(list(here.iterdir()) == [] and list(temporary.iterdir()) == [],
          f"{number.name}: leaves {list(here.iterdir())}, {list(temporary.iterdir())}")
    child = int(started.read_text())
    check(not pathlib.Path(f"/proc/{child}").exists(), f"{number.name}: gnuplot goes on")

print(f"{len(faults)} faults")
sys.exit(bool(faults))
