"""Holds CITATION.cff and codecheck.yml, as paper/refresh made them, and the ro-crate-metadata.json of archives against the rules of their
formats, as far as these files need them, against each other, and against the project; and sees each rule find its fault in a changed
copy.

    formats.py NEW        a folder like the source folder, by paper/refresh

- Citation File Format 1.2.0, https://citation-file-format.github.io: keys, types and what is required.
- CODECHECK configuration file 1.0, https://codecheck.org.uk/spec/config/1.0/: the part that an author writes. Of who
  checked and with what result the specification wants both or, before the check, none.
- RO-Crate 1.1, https://w3id.org/ro/crate/1.1, with Process Run Crate 0.5, https://w3id.org/ro/wfrun/process/0.5.
"""
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import yaml
    from jsonschema import Draft7Validator
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-yaml, python3-jsonschema)")
    sys.exit(77)

# The rules. Each function returns what is wrong as a list of texts. `read` gives the bytes of a file by its path from the top
# folder and raises OSError where there is none.
TEXT = {"type": "string", "minLength": 1}
DATE = {"type": "string", "pattern": r"^\d{4}-\d\d-\d\d$"}
URL = {"type": "string", "pattern": "^(https?|s?ftp)://"}
DOI = {"type": "string", "pattern": r"^10\.\d{4,9}(\.\d+)?/\S+$"}
WHOLE = {"type": "integer"}


def several(item: dict) -> dict:
    return {"type": "array", "items": item, "minItems": 1, "uniqueItems": True}


def one_of(words: str) -> dict:
    return {"enum": words.split()}


def mapping(required: str, **kinds) -> dict:
    """With these keys only, an underscore for each hyphen."""
    return {"type": "object", "properties": {key.replace("_", "-"): kind for key, kind in kinds.items()},
            "required": required.split(), "additionalProperties": False}


PLACE = dict(address=TEXT, alias=TEXT, city=TEXT, country={"type": "string", "pattern": "^[A-Z]{2}$"}, email=TEXT, fax=TEXT,
             orcid={"type": "string", "pattern": r"^https://orcid\.org/(\d{4}-){3}\d{3}[\dX]$"},
             post_code={"type": ["string", "number"]}, region=TEXT, tel=TEXT, website=URL)
PERSON = mapping("", affiliation=TEXT, family_names=TEXT, given_names=TEXT, name_particle=TEXT, name_suffix=TEXT, **PLACE)
ENTITY = mapping("name", name=TEXT, location=TEXT, date_start=DATE, date_end=DATE, **PLACE)
AUTHORS = several({"anyOf": [PERSON, ENTITY]})
LICENSE = {"type": ["string", "array"], "minLength": 1, "minItems": 1}
IDENTIFIERS = several(mapping("type value", type=one_of("doi url swh other"), value=TEXT, description=TEXT))
COMMON = dict(title=TEXT, authors=AUTHORS, abstract=TEXT, commit=TEXT, contact=AUTHORS, doi=DOI, identifiers=IDENTIFIERS,
              keywords=several(TEXT), license=LICENSE, license_url=URL, repository=URL, repository_artifact=URL,
              repository_code=URL, url=URL, version={"type": ["string", "number"], "minLength": 1}, date_released=DATE)
# Of a reference's many keys those for works like the ones this project can refer to.
REFERENCE = mapping(
    "authors title type", notes=TEXT, year=WHOLE, month={"type": "integer", "minimum": 1, "maximum": 12}, journal=TEXT,
    volume=WHOLE, issue={"type": ["string", "number"]}, start=WHOLE, end=WHOLE, publisher=ENTITY, institution=ENTITY,
    date_published=DATE, conference=ENTITY, collection_title=TEXT, isbn=TEXT, issn=TEXT,
    type=one_of("article book conference-paper data generic manual pamphlet proceedings report software software-code "
                "standard thesis unpublished website"), **COMMON)
CITATION = mapping("authors cff-version message title", cff_version={"const": "1.2.0"}, message=TEXT,
                   type=one_of("software dataset"), preferred_citation=REFERENCE, references=several(REFERENCE), **COMMON)


def yaml_of(text: str):
    """The value, or what is wrong as a string."""
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError as problem:
        return f"no YAML: {problem}"


