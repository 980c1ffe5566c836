#!/usr/bin/env python3
"""Holds CITATION.cff and codecheck.yml, as paper/refresh made them, and the ro-crate-metadata.json of archives against the rules of their
formats (formats.py), against each other, and against the project; and sees each rule find its fault in a changed copy.

    test_formats.py NEW        a folder like the source folder, by paper/refresh
"""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    from formats import CONTEXT, citation_problems, codecheck_problems, crate_problems, references
    import yaml
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-yaml, python3-jsonschema)")
    sys.exit(77)

SOURCE = Path(__file__).resolve().parents[2]
NEW = Path(sys.argv.pop(1) if len(sys.argv) > 1 else SOURCE)
DESCRIBED = ("CITATION.cff", "codecheck.yml")


def read(name: str) -> bytes:
    new = name.startswith("data/reference/") or name in DESCRIBED
    return ((NEW if new else SOURCE) / name).read_bytes()


def text(name: str) -> str:
    return read(name).decode("utf-8")


def crate_of(reference: Path, folder: Path, **options) -> str:
    return subprocess.run([SOURCE / "paper/describe", "--crate", reference, folder], check=True, stdout=subprocess.PIPE,
                          encoding="utf-8", **options).stdout


CRATE = crate_of(NEW / "data/reference", NEW)


