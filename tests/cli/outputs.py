"""What commands write, by itself or held against each other: outputs.py PROGRAM FOLDER PART, a function of this file, [TABLES]."""
import csv
import json
import math
import pathlib
import re
import shutil
import statistics

import trial
from packed_files import unpack
from trial import call, demand, finish, folder, program, read, read_json, run, source, write


def standard_output():
    """With the name - a command writes to its standard output what it otherwise writes to a file, and nothing else."""
    def printed(*words):
        done = run(program, *words, code=None)
        demand(done.returncode in (0, 1), f"{words}: exit code {done.returncode}: {done.stderr}")  # 1: a check failed, and all is written
        return done.stdout

    forced = ["--mass-ratio", 0.1, "--force-amplitude", 0.05, "--max-periods", 50]
    quick = ["--scene", "mast.json", "--to", 30, "--within", 5, "--share", 0.5, "--neighbours", 100, "--clearance", "20:21",
             "--tolerance", "restitution=0.2", "--engine", "restitution"]
    printed("sweep", "--until-time", 20, "--vary", "x0=1,2", "--vary", "restitution=0.4,0.6", "--keep", "impacts", "-o", "map.csv")
    commands = [
        (["run", "--until-time", 5], "--output", "run.json"),
        (["run", "--until-time", 5, "--format", "csv"], "--output", "run.csv"),
        (["report", "--until-time", 20, "--members", 2, "--without-figures"], "--output", "page.html"),
        (["response", "sweep", *forced, "--vary", "force_frequency=0.9:1.1:2"], "--output", "sweep.json"),
        (["series", "--catalogue", "figures.json", "--runs", "runs", "--figure", 8], "--output", "fig08.dat"),
        (["design", "--scene", "mast.json", "--to", 10, "--dampers", 1], "--output", "boxes.json"),
        (["design", *quick], "--output", "designs.json"),
        (["design", *quick], "--write-plan", "plan.json"),
        (["verify", "--claims", "claims.json"], "--output", "verdicts.json"),
        (["verify", "--claims", "claims.json"], "--markdown", "verdicts.md"),
    ]
    if shutil.which("gnuplot"):
        commands.append((["map", "map.csv", "--x", "x0", "--y", "restitution", "--z", "impacts"], "--output", "map.svg"))
    for words, option, file in commands:
        printed(*words, option, file)
        made = read(file) if (folder / file).exists() else None
        there = sorted(folder.rglob("*"))
        said = printed(*words, option, "-")
        demand(said == made, f"{words} {option} -: {said[:300]!r}, not {made and made[:300]!r}")
        demand(sorted(folder.rglob("*")) == there, f"{words} {option} -: files {set(folder.rglob('*')) - set(there)}")