def citation_problems(text: str) -> list:
    value = yaml_of(text)
    if not isinstance(value, dict):
        return [str(value)]
    return [f"/{'/'.join(map(str, error.path))}: {error.message}" for error in Draft7Validator(CITATION).iter_errors(value)]


def is_inside(name) -> bool:
    """A path that does not leave the folder it starts from."""
    return (isinstance(name, str) and bool(re.fullmatch(r"[^\s\\:?#%]+", name)) and not name.startswith("/") and
            ".." not in name.split("/"))


def named(people) -> bool:
    return isinstance(people, list) and bool(people) and all(isinstance(each, dict) and each.get("name") for each in people)


def codecheck_problems(text: str, read) -> list:
    value = yaml_of(text)
    if not isinstance(value, dict):
        return [str(value)]
    found = []
    if "---" not in text.splitlines():
        found.append("no line --- before the document")
    if not re.fullmatch(r"https://codecheck\.org\.uk/spec/config/1\.0/?", str(value.get("version"))):
        found.append(f"version: not the address of specification 1.0: {value.get('version')}")
    files = value.get("manifest")
    if not isinstance(files, list) or not files:
        files = []
        found.append("manifest: not a list of files")
    for each in files:
        name = each.get("file") if isinstance(each, dict) else None
        if not is_inside(name):
            found.append(f"manifest: not a file by a relative path: {each}")
            continue
        try:
            read(name)
        except OSError:
            found.append(f"manifest: there is no file {name}")
        if not isinstance(each.get("comment", ""), str):
            found.append(f"manifest: the comment on {name} is no text")
    paper = value.get("paper", {})
    if not isinstance(paper.get("title", "none"), str) or not isinstance(paper.get("reference", "none"), str):
        found.append("paper: title and reference must be texts")
    if "authors" in paper and not named(paper["authors"]):
        found.append("paper: authors must be a list of at least one, each with a name")
    people = (paper.get("authors") or []) + (value.get("codechecker") or [])
    found += [f"ORCID: {each['ORCID']}" for each in people if isinstance(each, dict) and "ORCID" in each and
              not re.fullmatch(r"(\d{4}-){3}\d{3}[\dX]", str(each["ORCID"]))]
    if ("codechecker" in value) != ("report" in value):
        found.append("codechecker and report: both or, before the check, none")
    if "codechecker" in value and not named(value["codechecker"]):
        found.append("codechecker: must be a list of at least one, each with a name")
    if not re.fullmatch(r"\d{4}-\d{3}", str(value.get("certificate", "2020-001"))):
        found.append(f"certificate: {value['certificate']}")
    return found + [f"holds the place of something: {word}" for word in re.findall(r"FIXME|TODO|XXXX+", text)]


# The terms that the two contexts define, of those that the project uses: another one would be dropped in silence.
TERMS = set("""@id @type about agent author citation conformsTo contentSize creativeWorkStatus datePublished description
               encodingFormat hasPart identifier instrument keywords license mentions name object result sha256
               softwareRequirements softwareVersion url version""".split())
TYPES = set("""CreateAction CreativeWork Dataset File Organization ScholarlyArticle SoftwareApplication
               SoftwareSourceCode""".split())
CONTEXT = ["https://w3id.org/ro/crate/1.1/context", "https://w3id.org/ro/terms/workflow-run/context"]
TOOLS = {"SoftwareApplication", "SoftwareSourceCode", "ComputationalWorkflow"}


def listed(value) -> list:
    return value if isinstance(value, list) else [] if value is None else [value]


def types(entity: dict) -> set:
    return set(listed(entity.get("@type")))


def references(entity: dict, term: str) -> list:
    return [each["@id"] for each in listed(entity.get(term)) if isinstance(each, dict) and "@id" in each]


def flat_problems(graph) -> list:
    """JSON-LD in flattened form: a list of entities with names, which hold values and names of others, no entities."""
    if not isinstance(graph, list) or not all(isinstance(each, dict) and isinstance(each.get("@id"), str) for each in graph):
        return ["@graph: not a list of objects with @id"]
    found = [f"{each['@id']}: is there twice" for n, each in enumerate(graph)
             if each["@id"] in [other["@id"] for other in graph[:n]]]
    known = {each["@id"] for each in graph}
    for each in graph:
        if not types(each) or not types(each) <= TYPES:
            found.append(f"{each['@id']}: @type {sorted(types(each))}")
        for term, value in each.items():
            if term not in TERMS:
                found.append(f"{each['@id']}: {term} is defined by no context")
            for part in listed(value):
                if not isinstance(part, (str, dict)) or (isinstance(part, dict) and list(part) != ["@id"]):
                    found.append(f"{each['@id']}: {term} is neither a text nor the @id of an entity")
        for term in each:
            outside = each["@id"] == "ro-crate-metadata.json" and term == "conformsTo"
            found += [f"{each['@id']}: {term} refers to {name}, which is no entity" for name in references(each, term)
                      if name not in known and not outside]
    return found


