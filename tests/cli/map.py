"""A map of `map` is that of its table: best point, margin and the colour of each cell, as found by Python's csv module.
"""
import csv
import hashlib
import json
import math
import os
import re
import shutil
import statistics

from trial import call, demand, finish, faults, folder, read, sealed, source, write

# The palette, and what of it reads in grey: CIE lightness rises by equal steps.
script = (source / "figures/map.gp").read_text(encoding="utf-8")
palette = [tuple(bytes.fromhex(each)) for each in re.findall(r'\d "#([0-9A-F]{6})"', script)]
demand(len(palette) == 10, f"{len(palette)} colours")


def lightness(colour):
    linear = [c / 255 / 12.92 if c <= 10.31475 else ((c / 255 + 0.055) / 1.055) ** 2.4 for c in colour]
    y = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return 116 * y ** (1 / 3) - 16 if y > 0.008856 else 903.3 * y


steps = [lightness(b) - lightness(a) for a, b in zip(palette, palette[1:])]
demand(min(steps) > 0.75 * statistics.fmean(steps) and max(steps) < 1.25 * statistics.fmean(steps),
       f"lightness rises by {[round(step, 1) for step in steps]}")


def colour_of(part):
    at = min(part, 1 - 1e-12) * (len(palette) - 1)
    low, high = palette[int(at)], palette[int(at) + 1]
    return [a + (b - a) * (at - int(at)) for a, b in zip(low, high)]


def cells_of(table, x, y, z, where, statistic, best):
    """By x and y: the statistic of the draws; None if one has no value, "failed" if one is not done."""
    draws = {}
    for row in csv.DictReader(open(folder / table, newline="", encoding="utf-8")):
        if all(float(row[name]) == value for name, value in where.items()):
            draws.setdefault((float(row[x]), float(row[y])), []).append((row[z], row["end"]))
    worst = {"least": max, "greatest": min}.get(best)
    how = {"median": statistics.median, "mean": statistics.fmean, "worst": worst}[statistic]
    return {point: "failed" if any(end != "done" for _, end in rows) else None if any(not value for value, _ in rows) else
            how([float(value) for value, _ in rows]) for point, rows in draws.items()}


def measured(svg):
    """The picture's axes as they are told in it: value_at(pixel, axis), its height, the axes."""
    axes = json.loads(re.search(r"<metadata>(.*)</metadata>", svg)[1])["axes"][0]

    def value_at(pixel, name):
        _, low, high, from_pixel, to_pixel = axes[name]
        part = (pixel - from_pixel) / (to_pixel - from_pixel)
        return low * (high / low) ** part if name in axes["log"] else low + (high - low) * part

    return value_at, float(re.search(r'<svg[^>]*? height="(\d+)"', svg)[1]), axes


