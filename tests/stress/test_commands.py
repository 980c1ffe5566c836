#!/usr/bin/env python3
"""commands.py notices every way in which a command can fail: here the program is a script that fails in each of them.

    test_commands.py FOLDER        FOLDER, made anew, is for the files
"""
import pathlib
import re
import shutil
import subprocess
import sys

# By the number of the case, which the folder it runs in is named after.
WAYS = ["echo 'no design was found' >&2; exit 1",  # allowed
        "kill -SEGV $$",
        "echo '==1==ERROR: AddressSanitizer: heap-buffer-overflow' >&2; exit 1",
        "echo 'orbits.cpp:1:1: runtime error: index out of bounds' >&2; exit 1",
        "exit 4",
        "echo 'this code is not documented' >&2; exit 99",
        "echo '{\"x\": NaN}' > out.json; printf 'x\\nnan\\n' > out.csv",
        "echo '{\"x\": 1}' > out.json; printf 'x\\n1,2\\n' > out.csv",
        "true",  # no file
        "exec sleep 60"]

folder = pathlib.Path(sys.argv[1]).resolve()
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
program = folder / "program"
program.write_text("#!/bin/sh\ncase ${PWD##*-} in\n" + "".join(f"{n}) {way} ;;\n" for n, way in enumerate(WAYS)) + "esac\n")
program.chmod(0o755)
done = subprocess.run([sys.executable, "-B", pathlib.Path(__file__).with_name("commands.py"), program, folder / "cases", "--only",
                       "run", "--count", str(len(WAYS)), "--timeout", "3", "--seed", "any"], capture_output=True, text=True)
failed = [int(number) for number in re.findall(r"^FAILED run:(\d+)", done.stdout, re.MULTILINE)]
print(done.stdout, done.stderr)
sys.exit(done.returncode != 1 or failed != list(range(1, len(WAYS))))
