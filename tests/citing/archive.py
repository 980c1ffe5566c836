"""What paper/archive writes, in a repository of its own that holds this source folder and what paper/refresh made of it:
the same bytes from equal commits, whatever is around; everything that the manifest lists, with its sums; the commit.

    archive.py NEW FOLDER      NEW like the source folder, by paper/refresh
"""
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

from trial import demand, faults, finish, skip
from trial import folder as FOLDER, program as NEW, source as SOURCE

COPY, OTHER, BUILD = FOLDER / "copy", FOLDER / "other", FOLDER / "copy/build"

def run(*command, cwd=COPY, **around):
    return subprocess.run(command, cwd=cwd, env={**os.environ, "GIT_CONFIG_NOSYSTEM": "1", **around}, capture_output=True,
                          text=True)


def git(*arguments, cwd=COPY):
    done = run("git", "-c", "user.name=a", "-c", "user.email=b", *arguments, cwd=cwd, HOME=str(FOLDER),
               GIT_AUTHOR_DATE="2020-02-03T04:05:06Z", GIT_COMMITTER_DATE="2020-02-03T04:05:06Z")
    if done.returncode:
        sys.exit(f"git {arguments}: {done.stderr}")
    return done.stdout


def make_copy():
    shutil.copytree(SOURCE, COPY, symlinks=True,
                    ignore=lambda folder, names: [name for name in names if name in (".git", "__pycache__") or
                                                  (Path(folder) == SOURCE and name.startswith("build"))])
    shutil.copytree(NEW, COPY, dirs_exist_ok=True)
    git("init", "-q")
    git("add", "-A")
    git("commit", "-q", "-m", "a")
    (BUILD / "paper").mkdir(parents=True)
    for name in ("report.html", "report.pdf"):
        (BUILD / "paper" / name).write_text(f"{name} of the test\n")


def archive(cwd=COPY, build=BUILD, **around) -> Path:
    done = run(cwd / "paper/archive", build, **around)
    demand(done.returncode == 0, f"exit code {done.returncode}: {done.stderr}")
    files = [path for path in build.iterdir() if path.is_file()]
    demand(len(files) == 1 and files[0].suffix == ".gz", f"files left: {files}")
    return files[0]


def listed_problems(folder: Path) -> list:
    """What of the manifest is not in `folder` as it says."""
    manifest = json.loads((folder / "data/reference/manifest.json").read_text())
    found, count = [], 0
    for figure in manifest["figures"]:
        for each in [*figure["scenes"], *figure["tables"], *filter(None, [figure.get("csv")]), figure["script"],
                     figure["picture"]]:
            if each["file"].startswith("build/"):
                continue  # to be made: make figures ENGINE=...
            count += 1
            path = folder / each["file"]
            if not path.exists() or hashlib.sha256(path.read_bytes()).hexdigest() != each["sha256"]:
                found.append(f"{each['file']} is not as the manifest says")
    return found + [f"only {count} files are listed"] * (count < 60)


def provenance(source: Path) -> bytes:
    output = FOLDER / "provenance.cpp"
    output.unlink(missing_ok=True)
    done = run("cmake", f"-DSOURCE={source}", f"-DINPUT={source}/src/impact_damper/io/provenance.cpp.in",
               f"-DOUTPUT={output}", "-P", source / "src/provenance.cmake", HOME=str(FOLDER))
    demand(done.returncode == 0, f"provenance: {done.stderr}")
    return output.read_bytes()


if "$Format:" not in (SOURCE / "src/provenance.cmake").read_text():
    skip("these sources are an archive's, and say whose commit they are")
make_copy()
first = archive(TZ="UTC", HOME=str(FOLDER))
bytes_of_first = first.read_bytes()
stamp = first.stat().st_mtime_ns
archive(HOME=str(FOLDER))
demand(first.stat().st_mtime_ns == stamp, "equal bytes get another time stamp")

demand(bytes_of_first[3:8] == bytes(5), "gzip's header has a name or a time")

# Another clone of the same commit, where git is told other things.
(FOLDER / "elsewhere").mkdir()
(FOLDER / "elsewhere/.gitconfig").write_text("[tar]\n umask = 0077\n[core]\n autocrlf = true\n abbrev = 9\n"
                                             "[user]\n name = c\n")
git("clone", "-q", COPY, OTHER, cwd=FOLDER)
shutil.copytree(BUILD / "paper", OTHER / "build/paper")
os.umask(0o077)
other = archive(OTHER, OTHER / "build", TZ="Asia/Tokyo", HOME=str(FOLDER / "elsewhere"), GZIP="-1")
os.umask(0o022)
demand(other.name == first.name and other.read_bytes() == bytes_of_first, "another clone's archive has other bytes")

# What is in it.
with tarfile.open(first) as tar:
    members = tar.getmembers()
    tar.extractall(BUILD / "unpacked")  # in the build folder of a repository, which is not the archive's
