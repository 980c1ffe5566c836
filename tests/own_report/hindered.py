"""impact-damper report where something is missing or in the way: one line, the right exit code, nothing left behind."""
import os
import pathlib
import re
import shutil
import signal
import time

from trial import demand, finish, folder, program, run, start

SHORT = ["--until-time", "10", "--members", "2"]


here, temporary = folder / "here", folder / "temporary"
here.mkdir()
temporary.mkdir()


def report(*options, code, words=(), **environment):
    done = run(program, "report", *options, code=code, cwd=here, env={**os.environ, "TMPDIR": str(temporary), **environment})
    done.stderr = without_progress(done.stderr)
    told = f"report {' '.join(options)} with {environment}"
    if code:
        demand(done.stderr.count("\n") == 1 and all(word in done.stderr for word in words), f"{told}: says {done.stderr!r}")
        demand(done.stdout == "", f"{told}: writes {done.stdout[:80]!r}")
        demand(list(here.iterdir()) == [], f"{told}: leaves {list(here.iterdir())}")
    demand(list(temporary.iterdir()) == [], f"{told}: leaves {list(temporary.iterdir())} in the temporary folder")
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
    return f"{tools}:{os.environ['PATH']}"


for path in ("", "/nowhere", str(here)):
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
    demand(re.search(part, whole, re.S), f"the page has no {part}")
    whole = re.sub(part, "", whole, flags=re.S)
demand(report(*SHORT, "--without-figures", code=0, PATH="/nowhere").stdout == whole, "a page without figures says something else")
report(*SHORT, "--without-figures", "--figures", ".", code=2, words=["--figures: must not be given with --without-figures"])

# What gnuplot is told in the user's own settings does not matter.
plain = report(*SHORT, code=0).stdout
home = folder / "home"
home.mkdir()
(home / ".gnuplot").write_text("set terminal png\nset grid\n")
demand(report(*SHORT, code=0, HOME=str(home), LC_ALL="de_DE.UTF-8", GNUTERM="png").stdout == plain,
       "the page depends on the surroundings")

# Moved away from its sources, called from elsewhere by a relative name.
away = folder / "away"
away.mkdir()
shutil.copy(program, away / "damper")
moved = run("./damper", "report", *SHORT, cwd=away)
demand(moved.stdout == plain, "moved away, it says something else")

# The figures beside the page are those in it.
call = report(*SHORT, "--figures", ".", "-o", "page.html", code=0)
page = (here / "page.html").read_text()
pictures = sorted(here.glob("*.svg"))
demand([each.name for each in pictures] == ["begin.svg", "decay.svg", "phase.svg", "prediction.svg"], f"figures: {pictures}")
for each in pictures:
    text = each.read_text()
    demand(text[text.index("<svg") + 4:].strip() in page, f"{each.name} is not the page's")
    each.unlink()
(here / "page.html").unlink()

# Ended while gnuplot works: nothing is left, neither page nor folder, and no child goes on.
for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)):
    started = folder / "started"
    started.unlink(missing_ok=True)
    slow = fake_gnuplot(f"echo $$ > {started}.new; mv {started}.new {started}; sleep 1")
    process = start("report", *SHORT, "-o", "page.html", cwd=here, env={**os.environ, "TMPDIR": str(temporary), "PATH": slow})
    while not started.exists() and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(number)
    error = without_progress(process.communicate()[1])
    demand(process.returncode == code, f"{number.name}: exit code {process.returncode}")
    demand(error == "impact-damper: interrupted: page.html is not written\n", f"{number.name}: says {error!r}")
    demand(list(here.iterdir()) == [] and list(temporary.iterdir()) == [],
           f"{number.name}: leaves {list(here.iterdir())}, {list(temporary.iterdir())}")
    child = int(started.read_text())
    demand(not pathlib.Path(f"/proc/{child}").exists(), f"{number.name}: gnuplot goes on")

finish()