def differences(said, svg, cells, x, y, z, best):
    """What stdout and the picture have otherwise than `cells`."""
    found = []
    xs, ys = (sorted({point[i] for point in cells}) for i in (0, 1))
    values = {point: value for point, value in cells.items() if isinstance(value, float)}
    if best:
        choose = min if best == "least" else max
        top = choose(values.values())
        told = re.search(rf"^best: {z} = (\S+).* at {x} = (\S+?)(?: \w+)?, {y} = ([^ ,\n]+)", said, re.M)
        if not told or not math.isclose(float(told[1]), top, rel_tol=1e-14):
            return [f"best {told and told[0]}, not {top}"]
        here = float(told[2]), float(told[3])
        if not math.isclose(values.get(here, math.nan), top, rel_tol=1e-14):
            found.append(f"best point {here} has {values.get(here)}")
            return found
        i, j = xs.index(here[0]), ys.index(here[1])
        around = [cells[xs[a], ys[b]] for a in (i - 1, i, i + 1) for b in (j - 1, j, j + 1)
                  if 0 <= a < len(xs) and 0 <= b < len(ys) and (a, b) != (i, j)]
        margin = re.search(r"^margin: (\S+)(.*)", said, re.M)
        if any(not isinstance(each, float) for each in around):
            if margin[1] + margin[2][:6] != "no value":
                found.append(f"a neighbour has no value: {margin[0]}")
        else:
            worst = (max if best == "least" else min)(around)
            percent = 100 * abs(worst - top) / abs(top)
            written = float(re.search(r"\([+−](\S+) %\)", margin[0])[1])
            if not math.isclose(float(margin[1]), worst, rel_tol=1e-14) or abs(written - percent) > max(0.5, 0.051 * percent):
                found.append(f"margin {margin[0]}, not {worst}, {percent} %")
            there = re.search(rf"neighbour, {x} = (\S+?)(?: \w+)?, {y} = (\S+)", margin[0])
            if not math.isclose(cells[float(there[1]), float(there[2])], worst, rel_tol=1e-14):
                found.append(f"the worst neighbour is not at {there[0]}")
        at_end = re.search(r"at the end of the grid in (.*):", said)
        ends = [name for name, n, all_n in ((x, i, xs), (y, j, ys)) if n in (0, len(all_n) - 1)]
        if (at_end[1].split(" and ") if at_end else []) != ends:
            found.append(f"at the end in {at_end and at_end[1]}, not {ends}")
    counts = re.search(r"^points: (\d+) with a value, (\d+) empty, (\d+) failed$", said, re.M)
    expected = [len(values), sum(each is None for each in cells.values()), sum(each == "failed" for each in cells.values())]
    if [int(n) for n in counts.groups()] != expected:
        found.append(f"{counts[0]}, not {expected}")

    value_at, height, axes = measured(svg)
    least, most = min(values.values()), max(values.values())
    drawn = {}
    for red, green, blue, points in re.findall(
            r"<polygon fill = 'rgb\(\s*(\d+),\s*(\d+),\s*(\d+)\)' points = '([^']*)'", svg):
        corners = [tuple(map(float, each.split(","))) for each in points.split()]
        left, right = min(c[0] for c in corners), max(c[0] for c in corners)
        bottom, top = height - max(c[1] for c in corners), height - min(c[1] for c in corners)
        if right > axes["x"][4] + 1:
            continue  # the colour bar
        inside = [(a, b) for a in xs for b in ys if value_at(left, "x") < a < value_at(right, "x") and
                  value_at(bottom, "y") < b < value_at(top, "y")]
        if len(inside) == 1:
            drawn[inside[0]] = (int(red), int(green), int(blue))
    for point, value in cells.items():
        wanted = colour_of((value - least) / (most - least)) if isinstance(value, float) else (255, 255, 255)
        if point not in drawn or max(abs(a - b) for a, b in zip(drawn[point], wanted)) > 2.5:
            found.append(f"{point} of {value} has the colour {drawn.get(point)}, not {[round(c) for c in wanted]}")
    return found


plan = {"schema": "impact-damper/plan/1", "scene": {"until_amplitude": 0.3, "until_time": 4000, "damping_ratio": 0.001},
        "grid": [{"number": "restitution", "values": [0.7, 0.3, 0.5]},
                 {"number": "mass_ratio", "from": 0.02, "to": 0.16, "count": 4, "scale": "logarithmic"},
                 {"number": "x0", "values": [2, 5]}],
        "samples": {"count": 5, "seed": 3, "numbers": [{"number": "damping_ratio", "half_width": 0.0005}]},
        "quantities": ["time_to_amplitude=0.5", "lowest_amplitude_above_loss=0.09", "amplitude_of_largest_loss_factor", "impacts"]}
write("plan.json", plan)
call("sweep", "plan.json", "-o", "map.csv")


def drawn(table, x, y, z, *more):
    said = call("map", table, "--x", x, "--y", y, "--z", z, *more, "-o", "map.svg")
    return said, read("map.svg")


def compare(table, x, y, z, where, statistic, best, *more):
    options = [word for name, value in where.items() for word in ("--where", f"{name}={value}")]
    return differences(*drawn(table, x, y, z, *options, "--statistic", statistic, *more),
                       cells_of(table, x, y, z, where, statistic, best), x, y, z, best)