def file_problems(name: str, entity: dict, read) -> list:
    if not is_inside(name):
        return [f"{name}: not a relative path"]
    try:
        content = read(name)
    except OSError:
        return [f"{name}: there is no such file"]
    found = []
    if entity.get("contentSize", str(len(content))) != str(len(content)):
        found.append(f"{name}: contentSize is {len(content)}")
    if "sha256" in entity and entity["sha256"] != hashlib.sha256(content).hexdigest():
        found.append(f"{name}: has another sha256")
    return found


def action_problems(name: str, action: dict, entities: dict) -> list:
    found = []
    for term in ("name", "description"):
        if not action.get(term):
            found.append(f"{name}: has no {term}")
    instruments = references(action, "instrument")
    if len(instruments) != 1 or not types(entities.get(instruments[0], {})) & TOOLS:
        found.append(f"{name}: instrument must be one piece of software")
    for tool in (entities.get(each, {}) for each in instruments):
        if not tool.get("name") or ("version" in tool) == ("softwareVersion" in tool):
            found.append(f"{name}: its instrument must have a name and one version")
    for term in ("object", "result"):
        names = references(action, term)
        if not names or not all(types(entities.get(each, {})) & {"File", "Dataset"} for each in names):
            found.append(f"{name}: {term} must be files")
    if not all("Organization" in types(entities.get(each, {})) for each in references(action, "agent")):
        found.append(f"{name}: agent must be an organization")
    if name not in references(entities.get("./", {}), "mentions"):
        found.append(f"{name}: is not mentioned by the root")
    return found


def crate_problems(text: str, read) -> list:
    try:
        document = json.loads(text)
    except ValueError as problem:
        return [f"no JSON: {problem}"]
    if sorted(document) != ["@context", "@graph"] or document["@context"] != CONTEXT:
        return ["not @context, as RO-Crate and its profile have it, and @graph"]
    found = flat_problems(document["@graph"])
    if found:
        return found
    entities = {each["@id"]: each for each in document["@graph"]}

    descriptor, root = entities.get("ro-crate-metadata.json", {}), entities.get("./", {})
    if types(descriptor) != {"CreativeWork"} or references(descriptor, "about") != ["./"]:
        found.append("ro-crate-metadata.json: must be a CreativeWork about ./")
    if references(descriptor, "conformsTo") != ["https://w3id.org/ro/crate/1.1"]:
        found.append("ro-crate-metadata.json: conformsTo must be RO-Crate 1.1")
    if types(root) != {"Dataset"}:
        found.append("./: must be a Dataset")
    found += [f"./: {term} is missing" for term in ("name", "description", "license", "datePublished") if not root.get(term)]
    if not re.fullmatch(r"\d{4}(-(0[1-9]|1[0-2])(-(0[1-9]|[12]\d|3[01]))?)?", str(root.get("datePublished"))):
        found.append(f"./: datePublished is no date of ISO 8601: {root.get('datePublished')}")
    profiles = [name for name in references(root, "conformsTo") if re.match(r"https://w3id\.org/ro/wfrun/process/0\.\d$", name)]
    if not profiles or types(entities[profiles[0]]) != {"CreativeWork"}:
        found.append("./: conformsTo must be an entity for Process Run Crate")
    elif not profiles[0].endswith(entities[profiles[0]].get("version", "none")):
        found.append(f"{profiles[0]}: has another version")

    parts = references(root, "hasPart")
    for name, each in entities.items():
        if "File" in types(each):
            found += file_problems(name, each, read)
            if name not in parts:
                found.append(f"{name}: is no part of the root")
    actions = {name: each for name, each in entities.items() if "CreateAction" in types(each)}
    if not actions:
        found.append("no CreateAction")
    for name, each in actions.items():
        found += action_problems(name, each, entities)
    return found


# The files.
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