name = first.name.removesuffix(".tar.gz")
unpacked = BUILD / "unpacked" / name
demand({member.mtime for member in members} == {1580702706}, "times other than the commit's")
demand({(member.uid, member.uname) for member in members} == {(0, "root")}, "somebody's name")
demand({member.mode for member in members} <= {0o644, 0o755}, "modes of somebody's umask")
files = {member.name.removeprefix(name + "/") for member in members if member.isfile()}
committed = set(git("ls-files", "-z").split("\0")) - {""}
demand(files == committed | {"report.html", "report.pdf", "ro-crate-metadata.json"}, f"files: {files ^ committed}")
differing = [file for file in committed if (unpacked / file).read_bytes() != (COPY / file).read_bytes()]
substituted = re.findall(r"^(\S+) export-subst$", (SOURCE / ".gitattributes").read_text(), re.M)
demand(sorted(differing) == sorted(substituted), f"other bytes than those committed: {differing}")
demand((unpacked / "report.pdf").read_text() == "report.pdf of the test\n", "another report")
crate = json.loads((unpacked / "ro-crate-metadata.json").read_text())
described = {each["@id"]: each["sha256"] for each in crate["@graph"] if "sha256" in each}
demand(len(described) > 60 and all(hashlib.sha256((unpacked / file).read_bytes()).hexdigest() == sum for file, sum in described.items()),
       "the crate has other sums than the files")
faults += listed_problems(unpacked)
sums = run("sha256sum", "-c", "--quiet", "SHA256SUMS", cwd=unpacked / "data/reference")
demand(sums.returncode == 0, f"SHA256SUMS: {sums.stdout}")
commit = git("rev-parse", "--short=12", "HEAD").strip()
demand(provenance(unpacked) == provenance(COPY), "a build from the archive has another provenance")
demand(f'.commit = "{commit}"'.encode() in provenance(unpacked), f"the archive does not know its commit {commit}")
with (COPY / "src/impact_damper/run.cpp").open("a") as file:
    file.write("\n")
demand(f'.commit = "{commit}-dirty"'.encode() in provenance(COPY), "a changed source is not told")

# What is rejected, and leaves the archive as it was.
for what, told in (("changed", " M src/impact_damper/run.cpp"), ("surplus", "?? surplus.txt")):
    done = run(COPY / "paper/archive", BUILD, HOME=str(FOLDER))
    demand(done.returncode == 1 and told in done.stderr, f"{what}: exit code {done.returncode}: {done.stderr}")
    demand(run(COPY / "paper/archive", HOME=str(FOLDER)).returncode == 1, f"{what}: not told beforehand")
    git("checkout", "-q", ".")
    (COPY / "surplus.txt").write_text("typed\n")
(COPY / "surplus.txt").unlink()
(BUILD / "paper/report.pdf").unlink()
done = run(COPY / "paper/archive", BUILD, HOME=str(FOLDER))
demand(done.returncode == 1 and "report.pdf is missing: make paper" in done.stderr, f"no report: {done.stderr}")
demand(first.read_bytes() == bytes_of_first, "a rejection has changed the archive")

# Without room: the old one stays, nothing unfinished, not even of a process that was killed.
(BUILD / "paper/report.pdf").write_text("another report\n")
(BUILD / f".{name}.999999999.tmp.gz").write_text("abandoned")
done = run("sh", "-c", f"ulimit -f 1000; exec {COPY}/paper/archive {BUILD}", HOME=str(FOLDER))
demand(done.returncode == 5 and "cannot be written" in done.stderr, f"no room: exit code {done.returncode}: {done.stderr}")
left = sorted(path.name for path in BUILD.iterdir())
demand(left == sorted([first.name, "paper", "unpacked"]), f"left without room: {left}")
demand(first.read_bytes() == bytes_of_first, "without room the archive is changed")

# These checks, against what is faulty.
(unpacked / "figures/fig08.gp").write_text("\n")
demand(listed_problems(unpacked) == ["figures/fig08.gp is not as the manifest says"], "a changed script is not found out")
script = (OTHER / "paper/archive").read_text()
for told in ("tar.umask=0022", "core.autocrlf=false"):
    demand(script.count(told) == 1, f"paper/archive no longer says {told}")
    (OTHER / "paper/archive").write_text(script.replace(f"-c {told} ", ""))
    git("-c", "core.autocrlf=false", "update-index", "--assume-unchanged", "paper/archive", cwd=OTHER)
    other.unlink()
    done = run(OTHER / "paper/archive", OTHER / "build", HOME=str(FOLDER / "elsewhere"))
    demand(done.returncode == 0 and other.read_bytes() != bytes_of_first, f"without {told}: not found out: {done.stderr}")

if not faults:
    shutil.rmtree(FOLDER)
finish(f"{len(files)} files, {len(bytes_of_first)} bytes, ")
