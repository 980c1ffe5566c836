#!/usr/bin/env python3
"""Sweeps by the scripts of examples/cluster/ on a real Slurm that is started here: a task is killed and requeued, a node drained, another
one dies, a task nears its time limit, and the table has the bytes that one machine gives. Faulty parts are not merged.

Slurm and munge are Debian's, with a configuration, a key, folders and free ports of their own; without the key nobody is served.
All that was started is ended with this process. Needs no rights. Exit code 1: faults, or no Slurm is here.
"""
import collections
import contextlib
import ctypes
import getpass
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

from processes import adopt_orphans, descendants, end_all, kill
from trial import folder, program, source, write

begin, parts, nodes = time.monotonic(), 8, ("node1", "node2")
home = pathlib.Path(tempfile.mkdtemp(prefix="slurm-"))  # Slurm's: names of its sockets must be short
libc = ctypes.CDLL(None)
pr_set_pdeathsig = 1


def say(what):
    print(f"{time.monotonic() - begin:6.1f} s  {what}", flush=True)


def demand(holds, what):
    if not holds:
        raise AssertionError(what)


def wait_for(what, found, seconds=90):
    """Until found() holds; returns what it gives."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if result := found():
            return result
        time.sleep(0.1)
    raise AssertionError(f"{what}: not within {seconds} s")


def call(*words, code=0):
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True, check=False)
    demand(done.returncode == code, f"{' '.join(map(str, words))}: exit code {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout


# What was started: daemons, and what they start, also where the process between has ended.

def start(name, *words):
    with open(folder / f"{name}.out", "w", encoding="utf-8") as out:
        return subprocess.Popen([str(word) for word in words], cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=out,
                                start_new_session=True, preexec_fn=lambda: libc.prctl(pr_set_pdeathsig, signal.SIGKILL))


def start_node(name):
    return start(name, "slurmd", "-D", "-N", name)


def configure():
    host, user = socket.gethostname().split(".")[0], getpass.getuser()
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(1 + len(nodes))]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        controller, *ports = [each.getsockname()[1] for each in sockets]
    lines = [f"NodeName={name} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=2" for name, port in zip(nodes, ports)]
    (home / "slurm.conf").write_text(f"""ClusterName=check
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
# cred_expire: seconds until a requeued task may begin again; 120 unless given.
AuthInfo=socket={home}/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation={home}/state
SlurmdSpoolDir={home}/%n
SlurmctldPidFile={home}/slurmctld.pid
SlurmdPidFile={home}/%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
# More processors than there are, for four tasks at once.
SlurmdParameters=config_overrides
SchedulerParameters=bf_interval=1
# Seconds until a node that does not answer is down, and its tasks are requeued.
SlurmdTimeout=8
ReturnToService=2
KillWait=5
MailProg=/bin/true
""" + "\n".join(lines + ["PartitionName=check Nodes=ALL Default=YES", ""]))
    # Else slurmd looks for a cgroup file system, which not every container has.
    (home / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
    os.environ.update(SLURM_CONF=str(home / "slurm.conf"), IMPACT_DAMPER=str(program))


def start_slurm():
    (home / "munge.key").write_bytes(os.urandom(1024))
    (home / "munge.key").chmod(0o400)
    (home / "state").mkdir()
    start("munged", "munged", "--foreground", "--force", f"--socket={home}/munge.socket", f"--key-file={home}/munge.key",
          f"--pid-file={home}/munge.pid", f"--seed-file={home}/munge.seed")
    wait_for("munged", (home / "munge.socket").exists)
    start("slurmctld", "slurmctld", "-D")
    for name in nodes:
        start_node(name)
    wait_for("two idle nodes", lambda: all(state_of_node(name) == "idle" for name in nodes))


def state_of_node(name):
    return subprocess.run(["sinfo", "--noheader", f"--nodes={name}", "--format=%T"], capture_output=True, text=True,
                          check=False).stdout.strip()


def tasks(job):
    """Of each task of an array that has begun, and of a job without: state, node, restarts."""
    found = {}
    for line in call("scontrol", "--oneliner", "show", "job", job).splitlines():
        fields = dict(re.findall(r"(\w+)=(\S*)", line))
        if (task := fields.get("ArrayTaskId", "0")).isdigit():
            found[int(task)] = fields["JobState"], fields["NodeList"], int(fields["Restarts"])
    return found


def running(job, node):
    return [task for task, (state, where, _) in tasks(job).items() if (state, where) == ("RUNNING", node)]


def wait_for_end(job, state):
    wait_for(f"the end of job {job}", lambda: tasks(job)[0][0] not in ("PENDING", "CONFIGURING", "RUNNING", "COMPLETING"), 150)
    demand(tasks(job)[0][0] == state, f"job {job}: {tasks(job)}")


def submit(table, count, *options):
    said = call(source / "examples/cluster/slurm", "plan.json", table, count, *options)
    return re.search(r"Submitted (\d+), .* and (\d+),", said).groups()


def rows(table, task):
    """Of a part, with a digest behind them."""
    file = folder / f"{table}.part-{task}-of-{parts}"
    return max(map(int, re.findall(r"^# (\d+) ", file.read_text(), re.M)), default=0) if file.exists() else 0


def words_of(pid, file="cmdline"):
    with contextlib.suppress(OSError):
        return (pathlib.Path("/proc") / str(pid) / file).read_bytes().decode(errors="replace").split("\0")
    return []


def lose(node):
    """All processes of a node, those first that would tell the controller of the others' end."""
    found = descendants()
    of_tasks = [pid for pid in found if f"SLURMD_NODENAME={node}" in words_of(pid, "environ")]
    kill([pid for pid in found if words_of(pid)[-2:] == [node, ""]] + [pid for pid in found if set(of_tasks) & set(descendants(pid))])
    kill(of_tasks)