def verdicts():
    """The file of verdicts holds the further numbers of a claim that its words show, and what is open counts as no claim.

    A number that stands beside a claim is measured once more as a claim of its own: both must agree to the last digit."""
    def claim(name, measure, **more):
        return {"id": name, "section": "1", "statement": "s", "printed": "p", "value": 0, "tolerance": 1e9, "reason": "r",
                "measure": measure, "verdict": "reproduced", **more}

    largest = {"name": "largest_loss", "scenes": ["small"]}
    middle, half = ({"name": name, "scenes": ["small"], "from": 0.5, "to": 6} for name in ("product_mid_range", "product_half_range_percent"))
    write("stated.json", {
        "schema": "impact-damper/claims/1",
        "open": [{"id": "unknown", "section": "5", "statement": "Nobody knows | yet", "printed": "perhaps", "explanation": "No engine can."}],
        "claims": [claim("all", largest, also={"half_range": half, "middle": middle}, words="{} and {middle} and {half_range}"),
                   claim("middle", middle),
                   claim("half-range", half, source="ours", verdict="does not hold", value=1e12, explanation="It is {}.", evidence="e")]})
    call("run", "--scene", "data/scenes/small.json", "--members", 5, "-o", "small.json")
    told = call("verify", "--claims", "stated.json", "--runs", ".", "--scenes", "data/scenes", "--members", 5, "-o", "verdicts.json",
                "--markdown", "table.md")

    found = read_json("verdicts.json")
    all_three, *alone = found["verdicts"]
    demand([each["claim"] for each in found["verdicts"]] == ["all", "middle", "half-range"], found)
    demand(sorted(all_three["also"]) == ["half_range", "middle"], all_three)
    for each in alone:
        demand("also" not in each, each)
        numbers = {key: each[key] for key in ("ours", "low", "high")}
        demand(all_three["also"][each["claim"].replace("-", "_")] == numbers, (all_three, each))
    demand(len({all_three["ours"]} | {each["ours"] for each in alone}) == 3, "three measures give three numbers")
    for each in [all_three, *alone, *all_three["also"].values()]:
        demand(each["low"] < each["ours"] < each["high"], each)  # of five decays that differ
    shown = [float(number) for number in re.findall(r"(?:^|and )([\d.]+)", all_three["words"])]
    for number, each in zip(shown, [all_three, *alone], strict=True):
        demand(abs(number - each["ours"]) < 1e-3 * number, all_three)

    demand(found["open"] == ["unknown"], found)
    summary = "2 claims of the paper: 2 reproduced, 0 not reproduced, 0 corrected, 0 derived; 1 of ours: 0 hold, 1 do not hold; all as recorded; besides, 1 statement of the paper is open"
    demand(told.endswith(summary + "\n"), told)
    demand(re.search(r"^unknown  +perhaps  +not measured  +not measured  +open$", told, re.M), told)
    table = read("table.md")
    for part in ("| unknown | 5 | Nobody knows \\| yet | perhaps | not measured | not measured | No engine can. | open |\n", summary,
                 "**half-range** (does not hold). It is %s. Evidence: e\n" % alone[1]["words"]):
        demand(part in table, f"{part} is not in the table:\n{table}")


def design_charts():
    """The table of design charts holds the means that Python's csv module finds in its sweep, of the catalogue's plan and no other."""
    (folder / "runs").mkdir()
    # The project's own plan, but for fewer releases and values.
    plan = json.loads((source / "figures/design_charts.json").read_text(encoding="utf-8"))
    plan["grid"] = [{"number": "restitution", "values": [0.4, 0.6]}, {"number": "mass_ratio", "values": [0.02, 0.1]}]
    plan["samples"]["count"] = 3
    write("charts.json", plan)
    write("catalogue.json", {"schema": "impact-damper/catalogue/1", "scenes": [], "figures": [
        {"figure": "H", "title": "Charts", "table": "design_charts", "plan": "charts.json", "script": "figH.gp"}]})
    series = ("series", "--catalogue", "catalogue.json", "--runs", "runs", "--scenes", ".", "--figure", "H", "--format", "csv")
    demand("runs/charts.csv.json: cannot be read" in call(*series, code=5), "no sweep, and no word of it")
    call("sweep", "charts.json", "-o", "runs/charts.csv")

    expected = {}
    rows = list(csv.DictReader(open(folder / "runs/charts.csv", newline="", encoding="utf-8")))
    for i, e in enumerate(("0.4", "0.6")):
        for j, nu in enumerate(("0.02", "0.1")):
            draws = [row for row in rows if (row["restitution"], row["mass_ratio"]) == (e, nu)]
            demand(len(draws) == 3, f"{len(draws)} releases for {e}, {nu}")
            for column in [name for name in draws[0] if name.startswith("loss_factor_at_")]:
                losses = [float(row[column]) for row in draws if row[column]]
                if len(losses) == 3:
                    expected[f"curve-{i + 1}-{j + 1}", float(column.rsplit("_", 1)[1])] = (
                        statistics.fmean(losses), min(losses), max(losses))
    demand(len(expected) > 100, f"{len(expected)} points only")
    table = list(csv.DictReader(call(*series).splitlines()))
    found = {(row["block"], float(row["x"])): tuple(float(row[name]) for name in ("y", "low", "high"))
             for row in table if row["block"].startswith("curve")}
    demand(found.keys() == expected.keys(), f"other points: {sorted(found.keys() ^ expected.keys())[:5]}")
    for key in found.keys() & expected.keys():
        demand(all(math.isclose(a, b, rel_tol=1e-14) for a, b in zip(found[key], expected[key])), f"{key}: {found[key]}, not {expected[key]}")
    reading = [row for row in table if row["block"] == "reading"]
    demand(reading and float(reading[0]["y"]) == found["curve-2-1", 1.0][0], "the example is another")

    plan["samples"]["seed"] = 2
    write("charts.json", plan)
    demand("figure H: runs/charts.csv: must be of the plan that is asked for" in call(*series, code=3), "the sweep of another plan is drawn")