x, y, z, where = "restitution", "mass_ratio", "time_to_amplitude_0.5", {"x0": 5}
for statistic in ("median", "mean", "worst"):
    faults += compare("map.csv", x, y, z, where, statistic, "least")
    faults += compare("map.csv", y, x, "lowest_amplitude_above_loss_0.09", {"x0": 2}, statistic, "least")
    faults += compare("map.csv", x, y, z, {"x0": 2}, statistic, "greatest", "--best", "greatest")
faults += compare("map.csv", x, y, "amplitude_of_largest_loss_factor", where, "median", None)
faults += compare("map.csv", x, y, "impacts", where, "mean", "least")
demand(None in cells_of("map.csv", y, x, "lowest_amplitude_above_loss_0.09", {"x0": 2}, "median", "least").values(),
       "no cell is empty")

# What a map would look like whose axes are transposed, or whose table is a row late: noticed.
cells = cells_of("map.csv", x, y, z, where, "median", "least")
square = {"schema": "impact-damper/plan/1", "scene": {"until_amplitude": 0.3, "until_time": 4000},
          "grid": [{"number": "restitution", "values": [0.3, 0.5, 0.7]}, {"number": "mass_ratio", "values": [0.03, 0.06, 0.12]}],
          "quantities": ["time_to_amplitude=0.5"]}
write("square.json", square)
call("sweep", "square.json", "-o", "square.csv")
upright = cells_of("square.csv", x, y, z, {}, "median", "least")
demand(not differences(*drawn("square.csv", x, y, z), upright, x, y, z, "least"), "the square map differs")
rest, masses = sorted({a for a, _ in upright}), sorted({b for _, b in upright})
transposed = {(rest[i], masses[j]): upright[rest[j], masses[i]] for i in range(3) for j in range(3)}
demand(any("colour" in each for each in differences(*drawn("square.csv", x, y, z), transposed, x, y, z, None)),
       "transposed axes are not noticed")


def resealed(table, text):
    """The table with another text, and beside it what describes it, as if the program had written both."""
    description = read("map.csv.json")
    digest = hashlib.sha256(text.encode()).hexdigest()
    description = re.sub(r'("bytes": )\d+(, "sha256": ")\w*', lambda m: m[1] + str(len(text.encode())) + m[2] + digest, description, count=1)
    write(table, text)
    write(f"{table}.json", sealed(description))


lines = read("map.csv").splitlines()
rows = [line.split(",") for line in lines[1:]]
column = lines[0].split(",").index(z)
shifted = [row[:column] + [other[column]] + row[column + 1:] for row, other in zip(rows, rows[-10:] + rows[:-10])]
resealed("shifted.csv", "\n".join([lines[0], *map(",".join, shifted)]) + "\n")
demand(differences(*drawn("shifted.csv", x, y, z, "--where", "x0=5"), cells, x, y, z, "least"), "shifted rows are not noticed")

# A run that failed: its point is marked.
failed = [row[:column] + [""] * (len(row) - column - 2) + ["failed", '"so, it ""went"" astray"'] if n == 7 else row for n, row in enumerate(rows)]
resealed("failed.csv", "\n".join([lines[0], *map(",".join, failed)]) + "\n")
faults += compare("failed.csv", x, y, z, where, "median", "least")
demand("failed" in cells_of("failed.csv", x, y, z, where, "median", "least").values(), "no cell has failed")
demand("run failed" in read("map.svg"), "no mark of a failed run")


# What is not valid; more of it stands in command_lines.txt.
def rejected(text, *words, code=2, **more):
    said = call("map", *words, code=code, **more)
    demand(text in said and not (folder / "none.svg").exists(), f"{words}: {said}")
    return said


