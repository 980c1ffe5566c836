"""The file of verdicts holds the further numbers of a claim that its words show, and what is open counts as no claim.

    verdicts.py PROGRAM FILES FOLDER        FILES holds those of files.packed; FOLDER, made anew, is for what is written

A number that stands beside a claim is measured once more as a claim of its own: both must agree to the last digit.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

program, files, folder = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)


def claim(name, measure, **more):
    return {"id": name, "section": "1", "statement": "s", "printed": "p", "value": 0, "tolerance": 1e9, "reason": "r",
            "measure": measure, "verdict": "reproduced", **more}


LARGEST = {"name": "largest_loss", "scenes": ["small"]}
MIDDLE, HALF = ({"name": name, "scenes": ["small"], "from": 0.5, "to": 6}
                for name in ("product_mid_range", "product_half_range_percent"))
statement = {"id": "unknown", "section": "5", "statement": "Nobody knows | yet", "printed": "perhaps", "explanation": "No engine can."}
content = {"schema": "impact-damper/claims/1", "open": [statement], "claims": [
    claim("all", LARGEST, also={"half_range": HALF, "middle": MIDDLE}, words="{} and {middle} and {half_range}"),
    claim("middle", MIDDLE), claim("half-range", HALF, source="ours", verdict="does not hold", value=1e12,
          explanation="It is {}.", evidence="e")]}
(folder / "claims.json").write_text(json.dumps(content))
subprocess.run([program, "run", "--scene", files / "data/scenes/small.json", "--members", "5", "-o", folder / "small.json"],
               check=True)
done = subprocess.run([program, "verify", "--claims", folder / "claims.json", "--runs", folder, "--scenes",
                       files / "data/scenes", "--members", "5", "-o", folder / "verdicts.json", "--markdown", folder / "table.md"],
                      capture_output=True, text=True)
assert done.returncode == 0, done.stderr

verdicts = json.loads((folder / "verdicts.json").read_text())
all_three, *alone = verdicts["verdicts"]
assert [each["claim"] for each in verdicts["verdicts"]] == ["all", "middle", "half-range"]
assert sorted(all_three["also"]) == ["half_range", "middle"], all_three
for each in alone:
    assert "also" not in each, each
    numbers = {key: each[key] for key in ("ours", "low", "high")}
    assert all_three["also"][each["claim"].replace("-", "_")] == numbers, (all_three, each)
assert len({all_three["ours"]} | {each["ours"] for each in alone}) == 3, "three measures give three numbers"
for each in [all_three, *alone, *all_three["also"].values()]:
    assert each["low"] < each["ours"] < each["high"], each  # of five decays that differ
shown = [float(number) for number in re.findall(r"(?:^|and )([\d.]+)", all_three["words"])]
for number, each in zip(shown, [all_three, *alone], strict=True):
    assert abs(number - each["ours"]) < 1e-3 * number, all_three

assert verdicts["open"] == ["unknown"], verdicts
summary = "2 claims of the paper: 2 reproduced, 0 not reproduced, 0 corrected, 0 derived; 1 of ours: 0 hold, 1 do not hold; all as recorded; besides, 1 statement of the paper is open"
assert done.stdout.endswith(summary + "\n"), done.stdout
assert re.search(r"^unknown  +perhaps  +not measured  +not measured  +open$", done.stdout, re.M), done.stdout
table = (folder / "table.md").read_text()
assert "| unknown | 5 | Nobody knows \\| yet | perhaps | not measured | not measured | No engine can. | open |\n" in table, table
assert summary in table
assert "**half-range** (does not hold). It is %s. Evidence: e\n" % alone[1]["words"] in table, table
print("further numbers agree; open is beside the claims")