class Formats(unittest.TestCase):
    def found_out(self, problems, changes):
        """Each (what, from, to, told): the text with `from` replaced has a problem that says `told`."""
        for original, old, new, told in changes:
            with self.subTest(f"{old!r} -> {new!r}"):
                self.assertEqual(original.count(old) > 0, True, "no longer holds what is to be replaced")
                found = problems(original.replace(old, new, 1))
                self.assertTrue(any(told in each for each in found), f"{told!r} is not in {found}")

    def test_the_citation_keeps_to_its_format(self):
        self.assertEqual(citation_problems(text("CITATION.cff")), [])

    def test_a_faulty_citation_is_found_out(self):
        whole = text("CITATION.cff")
        self.found_out(citation_problems, [(whole, *change) for change in (
            ('cff-version: "1.2.0"', 'cff-version: "1.3.0"', "/cff-version"),
            ("title: impact-damper", "titel: impact-damper", "'titel' was unexpected"),
            ("message: ", "massage: ", "'message' is a required property"),
            ("type: software", "type: program", "/type"),
            ("- name: The", "- title: The", "/authors/0"),
            ("      - name: anonymous", "      - anonymous", "/references/0/authors/0"),
            ("  - type: generic", "  - type: story", "/references/0/type"),
            ("license: MIT", "doi: MIT", "/doi"),
            ("license: MIT", 'date-released: "2026"', "/date-released"),
            ("license: MIT", "repository-code: here", "/repository-code"),
            ("  - vibration", "  - impact damper", "/keywords"),
            ("abstract: >-", "abstract: [", "no YAML"))])

    def test_the_citation_says_what_is_known_and_no_more(self):
        citation = yaml.safe_load(text("CITATION.cff"))
        facts = json.loads(text("paper/facts.json"))
        version = re.search(r"^project\(impact-damper VERSION (\S+)", text("CMakeLists.txt"), re.M)[1]
        heading = re.search(rf"^## \[{re.escape(version)}\] - (\S+)", text("CHANGELOG.md"), re.M)[1]
        self.assertEqual(citation["version"], version)
        self.assertEqual(facts["released"], None if heading == "Unreleased" else heading)
        self.assertEqual(citation.get("date-released"), facts["released"])
        self.assertIn(f"{facts['license']} License", text("LICENSE"))
        self.assertIn(f"Copyright (c) {facts['authors'][0]}", text("LICENSE"))
        self.assertFalse({"doi", "identifiers", "repository-code", "url", "commit"} & citation.keys())
        self.assertEqual(citation["references"][0]["authors"], [{"name": "anonymous"}])

    def test_the_codecheck_configuration_keeps_to_its_format(self):
        self.assertEqual(codecheck_problems(text("codecheck.yml"), read), [])

    def test_a_faulty_codecheck_configuration_is_found_out(self):
        whole = text("codecheck.yml")
        self.found_out(lambda changed: codecheck_problems(changed, read), [(whole, *change) for change in (
            ("\n---\n", "\n", "no YAML"),
            ("spec/config/1.0/", "spec/config/9.0/", "version"),
            ("manifest:", "files:", "manifest: not a list"),
            ("series/fig01.dat", "series/fig99.dat", "there is no file data/reference/series/fig99.dat"),
            ("data/reference/series/fig01.dat", "/etc/passwd", "relative path"),
            ("data/reference/series/fig01.dat", "data/../LICENSE", "relative path"),
            ("  - file: ", "  - name: ", "not a file"),
            ("paper:\n", "paper:\n  authors: []\n", "authors must be"),
            ("paper:\n", "paper:\n  authors: [{name: A, ORCID: 0000-0001}]\n", "ORCID"),
            ("paper:\n", "codechecker: [{name: A}]\npaper:\n", "both or"),
            ("paper:\n", "codechecker: []\nreport: https://doi.org/x\npaper:\n", "codechecker: must be"),
            ("paper:\n", "certificate: 12\npaper:\n", "certificate"),
            ("paper:\n", "summary: TODO\npaper:\n", "holds the place"),
            ("paper:\n", "paper: ]\n", "no YAML"))] + [(whole.replace("%YAML 1.1\n", ""), "\n---\n", "\n", "---")])

    def test_the_codecheck_names_every_table_figure_and_verdict_and_no_checker(self):
        checked = yaml.safe_load(text("codecheck.yml"))
        made = {str(path.relative_to(NEW)) for pattern in ("figures/*", "series/*", "verdicts.json")
                for path in (NEW / "data/reference").glob(pattern)}
        self.assertEqual({each["file"] for each in checked["manifest"]}, made)
        self.assertFalse({"codechecker", "report", "certificate", "check_time"} & checked.keys())

    def test_the_crate_keeps_to_its_format_and_profile(self):
        self.assertEqual(crate_problems(CRATE, read), [])

    def test_a_faulty_crate_is_found_out(self):
        def changed(change):
            crate = json.loads(CRATE)
            change(crate, {each["@id"]: each for each in crate["@graph"]})
            return crate_problems(json.dumps(crate), read)

        table, draw = "data/reference/series/fig08.dat", "figures/draw"
        for told, change in (
                ("not @context", lambda crate, of: crate.update({"@context": CONTEXT[0]})),
                ("not @context", lambda crate, of: crate.update(name="a")),
                ("is there twice", lambda crate, of: crate["@graph"].append(of["./"])),
                ("not a list of objects", lambda crate, of: crate["@graph"].append({"@type": "File"})),
                ("neither a text nor", lambda crate, of: of["./"].update(author={"@type": "Person", "name": "A"})),
                ("defined by no context", lambda crate, of: of["./"].update(colour="red")),
                ("@type", lambda crate, of: of["./"].update({"@type": "Datasets"})),
                ("refers to #nobody", lambda crate, of: of["./"].update(author={"@id": "#nobody"})),
                ("conformsTo must be RO-Crate", lambda crate, of: of["ro-crate-metadata.json"].pop("conformsTo")),
                ("about ./", lambda crate, of: of["ro-crate-metadata.json"].update(about={"@id": "#paper"})),
                ("must be a Dataset", lambda crate, of: of["./"].update({"@type": "CreativeWork"})),
                ("datePublished", lambda crate, of: of["./"].pop("datePublished")),
                ("no date of ISO", lambda crate, of: of["./"].update(datePublished="22 November 2026")),
                ("license is missing", lambda crate, of: of["./"].pop("license")),
                ("Process Run Crate", lambda crate, of: of["./"].pop("conformsTo")),
                ("another version", lambda crate, of: of["https://w3id.org/ro/wfrun/process/0.5"].update(version="0.1")),
                ("contentSize", lambda crate, of: of[table].update(contentSize="1")),
                ("another sha256", lambda crate, of: of[table].update(sha256="0" * 64)),
                ("no part of the root", lambda crate, of: of["./"]["hasPart"].remove({"@id": table})),
                ("no such file", lambda crate, of: crate["@graph"].append({"@id": "a.dat", "@type": "File"})),
                ("not a relative path", lambda crate, of: crate["@graph"].append({"@id": "../a.dat", "@type": "File"})),
                ("instrument must be one", lambda crate, of: of["#table-8"].pop("instrument")),
                ("instrument must be one", lambda crate, of: of["#table-8"].update(instrument={"@id": "#paper"})),
                ("one version", lambda crate, of: of[draw].pop("version")),
                ("one version", lambda crate, of: of["#impact-damper"].update(version="1")),
                ("object must be files", lambda crate, of: of["#table-8"].pop("object")),
                ("result must be files", lambda crate, of: of["#table-8"].update(result={"@id": "#paper"})),
                ("agent must be", lambda crate, of: of["#table-8"].update(agent={"@id": "#paper"})),
                ("not mentioned", lambda crate, of: of["./"]["mentions"].remove({"@id": "#table-8"})),
                ("has no description", lambda crate, of: of["#table-8"].pop("description"))):
            with self.subTest(told):
                found = changed(change)
                self.assertTrue(any(told in each for each in found), found)
        self.assertIn("no JSON", crate_problems("{", read)[0])

    def test_the_crate_tells_of_every_figure_how_it_came_from_its_scenes(self):
        crate = {each["@id"]: each for each in json.loads(CRATE)["@graph"]}
        for figure in json.loads(text("data/reference/manifest.json"))["figures"]:
            drawing = crate[f"#picture-{figure['figure']}"]
            self.assertEqual(references(drawing, "result"), [figure["picture"]["file"]])
            self.assertIn(figure["script"]["file"], references(drawing, "object"))
            for table in figure["tables"][:1]:
                self.assertIn(table["file"], references(drawing, "object"))
                making = crate[f"#table-{figure['figure']}"]
                self.assertEqual(references(making, "result"), [table["file"]])
                for scene in figure["scenes"]:
                    self.assertIn(scene["file"], references(making, "object"))

    def test_the_bytes_depend_on_nothing_around(self):
        with tempfile.TemporaryDirectory() as folder:
            reference = Path(folder) / "reference"
            subprocess.run(["cp", "-r", NEW / "data/reference", reference], check=True)
            (reference / "manifest.json").unlink()
            around = {"PATH": os.environ["PATH"], "LC_ALL": "POSIX", "PYTHONUTF8": "0", "PYTHONHASHSEED": "7",
                      "PYTHONCOERCECLOCALE": "0", "TZ": "Asia/Tokyo"}
            subprocess.run([SOURCE / "paper/describe", reference, folder], check=True, env=around, cwd="/")
            for name in DESCRIBED:
                self.assertEqual((Path(folder) / name).read_bytes(), read(name), name)
            self.assertEqual(crate_of(reference, Path(folder), env=around, cwd="/"), CRATE)
            self.assertEqual((reference / "manifest.json").read_bytes(), read("data/reference/manifest.json"))


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    unittest.main()
