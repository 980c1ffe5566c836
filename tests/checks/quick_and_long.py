#!/usr/bin/env python3
"""Does `make check` or `make check-long` run each test of CTest? Only what makes a fixture may be run by both.

    quick_and_long.py MAKEFILE BUILD
"""
import json
import re
import subprocess
import sys

makefile, build = sys.argv[1:]
faults = []


def tests(*options):
    """Of each test that ctest would run with these options: its properties, by its name."""
    shown = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1", *options], check=True,
                           stdout=subprocess.PIPE)
    return {test["name"]: {each["name"]: each["value"] for each in test["properties"]}
            for test in json.loads(shown.stdout)["tests"]}


def by_target(target):
    with open(makefile, encoding="utf-8") as file:
        option, regex = re.search(rf"^{target}:.*\n\t@\$\(run_tests\) (-LE?) '(.*)'$", file.read(), re.M).groups()
    return tests(option, regex.replace("$$", "$"))


every, quick, long = tests(), by_target("test"), by_target("check-long")
both = quick.keys() & long.keys()
faults += [f"neither runs {name}" for name in every.keys() - quick.keys() - long.keys()]
faults += [f"both run {name}" for name in both if "FIXTURES_SETUP" not in every[name]]
faults += [f"make check runs {name}, whose label is long" for name in quick if "long" in every[name]["LABELS"]]
if not long:
    faults.append("no test is long")
print(f"{len(every)} tests: {len(quick)} by make check, {len(long)} by make check-long, {len(both)} of them by both")
print(*faults, sep="\n")
sys.exit(bool(faults))