def disturbed_array():
    array, merge = submit("table.csv", parts, f"--array=1-{parts}%4")
    say(f"array {array} of {parts} parts")
    drained = wait_for("tasks on node2", lambda: running(array, "node2"))
    call("scontrol", "update", "nodename=node2", "state=drain", "reason=check")
    say(f"node2 drained, with tasks {drained}")

    killed = wait_for("a task on node1", lambda: running(array, "node1"))[0]
    kept = wait_for("rows", lambda: rows("table.csv", killed))
    kill([pid for pid in descendants() if f"{killed}/{parts}" in words_of(pid) and "sweep" in words_of(pid)])
    wait_for("a failed task", lambda: tasks(array)[killed][0] == "FAILED")
    call("scontrol", "requeue", f"{array}_{killed}")
    say(f"task {killed} killed with {kept} rows, and requeued")

    wait_for("a drained node", lambda: state_of_node("node2") == "drained")
    demand(not {task for task, (_, node, _) in tasks(array).items() if node == "node2"} - set(drained), "a task on a drained node")
    there = {task: rows("table.csv", task) for task in range(1, parts + 1)}
    call("scontrol", "update", "nodename=node2", "state=resume")
    say("node2 resumed")

    wait_for("a task that goes on on node2", lambda: [task for task in running(array, "node2") if rows("table.csv", task) > there[task]])
    lost = running(array, "node2")
    lose("node2")
    died = time.monotonic()
    say(f"node2 dead, with tasks {lost}")
    wait_for("a node that is down", lambda: state_of_node("node2").startswith("down"))
    say(f"noticed after {time.monotonic() - died:.0f} s")

    # What Slurm sends before the time limit. The last task has the array's own number.
    last = parts
    there = rows("table.csv", last)
    wait_for("the last task to go on", lambda: tasks(array)[last][0] == "RUNNING" and rows("table.csv", last) > there)
    call("scancel", "--batch", "--signal=USR1", f"{array}_{last}")
    say(f"task {last} signalled with {rows('table.csv', last)} rows, as at its time limit")
    start_node("node2")

    wait_for_end(merge, "COMPLETED")
    ended = tasks(array)
    demand(all(state == "COMPLETED" for state, _, _ in ended.values()) and len(ended) == parts, f"{ended}")
    demand(collections.Counter({task: ended[task][2] for task in ended}) == collections.Counter([killed, last, *lost]),
           f"not just {killed}, {lost}, {last} requeued: {ended}")
    say(f"merged; restarts {[ended[task][2] for task in sorted(ended)]}")
    for name in ("table.csv", "table.csv.json"):
        demand((folder / name).read_bytes() == (folder / name.replace("table", "serial")).read_bytes(), f"{name} is not the serial one")
    say("the table is the serial one, byte for byte")


def faulty_parts():
    """The job that merges fails, says why and leaves no table."""
    def of(task):
        return folder / f"faulty.csv.part-{task}-of-{parts}"

    def other_version(text):
        return re.sub('"program": "', '"program": "9.9.9 ', text, count=1)

    def doubled_row(text):
        return re.sub(r"(?m)^(\d+,.*\n)", r"\1\1", text, count=1)

    for task, fault, expected in ((3, other_version, "must be of the same plan and program"), (8, doubled_row, "a row is altered, missing or doubled"),
                                  (5, None, "part 5 of 8 is missing")):
        for each in range(1, parts + 1):
            shutil.copy(str(of(each)).replace("faulty", "table"), of(each))
        if fault:
            of(task).write_text(fault(of(task).read_text()))
        else:
            of(task).unlink()
        merge = call("sbatch", "--parsable", "--output=faulty.log", source / "examples/cluster/job.slurm", "plan.json", "faulty.csv", parts).strip()
        wait_for_end(merge, "FAILED")
        demand(expected in (folder / "faulty.log").read_text(), f"{fault}: {(folder / 'faulty.log').read_text()}")
        demand(not (folder / "faulty.csv").exists(), f"{fault}: a table")
        (folder / "faulty.log").unlink()
        say(f"not merged: {expected}")


def main():
    os.environ["PATH"] += ":/usr/sbin"
    missing = [each for each in ("munged", "slurmctld", "slurmd", "sbatch") if not shutil.which(each)]
    if missing:
        sys.exit(f"{' and '.join(missing)} missing: make deps-cluster cluster-check")
    plan = {"schema": "impact-damper/plan/1", "scene": {"mass_ratio": 0.02, "until_amplitude": 0.03},
            "grid": [{"number": "restitution", "from": 0.4, "to": 0.8, "count": 10}],
            "samples": {"count": 800, "seed": 1, "numbers": [{"number": "mass_ratio", "half_width": 0.1, "relative": True}]},
            "quantities": ["time_to_amplitude=0.6", "impacts", "impact_energy_share"]}
    write("plan.json", plan)
    call(program, "sweep", "plan.json", "-o", "serial.csv")
    say("serial.csv, by one process")
    adopt_orphans()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: sys.exit(130))
    try:
        configure()
        start_slurm()
        say("Slurm runs")
        disturbed_array()
        faulty_parts()
        return 0
    except AssertionError as fault:
        for log in sorted([*folder.glob("*.out"), *folder.glob("*.log")]):
            print(f"--- {log.name}", *log.read_text(errors="replace").splitlines()[-15:], sep="\n")
        print(f"cluster-check: {fault}", file=sys.stderr)
        return 1
    finally:
        end_all()
        shutil.rmtree(home, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
