"""The table of design charts holds the means that Python's csv module finds in its sweep, of the catalogue's plan and no other.
"""
import csv
import json
import math
import statistics

from trial import call, demand, finish, folder, source, write

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

finish()
