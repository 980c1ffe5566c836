"""The values that the report's text may name, {{NAME}}, and how they are written. None is computed here but by
counting, picking, comparing and dividing; all come from what the program made:

    CLAIM                   what came out for a claim, four digits; CLAIM.paper what the paper prints,
    CLAIM.low, CLAIM.high   the extremes of the ensemble, CLAIM.verdict; CLAIM.NAME a further number, NAME in "also"
    power.CLAIM             percent of the smallest change that turns its verdict (paper/power.json), 0 if another ensemble
                            does; power.CLAIM.number says of what
    count.claims, count.SOURCE, count.SOURCE-VERDICT   of all, or of those of the source paper, quoted or ours
    scene.NAME.FIELD        a number of a scene, defaults among them, or one that a further run of the catalogue changes, of
                            its scene or engine; run.NAME.half_cycles, .impacts, .end_time
    figNN.BLOCK.N.first     of column N of a table's block: the first row's value, or last, least, most, count;
    figNN.BLOCK.N.peak      column N where column 2 is greatest
    bench.TARGET            what the bench measured: TARGET is its words in results.json, joined by "-"
    study.NAME              percent of time saved, by a run of studies.json against its base, on the way to the
                            amplitude study.until; study.NAME.OPTION a number that it changes, such as mass-ratio
    rate.SCENE              average -dA/dt of a decay of Figure 7, divided by the mass ratio (its block "law"); rate.rule
                            what the median of A eta/nu makes of it
    stamp.NUMBER, version, commit, date, year

{{NAME|3}} writes three significant digits, {{NAME|%}} and {{NAME|%3}} a hundred
times the value.
"""
import datetime
import difflib
import hashlib
import json
import re
import subprocess
from pathlib import Path


# Whose claims there are, and the verdicts on them.
VERDICTS = {"paper": ("reproduced", "not reproduced", "corrected", "derived"), "quoted": ("reproduced", "not reproduced"),
            "ours": ("holds", "does not hold")}


class Mistake(Exception):
    """What a reader of standard error can mend."""


def significant(number: float, digits: int) -> str:
    """The number in Markdown; powers of ten and minus signs as people write them."""
    text = f"{number:.{digits}g}"
    if "e" in text and 1e-5 <= abs(number) < 1e7:
        text = f"{float(text):f}".rstrip("0").rstrip(".")
    if "e" in text:
        mantissa, exponent = text.split("e")
        return f"${mantissa}\\times10^{{{int(exponent)}}}$"
    return text.replace("-", "−")


def blocks_of(table: Path) -> dict:
    """Block -> its columns, each a list of numbers."""
    blocks, name = {}, None
    for part in table.read_text(encoding="utf-8").split("\n\n\n")[1:]:
        lines = part.strip().split("\n")
        name = lines[0].removeprefix("# ")
        rows = [line.split() for line in lines if not line.startswith(("#", '"'))]
        blocks[name] = [[float(cell) for cell in column] for column in zip(*rows)]
    return blocks


def of_column(values: list, by: list) -> dict:
    return {"first": values[0], "last": values[-1], "least": min(values), "most": max(values), "count": len(values),
            "peak": values[by.index(max(by))]}


def git(source: Path, *arguments: str) -> str:
    done = subprocess.run(["git", "-C", source, *arguments], capture_output=True, text=True)
    return done.stdout.strip() if done.returncode == 0 else ""


# git writes the time of the commit here when it makes an archive (.gitattributes).
ARCHIVED = "$Format:%ct$"


def state_of(source: Path, program: Path) -> dict:
    """Commit and its date. Without a repository, as in an unpacked archive, the program knows the one and this file
    the other."""
    commit, seconds = git(source, "rev-parse", "--short=12", "HEAD"), git(source, "log", "-1", "--format=%ct")
    if git(source, "rev-parse", "--show-toplevel") != str(source):
        said = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
        commit, seconds = re.search(r"\((.*)\)", said)[1], ARCHIVED if ARCHIVED.isdigit() else "0"
    elif git(source, "status", "--porcelain"):
        commit += " with changes"
    moment = datetime.datetime.fromtimestamp(int(seconds), datetime.timezone.utc)
    return {"commit": commit, "date": moment.strftime("%Y-%m-%d"), "year": moment.strftime("%Y"), "seconds": seconds}