# Columns that are ends of an interval at x, by block and number; all others are curves.
ENDS = {("band", 2): "low", ("band", 3): "high", ("spread", 2): "low", ("spread", 3): "high"}
ENDS_OF = {"largest_response": {}, "phase": ENDS | {("stuck", 2): "low", ("stuck", 3): "high"},
           "design_charts": ENDS | {("curve", 3): "low", ("curve", 4): "high"},
           "components": ENDS | {("curve", 3): "low", ("curve", 4): "high"},
           "damper_sets": ENDS | {("set", 3): "low", ("set", 4): "high"}}


def gnuplot_blocks(text):
    """Name, headings and rows of each block; None where a blank line interrupts the rows."""
    for part in text.split("\n\n\n")[1:]:
        lines = part.rstrip("\n").split("\n")
        body = [line for line in lines if not line.startswith("#")]
        yield lines[0][2:], re.findall(r'"([^"]*)"', body[0]), [line.split(" ") if line else None for line in body[1:]]


def wanted_rows(kind, name, headings, rows):
    """(block, curve, x, y, low, high) of each row, in the order of the file."""
    family = re.sub(r"(-\d+)+$", "", name)
    role = {column: ENDS_OF.get(kind, ENDS).get((family, column), "y") for column in range(2, len(headings) + 1)}
    low, high = ([c for c in role if role[c] == end] for end in ("low", "high"))
    curves = [c for c in role if role[c] == "y"]
    for column in curves or high:
        for row in rows:
            if row is None:
                yield (name, headings[column - 1], "", "", "", "")
                continue
            beside = column == (curves or high)[-1]
            yield (name, headings[column - 1], row[0], row[column - 1] if curves else "",
                   row[low[0] - 1] if low and beside else "", row[high[0] - 1] if high and beside else "")


def tables():
    """Each figure's table as CSV, read by Python's csv module, holds the numbers of the table that gnuplot reads, in the folder TABLES.

    Both are read by their own rules: of the one the header, block names, quoted headings and blank lines, of the other
    rows of six cells. Numbers are compared as texts: both have every digit."""
    made, seen = pathlib.Path(trial.words[1]), set()
    for figure in read_json(source / "figures/catalogue.json")["figures"]:
        if figure["table"] == "drawing":
            continue
        stem = pathlib.Path(figure["script"]).stem
        text = (made / f"{stem}.dat").read_text(encoding="utf-8")
        wanted = [row for block in gnuplot_blocks(text) for row in wanted_rows(figure["table"], *block)]
        with open(made / f"{stem}.csv", newline="", encoding="utf-8") as file:
            header, *given = map(tuple, csv.reader(file))
        demand(header == ("block", "curve", "x", "y", "low", "high"), f"{stem}.csv: its header is {header}")
        at = next((i for i, pair in enumerate(zip(given, wanted)) if pair[0] != pair[1]), min(len(given), len(wanted)))
        demand(given == wanted, f"{stem}.csv: {len(given)} rows, {len(wanted)} in {stem}.dat; the first that differs is number {at + 1}: "
                                f"{given[at:at + 1]} and {wanted[at:at + 1]}")
        for cells in given:
            seen.add("".join("-" if cell == "" else "n" for cell in cells[2:]))
            list(map(float, filter(None, cells[2:])))
    # Values, bands, a value with its band: each kind is there. Gaps depend on a chaotic decay; tests/series.cpp has one.
    demand(seen - {"----"} == {"nn--", "n-nn", "nnnn"}, f"kinds of rows: {sorted(seen)}")


PARTS = {"standard_output": standard_output, "verdicts": verdicts, "design_charts": design_charts, "tables": tables}
if trial.words[0] in ("standard_output", "verdicts"):
    unpack(source / "tests/cli/files.packed", folder)
PARTS[trial.words[0]]()
finish()
