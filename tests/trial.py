"""What scripts of tests share that are called as SCRIPT PROGRAM FOLDER [WORD...], with this folder in PYTHONPATH (commands.cmake).

`program` is impact-damper or what else is tested, `folder` is made anew by importing this, for the script's files, `words` are
the further ones, `source` is the project's folder. A script ends with finish(). Exit code 1: faults, one a line; 77: what the
script needs is not here.
"""
import hashlib
import json
import pathlib
import re
import shutil
import subprocess
import sys

source = pathlib.Path(__file__).resolve().parents[1]
program, folder = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
words = sys.argv[3:]
if source.is_relative_to(folder):
    sys.exit(f"{folder} is not emptied: the project is in it")
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
faults = []


def stopped(*error):
    """What was found before a script is stopped by an error, and may have caused it, is shown before that."""
    tell_faults()
    sys.__excepthook__(*error)


sys.excepthook = stopped


def demand(holds, what):
    if not holds:
        faults.append(what)
    return holds


def skip(why):
    print(f"skipped: {why}")
    sys.exit(77)


def run(*command, code=0, cwd=folder, **more):
    """A command that ends with this exit code, or with any if None: what subprocess.run() returns."""
    done = subprocess.run(list(map(str, command)), cwd=cwd, capture_output=True, text=True, **more)
    demand(code is None or done.returncode == code,
           f"{' '.join(map(str, command))}: exit code {done.returncode} instead of {code}: {done.stderr}{done.stdout[:2000]}")
    return done


def call(*words, code=0, **more):
    """The program, run in `folder`. Returns what it prints; where an error is wanted, with exit code 2 or higher, or anything,
    what it says of it."""
    done = run(program, *words, code=code, **more)
    return done.stdout if code in (0, 1) else done.stderr


def start(*words, cwd=folder, **more):
    """The program as a process that is not waited for."""
    return subprocess.Popen([program, *map(str, words)], cwd=cwd, text=True,
                            **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **more})


def read(name):
    return (folder / name).read_text(encoding="utf-8")


def read_json(name):
    return json.loads(read(name))


def write(name, content):
    """A text, or a document as JSON."""
    (folder / name).write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8", newline="")


def validator(kind):
    """By the published schema of this kind of files. Ends the script where Python's validator is not installed."""
    try:
        from jsonschema import Draft7Validator, RefResolver
    except ImportError:
        skip("Python's jsonschema is not here (Debian: python3-jsonschema)")
    path = source / f"data/schema/{kind}.schema.json"
    schema = json.loads(path.read_text(encoding="utf-8"))
    Draft7Validator.check_schema(schema)
    return Draft7Validator(schema, resolver=RefResolver(path.as_uri(), schema))


def demand_valid(kind, document, what):
    faults.extend(f"{what}: {list(error.absolute_path)}: {error.message[:200]}" for error in validator(kind).iter_errors(document))


def has_its_digest(text):
    """Whether a file of the program ends with the digest of what is before."""
    body, _, seal = text.rpartition(', "sha256": "')
    return hashlib.sha256(body.encode()).hexdigest() == seal.split('"')[0]


def sealed(text):
    """A run file or table's description that was made or changed by hand, with the digest of its content."""
    body = re.sub(r'(, "sha256": "\w*")?\}\s*\}\s*\Z', "", text)
    return f'{body}, "sha256": "{hashlib.sha256(body.encode()).hexdigest()}"}}\n}}\n'


def tell_faults(most=None):
    print(*(f"FAULT: {str(fault)[:3000]}\n" for fault in faults[:most]), sep="", end="", flush=True)


def finish(summary="", skipped=(), most=None):
    """Shows all faults, or the first `most`. Exit code 77 where nothing is wrong, but not all could be tested here."""
    tell_faults(most)
    print(*(f"SKIPPED: {what}" for what in skipped), f"{summary}{len(faults)} faults", sep="\n")
    sys.exit(1 if faults else 77 if skipped else 0)
