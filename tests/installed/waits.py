""".ci/install waits for another apt, says so in one line, and gives up when it must; it installs what the system's apt has,
and names the rest.

Runs it with an apt-get, a dpkg-query, an id and a sleep of its own first in PATH: apt-get fails as the real one does
while another holds the lock, and the time slept is written down instead of spent.
"""
import os
import shutil

from trial import demand, finish, folder, program, run

LOCKED = "E: Could not get lock /var/lib/apt/lists/lock. It is held by process 123 (apt-get)"
WAITING = "Waiting for another apt to end, for at most 300 seconds\n"


def stub(name: str, text: str):
    file = folder / "bin" / name
    file.write_text("#!/bin/sh\n" + text)
    file.chmod(0o755)


def install(failures: int, message: str, packages=("hello",)) -> tuple:
    """What .ci/install does if the first `failures` updates fail so, and apt has no package absent-*: exit code, output,
    calls of apt-get, seconds slept."""
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "bin").mkdir(parents=True)
    stub("dpkg-query", "exit 1\n")  # nothing is installed
    stub("id", "echo 0\n")
    stub("sleep", f'echo "$1" >>{folder}/slept\n')
    stub("apt-get", f"""echo "$*" >>{folder}/called
case $* in *absent-*) exit 100 ;; *update*) [ $(grep -c update {folder}/called) -gt {failures} ] || {{ echo '{message}' >&2; exit 100; }} ;; esac
""")
    done = run(program, *packages, code=None, env=dict(os.environ, PATH=f"{folder}/bin:{os.environ['PATH']}"))
    slept = folder / "slept"
    return (done.returncode, done.stdout, done.stderr, (folder / "called").read_text().splitlines(),
            sum(map(int, slept.read_text().split())) if slept.exists() else 0)


code, out, err, called, slept = install(0, LOCKED)
demand((code, err, slept) == (0, "", 0) and WAITING not in out and len(called) == 3, (code, out, err, called, slept))
demand(all("-o DPkg::Lock::Timeout=300" in call for call in called if "--simulate" not in call), called)

code, out, err, called, slept = install(3, LOCKED)
demand((code, err, slept) == (0, "", 30) and out.count(WAITING) == 1, (code, out, err, slept))
demand(called[-1].endswith("install -q -y --no-install-recommends hello"), called)

code, out, err, called, slept = install(1000, LOCKED)
demand(code == 1 and LOCKED in err and slept == 300, (code, out, err, slept))
demand(not any(" install " in call for call in called), called)

code, out, err, called, slept = install(1000, "E: Temporary failure resolving the mirror")
demand(code == 1 and "Temporary failure" in err and slept == 0 and WAITING not in out, (code, out, err, slept))

code, out, err, called, slept = install(0, LOCKED, ("hello", "absent-1", "world", "absent-2"))
demand((code, err) == (0, "") and out.endswith(" of Debian's):\n  absent-1 absent-2\n"), (code, out, err))
demand(called[-1].endswith("install -q -y --no-install-recommends hello world"), called)

code, out, err, called, slept = install(0, LOCKED, ["absent-1"])
demand(code == 100 and called[-1].endswith("absent-1"), (code, out, err, called))

# Fedora, macOS and others.
shutil.rmtree(folder / "bin")
done = run("/bin/sh", program, "hello", "world", env={"PATH": f"{folder}/bin"})
demand(done.stdout.endswith("(these are Debian's):\n  hello world\n"), done)
finish()
