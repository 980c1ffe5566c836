"""What is redone after a change, and what keeps its time stamp.

Ninja's own log says which steps were taken; a file's time stamp says whether it was written.
"""

import json
import os
import sys

import scratch
from trial import demand, finish, folder, program

FIGURES = ["2", "7", "13", "A"]


class Tree:
    def __init__(self):
        self.path = scratch.make_tree(folder / "tree", program, FIGURES)
        self.make("figures")

    def make(self, *targets):
        made = scratch.make(self.path, *targets)
        if made.returncode != 0:
            sys.exit(made.stdout + made.stderr)
        return made.stdout

    def stamps(self):
        return {file: (self.path / file).stat().st_mtime_ns for file in scratch.made_in(self.path)}

    def steps(self):
        log = (self.path / "build" / ".ninja_log").read_text().splitlines()
        return {tuple(line.split("\t")) for line in log if line.count("\t") == 4}

    def after(self, change, what, steps, written):
        """Runs `make figures` after a change and expects these steps, and these files to be new."""
        before, stamps, bytes_before = self.steps(), self.stamps(), scratch.made_in(self.path)
        change()
        self.make("figures")
        new = {output for _, _, _, output, _ in self.steps() - before if output.endswith((".json", ".dat", ".svg"))}
        new = {str((self.path / "build" / step).relative_to(self.path)) for step in new}
        demand(new == set(steps), f"{what}: took the steps {sorted(new)} instead of {sorted(steps)}")
        changed = {file for file, stamp in self.stamps().items() if stamp != stamps.get(file)}
        demand(changed == set(written), f"{what}: wrote {sorted(changed)} instead of {sorted(written)}")
        kept = scratch.made_in(self.path)
        for file in changed:
            demand(kept[file] != bytes_before.get(file), f"{what}: wrote {file} with the same bytes")

    def edit(self, file, change):
        path = self.path / file
        old = path.read_text()
        new = change(old)
        assert new != old, file
        path.write_text(new)


def pictures(*names):
    return [f"build/figures/fig{name}.{kind}" for name in names for kind in ("svg", "pdf", "png")]


def drawn(*names):
    return [f"build/figures/fig{name}.svg" for name in names]


def with_number(key, value):
    def change(text):
        scene = json.loads(text)
        scene[key] = value
        return json.dumps(scene)
    return change


def main():
    tree = Tree()
    table = "build/series/exact/fig{}.dat".format
    run = "build/runs/exact/{}.json".format
    scenes = sorted(file.stem for file in (tree.path / "build" / "runs" / "exact").glob("*.json"))
    of_figures = sorted({scene for each in json.loads((tree.path / "figures" / "catalogue.json").read_text())["figures"]
                         for scene in (curve["scene"] for curve in each.get("curves", []))})
    demand(set(of_figures) <= set(scenes), f"runs: {scenes}")

    tree.after(lambda: None, "nothing changed", [], [])
    demand("up to date" in tree.make("figures"), "make figures does not say that all is up to date")

    program = "build/src/impact-damper"
    tree.after(lambda: os.utime(tree.path / program), "the program built anew, with the same results",
               [run(scene) for scene in scenes] + [table(name) for name in ("02", "07", "13")], [])
    tree.after(lambda: tree.edit("data/scenes/nu1-e06.json", with_number("description", "Told otherwise")),
               "a scene's description changed", [run("nu1-e06")], [])
    tree.after(lambda: tree.edit("data/scenes/nu1-e06.json", with_number("x0", 5.5)), "one scene changed",
               [run("nu1-e06"), table("07"), *drawn("07")], [run("nu1-e06"), table("07"), *pictures("07")])
    tree.after(lambda: tree.edit("figures/catalogue.json",
                                 lambda text: text.replace('"title": "', '"title": "Anew: ', 1)),
               "one figure's title changed", [table(name) for name in ("02", "07", "13")] + drawn("02"),
               [table("02"), *pictures("02")])
    tree.after(lambda: tree.edit("figures/fig13.gp", lambda text: text + "# nothing more\n"),
               "a comment in one figure's script", drawn("13"), [])

    # Claims: verify alone, and no run is made anew.
    claims = json.loads((tree.path / "data" / "claims.json").read_text())
    small = {**claims, "claims": [claim for claim in claims["claims"] if claim["id"] == "largest-loss"]}
    (tree.path / "data" / "claims.json").write_text(json.dumps(small))
    catalogue = json.loads((tree.path / "figures" / "catalogue.json").read_text())
    for figure in catalogue["figures"]:
        figure["claims"] = []
    (tree.path / "figures" / "catalogue.json").write_text(json.dumps(catalogue))
    tree.make("figures", "verify")
    demand('"verdict": "reproduced"' in (tree.path / "build" / "verdicts-exact.json").read_text(), "no verdict")
    steps, stamps = tree.steps(), tree.stamps()

    def wanting_more(text):
        claims = json.loads(text)
        claims["claims"][0].update(digits=["9"], verdict="not reproduced", explanation="planted", evidence="planted")
        return json.dumps(claims)
    tree.edit("data/claims.json", wanting_more)
    text = tree.make("verify")
    demand("largest-loss" in text and "not reproduced" in text, f"verify has not seen the changed claim: {text}")
    demand(tree.steps() == steps, "a changed claim made ninja work")
    changed = {file for file, stamp in tree.stamps().items() if stamp != stamps[file]}
    demand(changed == {"build/verdicts-exact.json"}, f"a changed claim wrote {sorted(changed)}")
    stamps = tree.stamps()
    tree.make("verify")
    demand(tree.stamps() == stamps, "the same verdicts were written again")
    finish("time stamps, ")


if __name__ == "__main__":
    main()
