"""Processes that are ended from outside, or that a test may not leave behind."""
import contextlib
import ctypes
import os
import pathlib
import signal
import time


def adopt_orphans():
    """Children of killed children become ours, so that they can be found."""
    ctypes.CDLL(None).prctl(36, 1, 0, 0, 0)  # PR_SET_CHILD_SUBREAPER


def descendants(ancestor=None):
    """Of a process, or of this one."""
    children = {}
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            children.setdefault(int(stat.read_text().rpartition(")")[2].split()[1]), []).append(int(stat.parent.name))
    found = [ancestor or os.getpid()]
    for process in found:
        found += children.get(process, [])
    return found[1:]


def kill(processes):
    for process in processes:
        with contextlib.suppress(ProcessLookupError):
            os.kill(process, signal.SIGKILL)


def end_all():
    """All below this one, until none is left; a process may have begun another while it was looked for."""
    while alive := descendants():
        kill(alive)
        with contextlib.suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        time.sleep(0.001)