usual = ["map.csv", "--x", x, "--y", y, "--z", z, "--where", "x0=5", "-o", "none.svg"]
said = rejected('--where: must give x0 one of its values: 2, 5; got "x0=3"', *usual[:8], "x0=3", *usual[9:])
demand("must be given" not in said, f"a value that is none of x0's is rejected twice: {said}")
rejected("plan.json.json: cannot be read", "plan.json", *usual[1:], code=5)
rejected("gnuplot: cannot be found in PATH", *usual, code=5, env=dict(os.environ, PATH=str(folder)))
write("altered.csv", "\n".join(lines).replace(rows[3][column], rows[4][column]) + "\n")
shutil.copy(folder / "map.csv.json", folder / "altered.csv.json")
rejected("altered.csv: is not the table that altered.csv.json describes: its length or SHA-256 is another", "altered.csv", *usual[1:], code=3)
demand("altered.csv: is not the table" in call("check", "sweep", "altered.csv", code=3), "check says nothing of a table that was altered")
write("altered.csv", "\n".join(lines) + "\n")
write("altered.csv.json", read("map.csv.json").replace('"seed": 3', '"seed": 4'))
rejected("altered.csv.json", "altered.csv", *usual[1:], code=3)
# A value of the grid as one writes it: the second of four between 0 and 0.3 is 0.09999999999999999.
write("steps.json", dict(square, grid=square["grid"] + [{"number": "y0", "from": 0, "to": 0.3, "count": 4}]))
call("sweep", "steps.json", "-o", "steps.csv")
written, meant = (drawn("steps.csv", x, y, z, "--where", f"y0={value}") for value in ("0.1", "0.09999999999999999"))
demand(written == meant, "0.1 and 0.09999999999999999 are not one value of the grid")
rejected('--where: must give y0 one of its values', "steps.csv", "--x", x, "--y", y, "--z", z, "--where", "y0=0.1000001", "-o", "none.svg")

# The lines of the regimes lie where their formulas say: M15.8.
def lines_of(svg):
    """The dashed lines in vermillion, in values of the axes."""
    value_at, height, axes = measured(svg)
    found = []
    for path in re.findall(r"<path stroke='rgb\(213,  94,   0\)'[^>]*?stroke-dasharray='[^']*'[^>]*? d='([^']*)'", svg):
        pixels = [(float(a), height - float(b)) for a, b in re.findall(r"([\d.]+),([\d.]+)", path)]
        found.append([(value_at(a, "x"), value_at(b, "y")) for a, b in pixels if a <= axes["x"][4] + 1e-6 and axes["y"][3] <= b])
    return [each for each in found if len(each) > 2]


limits = {"schema": "impact-damper/plan/1", "scene": {"until_amplitude": 0.01, "until_time": 400},
          "grid": [{"number": "restitution", "from": 0.05, "to": 0.85, "count": 9},
                   {"number": "x0", "from": 0.05, "to": 20, "count": 9, "scale": "logarithmic"}], "quantities": ["impacts", "time_to_amplitude=0.2"]}
write("limits.json", limits)
call("sweep", "limits.json", "-o", "limits.csv")
call("map", "limits.csv", "--x", "restitution", "--y", "x0", "--z", "impacts", "-o", "limits.svg")
svg = read("limits.svg")
lines = lines_of(svg)
demand(len(lines) == 2, f"{len(lines)} lines of regimes")


def fold(e):
    b = (1 - e) / (1 + e)
    return b / math.sqrt(math.pi ** 2 + 4 * b * b)


for e, amplitude in lines[0] if lines else []:
    demand(abs(amplitude / fold(e) - 1) < 0.01, f"impacts fail at {amplitude} for e = {e}, not at {fold(e)}")
for e, known in ((0.4, 2.05), (0.6, 5.23)):
    near = min(lines[1], key=lambda point: abs(point[0] - e)) if len(lines) > 1 else (0, 0)
    demand(abs(near[0] - e) < 0.01 and abs(near[1] / known - 1) < 0.05, f"bounce-down ends at {near}, for {e} at {known}")
demand("impacts fail below it" in svg and "no bounce-down below it" in svg, "the sides of the lines are not told")
call("map", "limits.csv", "--x", "x0", "--y", "restitution", "--z", "time_to_amplitude_0.2", "-o", "limits.svg")
svg = read("limits.svg")
lines = lines_of(svg)
demand(len(lines) == 1 and all(abs(fold(e) / 0.2 - 1) < 0.01 for _, e in lines[0]), f"asked at 0.2 impacts fail at {lines}")

finish()