def studies(source: Path, program: Path) -> dict:
    """Times to the same amplitude by runs with one thing changed, against the base's."""
    file = json.loads((source / "paper/report/studies.json").read_text(encoding="utf-8"))

    def run(arguments: list) -> float:
        done = subprocess.run([program, "run", *file["common"], *arguments], capture_output=True, text=True)
        if done.returncode:
            raise Mistake(f"studies.json: {' '.join(arguments)}: {done.stderr.strip()}")
        return float(re.search(r'"end_time": ([^,]*),', done.stdout)[1])

    base = run(file["base"])
    values = {"study.until": float(file["common"][file["common"].index("--until-amplitude") + 1])}
    for study in file["studies"]:
        name, arguments = f"study.{study['name']}", study["arguments"]
        values[name] = 100 * (1 - run(arguments) / base)
        for option, value in zip(arguments[::2], arguments[1::2]):
            if re.fullmatch(r"[\d.e+-]+", value):
                values[f"{name}.{option.removeprefix('--')}"] = float(value)
    return values


class Values:
    """All values by name. `table_of` gives a figure's table, `claims` and `verdicts` the files' entries by id."""

    def __init__(self, source: Path, build: Path, verdicts_file: Path):
        def read(file: Path):
            if not file.exists():
                raise Mistake(f"{file} is missing: make figures verify")
            return json.loads(file.read_text(encoding="utf-8"))

        self.source, self.build, self.out = source, build, build / "paper"
        stated = read(source / "data/claims.json")
        self.claims = {each["id"]: each for each in stated["claims"]}
        self.open = stated["open"]  # statements without a measure: no claims
        self.verdicts = {each["claim"]: each for each in read(verdicts_file)["verdicts"]}
        # As the program writes each of them.
        self.lines = {json.loads(line)["claim"]: line for line in re.findall(r'^ *(\{"claim".*\}),?$', verdicts_file.read_text(), re.M)}
        self.catalogue = read(source / "figures/catalogue.json")
        self.figures = {each["figure"]: each for each in self.catalogue["figures"]}
        self.bench = read(source / "bench/results/results.json")
        self.tables, self.sha256, self.stamps = {}, {}, {}
        self.state = state_of(source, build / "src/impact-damper")
        self.version = re.search(r"project\(impact-damper VERSION (\S+)", (source / "CMakeLists.txt").read_text())[1]
        self.authors = " and ".join(read(source / "paper/facts.json")["authors"])
        self.known = {"version": self.version, **{name: self.state[name] for name in ("commit", "date", "year")}}
        self.used = set()

        for name, claim in self.claims.items():
            told = self.verdicts.get(name)
            if not told:
                raise Mistake(f"{verdicts_file} knows nothing of the claim {name}: make verify")
            self.known |= {name: told["ours"], f"{name}.low": told["low"], f"{name}.high": told["high"],
                           f"{name}.paper": claim["printed"], f"{name}.verdict": told["verdict"]}
            for what, number in told.get("also", {}).items():
                self.known[f"{name}.{what.replace('_', '-')}"] = number["ours"]
            self.known |= {f"{name}.{what.replace('_', '-')}": number for what, number in claim["measure"].items()
                           if isinstance(number, (int, float))}
        self.known["count.claims"] = len(self.verdicts)
        for whose, verdicts in VERDICTS.items():
            of_it = [self.verdicts[name]["verdict"] for name, claim in self.claims.items() if claim.get("source", "paper") == whose]
            self.known[f"count.{whose}"] = len(of_it)
            self.known |= {f"count.{whose}-{verdict.replace(' ', '-')}": of_it.count(verdict) for verdict in verdicts}
        power = read(source / "paper/power.json")
        self.known |= {f"power.{claim}": 0 for claim in power["unsettled"]}
        turned = [(100 * number[way]["change"], f"{number['name'].replace('_', ' ')} of {number['of']}", claim)
                  for number in power["numbers"] if number["value"] for way in ("up", "down")
                  for claim in number.get(way, {}).get("claims", [])]
        for change, number, claim in sorted(turned, reverse=True):
            self.known |= {f"power.{claim}": change, f"power.{claim}.number": number}
        for each in self.catalogue["scenes"]:
            run = read(build / f"runs/exact/{each['scene']}.json")
            self.known |= {f"scene.{each['scene']}.{field}": number for field, number in run["scene"].items()}
            self.known |= {f"run.{each['scene']}.half_cycles": len(run["half_cycles"]["amplitude"]),
                           f"run.{each['scene']}.impacts": sum(run["half_cycles"]["impacts"]),
                           f"run.{each['scene']}.end_time": run["end_time"]}
        for each in self.catalogue["runs"]:
            changed = {**each.get("set", {}), **each.get("engine", {})}
            self.known |= {f"scene.{each['name']}.{what}": number for what, number in changed.items()
                           if isinstance(number, (int, float))}
        for each in self.catalogue["responses"]:
            self.known |= {f"scene.{each['name']}.{what}": number for what, number in each.get("set", {}).items()}
        for number, figure in self.figures.items():
            stem = stem_of(figure)
            table = build / f"series/exact/{stem}.dat"
            stamped = source / "figures" / figure["script"] if figure["table"] == "drawing" else table
            if not stamped.exists():
                raise Mistake(f"{stamped} is missing: make figures")
            self.sha256[number] = hashlib.sha256(stamped.read_bytes()).hexdigest()
            self.stamps[number] = self.sha256[number][:8]
            self.known[f"stamp.{number}"] = f"{self.stamps[number]} · {self.version}"
            if figure["table"] != "drawing":
                for block, columns in blocks_of(table).items():
                    for i, column in enumerate(columns):
                        for what, value in of_column(column, columns[min(1, len(columns) - 1)]).items():
                            self.known[f"{stem}.{block}.{i + 1}.{what}"] = value
        for result in self.bench["results"]:
            name = re.sub(r"[^a-z0-9]+", "-", result["what"].lower()).strip("-")
            self.known[f"bench.{name}"] = result["measured"]
        self.known["bench.processor"] = self.bench["machine"]["processor"]
        self.known["bench.commit"] = self.bench["provenance"]["commit"]
        self.known["bench.reference-operation"] = self.bench["reference_operation"]["nanoseconds"]["median"]
        self.known |= studies(source, build / "src/impact-damper")
        rates = blocks_of(build / "series/exact/fig07.dat")["law"][1]
        self.known |= {f"rate.{curve['scene']}": rate for curve, rate in zip(self.figures["7"]["curves"], rates, strict=True)}
        # With A eta/nu = c the definition eta = -2 A'/A is A' = -c nu/2.
        self.known["rate.rule"] = self.known["product-mid-range"] / 2

    def written(self, name: str, how: str = "") -> str:
        """A value as Markdown."""
        if name not in self.known:
            near = difflib.get_close_matches(name, self.known, 1)
            raise Mistake(f"no value is called {name}" + (f", did you mean {near[0]}?" if near else ""))
        self.used.add(name)
        value = self.known[name]
        if isinstance(value, str):
            return value
        if value is None:
            return "none"
        if how.startswith("%"):
            value, how = 100 * value, how[1:]
        if isinstance(value, int) and not how:
            return str(value)
        return significant(float(value), int(how or 4))


def stem_of(figure: dict) -> str:
    """The name of its table and pictures without their endings."""
    return Path(figure["script"]).stem
