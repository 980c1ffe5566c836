#!/usr/bin/env python3
"""The report's text and its numbers: none is typed, all follow the results, and equal results make equal bytes.

    report.py BUILD VERDICTS FOLDER     FOLDER is for what is made here

Exit codes: 1 a fault, 77 pandoc is not here.
"""
import argparse
import json
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
TEXT = SOURCE / "paper/report/text.md"
MATHEMATICS = SOURCE / "docs/mathematics.md"
BUILD, VERDICTS, FOLDER = None, None, None


def made(name: str, *options: str, verdicts: Path = None) -> Path:
    """The folder of a report."""
    out = FOLDER / name
    subprocess.run([SOURCE / "paper/report/make.py", BUILD, "--verdicts", verdicts or VERDICTS, "--out", out, *options],
                   check=True)
    return out


def copied() -> Path:
    """A copy of what the report is made from."""
    copy = FOLDER / "source"
    shutil.rmtree(copy, ignore_errors=True)
    for part in ("paper", "src/wasm", "data", "docs", "figures", "bench/results", "tests/stress/results"):
        shutil.copytree(SOURCE / part, copy / part, ignore=shutil.ignore_patterns("reference"))
    shutil.copy(SOURCE / "CMakeLists.txt", copy)
    return copy


def rejected(copy: Path) -> str:
    """What is said of a report that cannot be made, of which nothing may be written."""
    out = FOLDER / "rejected"
    shutil.rmtree(out, ignore_errors=True)
    done = subprocess.run([copy / "paper/report/make.py", BUILD, "--html", "--verdicts", VERDICTS, "--out", out],
                          capture_output=True, text=True)
    if done.returncode != 1 or list(out.iterdir()):
        raise AssertionError(f"exit code {done.returncode}, {list(out.iterdir())}")
    return done.stderr


def typed(text: str) -> list:
    """Numbers that stand in the text and are none of: a value's name, a figure's, an equation's or a reference's number, a
    year, part of a formula. In a formula only whole numbers of one digit and powers of ten may stand, or it would be a
    value in disguise."""
    text = re.sub(r"\{\{[^{}]*\}\}|^::: figure .*$|\(#reference-\d+\)", "", text, flags=re.M)
    text = re.sub(r"^::: equation .*\n((?:.*\n)*?):::$", r"$$\1$$", text, flags=re.M)
    text = re.sub(r"[Ee]quations? \(\d+\)( (and|to) \(\d+\))?|\[reference \d+\]|SHA-256", "", text)
    text = re.sub(r"10\^\{-\d+\}", "x", text)
    text = re.sub(r"\b(19|20)\d\d\b", "", text)
    formulas = re.findall(r"\$\$.*?\$\$|\$[^$]*\$", text, re.S)
    found = [number for formula in formulas for number in re.findall(r"\d+\.\d+|\d{2,}|\.\d+", formula)]
    return found + re.findall(r"\d[\d.,]*", re.sub(r"\$\$.*?\$\$|\$[^$]*\$", "", text, flags=re.S))


class TheText(unittest.TestCase):
    def test_no_number_is_typed(self):
        self.assertEqual(typed(TEXT.read_text(encoding="utf-8")), [])

    def test_typed_numbers_are_found(self):
        for fault in ("a loss of 0.339", "$\\nu = 0.02$", "$$A = 12$$", "31 percent", "in 3 runs", "the 10th",
                      "::: equation a\nA = 0.5\n:::\n", "$10^{-9} + 10$"):
            self.assertNotEqual(typed(fault), [], fault)
        for allowed in ("equation (9)", "equations (5) to (8)", "of 1987", "$2\\zeta x'^2$", "{{bench.s3|3}}", "$10^{-9}$",
                         "::: figure 8\nA\n:::\n", "::: equation a\n2\\zeta\n:::\n", "[reference 9](#reference-9)"):
            self.assertEqual(typed(allowed), [], allowed)


def sentences_without_verdict(text: str) -> list:
    """Sentences that say of something that it is confirmed, reproduced or the like, without the field that puts the verdict in."""
    text = re.sub(r"^#.*$", "", re.sub(r"\A---\n(.*\n)*?---\n", "", text), flags=re.M)
    return [sentence for paragraph in text.split("\n\n") for sentence in re.split(r"(?<=[.:;])\s+", paragraph)
            if re.search(r"\b(confirm|corroborat|reproduc|refut|disprov|verif)", re.sub(r"\{\{.*?\}\}", "", sentence))
            and not re.search(r"\{\{[^{}]*[.]verdict\}\}|\{\{count[.]", sentence)]


def comparisons_without_verdict(text: str, verdicts: dict) -> list:
    """Paragraphs and rows of tables that show what the paper prints beside what came out of a claim that is not reproduced, and
    do not put its verdict in. In the sections on what is not reproduced and what is corrected the heading says it."""
    found = []
    for section in re.split(r"^(?=# )", text, flags=re.M):
        if re.search(r"\{#(not-reproduced|corrected)\}", section.partition("\n")[0]):
            continue
        for part in re.split(r"\n\n|\n(?=\|)", section):
            fields = {field.partition("|")[0].rstrip("\\") for field in re.findall(r"\{\{([^{}]*)\}\}", part)}
            found += [name for name, verdict in verdicts.items() if verdict not in ("reproduced", "holds", "derived")
                      and {name, f"{name}.paper"} <= fields and f"{name}.verdict" not in fields]
    return found


def left_out_of_their_section(text: str, verdicts: dict) -> list:
    """Claims that are not reproduced or corrected and are not named in the section on those."""
    def section(name: str) -> str:
        return re.search(rf"^# [^\n]*\{{#{name}\}}\n(.*?)(?=^# )", text, re.M | re.S)[1]

    return [name for name, verdict in verdicts.items() if verdict in ("not reproduced", "corrected")
            and not re.search(rf"\{{\{{{re.escape(name)}(?=[.|}}\\])", section(verdict.replace(" ", "-")))]


class TheVerdicts(unittest.TestCase):
    """No sentence contradicts a verdict: who says one says it by a field."""

    def setUp(self):
        self.text = TEXT.read_text(encoding="utf-8")
        self.verdicts = {each["claim"]: each["verdict"] for each in json.loads(VERDICTS.read_text())["verdicts"]}

    def test_a_verdict_is_put_in_and_not_typed(self):
        self.assertEqual(sentences_without_verdict(self.text), [])
        for fault in ("The rule of thumb is confirmed, up to its last digit.", "Here {{a}} percent are reproduced.",
                      "It is {{a.verdict}}. This reproduces the paper."):
            self.assertEqual(len(sentences_without_verdict(fault)), 1, fault)
        for allowed in ("It is {{a.verdict}}, and so the rest is reproduced.", "# Not reproduced {#not-reproduced}"):
            self.assertEqual(sentences_without_verdict(allowed), [], allowed)

    def test_who_compares_with_the_paper_says_the_verdict(self):
        self.assertEqual(comparisons_without_verdict(self.text, self.verdicts), [])
        fault = "# In short {#in-short}\n\nThe paper gives {{a.paper}}; the result here is {{a|3}}.\n"
        self.assertEqual(comparisons_without_verdict(fault, {"a": "not reproduced"}), ["a"])
        self.assertEqual(comparisons_without_verdict("| {{a.paper}} | {{a\\|3}} |\n| {{a.verdict}} |", {"a": "corrected"}), ["a"])
        self.assertEqual(comparisons_without_verdict(fault, {"a": "reproduced"}), [])
        self.assertEqual(comparisons_without_verdict(fault.replace("is {{a|3}}", "is {{a|3}}, {{a.verdict}}"), {"a": "corrected"}), [])

    def test_every_claim_that_fails_is_in_its_section(self):
        self.assertEqual(left_out_of_their_section(self.text, self.verdicts), [])
        text = "# A {#corrected}\n{{a}}\n# B {#not-reproduced}\n{{b|2}}, {{c.paper}}\n# C\n{{d}}\n"
        verdicts = {"a": "corrected", "b": "not reproduced", "c": "not reproduced", "d": "not reproduced", "e": "reproduced"}
        self.assertEqual(left_out_of_their_section(text, verdicts), ["d"])


class TheReport(unittest.TestCase):
    def test_a_changed_value_changes_the_text(self):
        before = (made("as-it-is", "--html") / "report.html").read_text(encoding="utf-8")
        verdicts = json.loads(Path(VERDICTS).read_text())
        changed = next(each for each in verdicts["verdicts"] if each["claim"] == "product-mid-range")
        said = f"{changed['ours']:.4g}"
        changed["ours"], changed["verdict"] = 0.4321, "reproduced"
        beside = next(each for each in verdicts["verdicts"] if each["claim"] == "collapse-zeta")["also"]["worst"]
        worst, beside["ours"] = f"{beside['ours']:.2g}", 77.0
        other = FOLDER / "verdicts.json"
        other.write_text(json.dumps(verdicts))
        after = (made("changed", "--html", verdicts=other) / "report.html").read_text(encoding="utf-8")
        sentence = r'the\s+middle,\s+here\s+<span\s+class="value"\s+title="product-mid-range">([\d.]+)</span>'
        self.assertEqual(re.search(sentence, before)[1], said)
        self.assertEqual(re.search(sentence, after)[1], "0.4321")
        further = r'title="collapse-zeta.worst">([\d.]+)</span>'
        self.assertEqual((re.search(further, before)[1], re.search(further, after)[1]), (worst, "77"))
        count = r'title="count.paper-not-reproduced">(\d+)<'
        self.assertEqual(int(re.search(count, after)[1]), int(re.search(count, before)[1]) - 1)
        told = r'is\s+<span\s+class="value"\s+title="product-mid-range.verdict">([a-z ]+)</span>\s+in\s+its\s+third\s+digit'
        self.assertEqual((re.search(told, before)[1], re.search(told, after)[1]), ("not reproduced", "reproduced"))
        row = r'<tr id="claim-product-mid-range">.*?</tr>'
        self.assertIn('class="reproduced"', re.search(row, after, re.S)[0])

    def test_the_rate_of_decay_is_the_runs(self):
        page = re.sub(r"\s+", " ", (made("as-it-is", "--html") / "report.html").read_text(encoding="utf-8"))
        for scene, ratio in (("nu1-e06", 0.01), ("nu2-e06", 0.02), ("nu4-e06", 0.04)):
            # Independently of the table: energy, which falls from half the square of the release, over the run's own time.
            cycles = json.loads((BUILD / f"runs/exact/{scene}.json").read_text())["half_cycles"]
            time, amplitude = next((t, a) for t, a in zip(cycles["peak_time"], cycles["amplitude"]) if a <= 0.1)
            rate = (36 - amplitude ** 2) / (6 + amplitude) / (time - cycles["peak_time"][0]) / ratio
            told = re.findall(rf'title="rate.{scene}">([\d.]+)<', page)
            self.assertTrue(told, scene)
            for each in told:  # in two digits or three, of which trailing zeros are not written
                self.assertLess(abs(float(each) - rate), 0.0051 if len(each) == 4 else 0.0006, scene)
        [told] = set(re.findall(r'title="rate.rule">([\d.]+)<', page))
        self.assertEqual(told, "0.17")

    def test_what_is_open_is_listed_and_is_no_claim(self):
        page = (made("as-it-is", "--html") / "report.html").read_text(encoding="utf-8")
        stated = json.loads((SOURCE / "data/claims.json").read_text(encoding="utf-8"))
        for each in stated["open"]:
            row = re.search(rf'<tr id="claim-{each["id"]}">.*?</tr>', page, re.S)[0]
            self.assertIn(">not measured<", row)
            self.assertIn('class="open">open<', row)
        counted = [int(re.search(rf'title="count.{source}">(\d+)<', page)[1]) for source in ("paper", "quoted", "ours")]
        self.assertEqual(sum(counted), len(stated["claims"]))
        self.assertEqual(page.count('<tr id="claim-'), len(stated["claims"]) + len(stated["open"]))

    def test_what_claims_say_is_set(self):
        sys.path.insert(0, str(SOURCE / "paper/report"))
        from blocks import markdown
        for said, wanted in (("A eta_s/nu at nu = 0.02", r"$A\eta_s/\nu$ at $\nu = 0.02$"), ("A clear pattern", "A clear pattern"),
                             ("1e-8 of velocity", "$10^{-8}$ of velocity"), ("d ln eta / d ln nu", r"$d\ln \eta/d\ln \nu$"),
                             ("k = 1e+06", r"$k = 10^{6}$"), ("2 zeta and e = 0.6", r"$2\zeta$ and $e = 0.6$"),
                             ("5e-8 <b> * x_1", r"$5\times 10^{-8}$ \<b\> \* x\_1")):
            self.assertEqual(markdown(said), wanted)
        stated = json.loads((SOURCE / "data/claims.json").read_text(encoding="utf-8"))
        for claim in stated["claims"] + stated["open"]:
            words = re.sub(r"\$[^$]*\$", "", markdown(claim["statement"]))
            self.assertNotRegex(words, r"\b(nu|eta|zeta|sqrt)\b|\^|_", claim["id"])

    def test_the_pdf_says_what_it_is_and_is_full(self):
        if not (shutil.which("latexmk") and shutil.which("pdfinfo")):
            self.skipTest("no LaTeX or no poppler-utils")
        pdf = made("whole") / "report.pdf"
        said = subprocess.run(["pdfinfo", pdf], capture_output=True, text=True, check=True).stdout
        self.assertRegex(said, r"Title: +The impact damped oscillator")
        self.assertRegex(said, r"Author: +The impact-damper developers\n")
        pages = int(re.search(r"Pages: +(\d+)", said)[1])
        for page in range(1, pages):  # the last one may end anywhere
            words = subprocess.run(["pdftotext", "-bbox", "-f", str(page), "-l", str(page), pdf, "-"], capture_output=True,
                                   text=True, check=True).stdout
            height = float(re.search(r'<page width="[\d.]+" height="([\d.]+)"', words)[1])
            feet = sorted(float(foot) for foot in re.findall(r'yMax="([\d.]+)"', words))
            self.assertGreater(feet[-2], 0.6 * height, f"page {page}: its lower third is empty")

    def test_an_unknown_name_is_rejected_and_nothing_is_written(self):
        copy = copied()
        text = copy / "paper/report/text.md"
        text.write_text(text.read_text(encoding="utf-8").replace("{{product-mid-range}}", "{{product-midrange}}"))
        self.assertIn("no value is called product-midrange, did you mean product-mid-range?", rejected(copy))

    def test_equal_results_make_equal_bytes(self):
        whole = [] if shutil.which("latexmk") else ["--html"]
        first, second = (made(name, *whole) for name in ("first", "second"))
        for file in ["report.html"] + ["report.pdf"] * (not whole):
            self.assertEqual((first / file).read_bytes(), (second / file).read_bytes(), file)
        if whole:
            print("(no LaTeX here: the PDF is not compared)")


class TheMarkdown(unittest.TestCase):
    def test_nothing_stands_raw_in_it_and_its_values_are_the_results(self):
        file = FOLDER / "report.md"
        subprocess.run([SOURCE / "paper/report/make.py", BUILD, "--verdicts", VERDICTS, "--markdown", file], check=True)
        text = file.read_text(encoding="utf-8")
        self.assertEqual(re.findall(r"\{\{[a-z]|:::|\{#|\[\]\{|\\ |^---", text, re.M), [])
        verdicts = {each["claim"]: each for each in json.loads(VERDICTS.read_text())["verdicts"]}
        self.assertIn(f"the middle, here {verdicts['product-mid-range']['ours']:.4g}", re.sub(r"\s+", " ", text))


class TheAppendix(unittest.TestCase):
    """docs/mathematics.md in the report."""

    def test_it_is_there_whole(self):
        source = MATHEMATICS.read_text(encoding="utf-8")
        page = (made("as-it-is", "--html") / "report.html").read_text(encoding="utf-8")
        part = page[page.index('<section id="mathematics"'):page.index("</main>")]
        formula = r"<math[ >].*?</math>"
        shown = dict(re.findall(rf'<div id="(M[\d.]+)"\s+class="equation">\s*<p>({formula})</p>\s*<p><span\s+class="number">\(\1\)', part, re.S))
        self.assertEqual(list(shown), re.findall(r"\\tag\{(.*?)\}", source))
        for number, each in shown.items():
            self.assertGreater(len(re.sub("<.*?>", "", each)), 5, number)
        inline = re.sub(r"\$\$.*?\$\$", "", source, flags=re.S).count("$") // 2
        self.assertEqual(len(re.findall(formula, part, re.S)), len(shown) + inline)
        for number in re.findall(r"\*\*Lemma (L\d)", source):
            self.assertRegex(part, rf'<span id="{number}"></span><strong>Lemma\s+{number}')
        for title in re.findall("^##+ (.*)$", source, re.M):
            self.assertIn(f">{title}</h".replace("'", "’"), part.replace("\n", " "))
        words = re.sub("<.*?>", "", re.sub(rf"{formula}|<svg.*?</svg>", "", part, flags=re.S), flags=re.S)
        self.assertEqual(re.findall(r"\$|\\\w+|\{#|:::|\*\*|\]\(", words), [], "what stands raw in the page")
        self.assertNotIn("<annotation", page)

    def test_every_number_in_it_is_a_link_that_lands(self):
        page = (made("as-it-is", "--html") / "report.html").read_text(encoding="utf-8")
        part = page[page.index('<section id="mathematics"'):page.index("</main>")]
        part = re.sub(r"<math[ >].*?</math>|<svg.*?</svg>|<span\s+class=\"number\">.*?</span>|<strong>Lemma.*?</strong>", "", part, flags=re.S)
        anchors = set(re.findall(r'\bid="(.*?)"', page))
        self.assertEqual(set(re.findall('href="#(.*?)"', page)) - anchors, set())
        named = re.sub(r"\$\$.*?\$\$|\$[^$]*\$", "", MATHEMATICS.read_text(encoding="utf-8"), flags=re.S)
        self.assertEqual(re.findall(r'<a\s+href="#(M[\d.]+)">\1</a>', part), re.findall(r"\bM\d+\.\d+", named))
        words = re.sub("<.*?>", "", re.sub(r"<a\s.*?</a>", "", part, flags=re.S), flags=re.S)
        self.assertEqual(re.findall(r"\bM\d+\.\d+|\bL\d\b|\[\d\]|\bchapters? \d|\bFigure \d", words), [])

    def test_what_leads_nowhere_is_rejected(self):
        sys.path.insert(0, str(SOURCE / "paper/report"))
        from blocks import Html
        from mathematics import appendix
        from values import Mistake
        copy, text = copied(), MATHEMATICS.read_text(encoding="utf-8")
        stated = json.loads((SOURCE / "data/claims.json").read_text(encoding="utf-8"))["claims"]
        values = argparse.Namespace(source=copy, claims={each["id"]: each for each in stated}, figures={"B": {}, "F": {}, "9": {}, "12": {}})
        self.assertIn("::: {#M2.1 .equation}", appendix(values, Html(values)))
        for old, new, said in ((r" \tag{M4.1}", "", "has no number"), (r"\tag{M2.2}", r"\tag{M2.1}", "M2.1 stands twice"),
                               ("by (M3.2)", "by (M3.9)", "M3.9 leads nowhere"), ("Lemma L1.", "Lemma L9.", "L9 leads nowhere"),
                               ("[3]", "[0]", r"[0] leads nowhere"), ("chapter 5.3", "chapter 5.9", "chapter 5.9 leads nowhere"),
                               ("Figure 12", "Figure 77", "no figure is called 77"), ("`collapse-carried`", "`collapse`", "no claim is called"),
                               ("(cascade.svg)", "(casacde.svg)", "there is no file casacde.svg"),
                               ("results/results.md", "results/result.md", "there is no file")):
            self.assertIn(old, text)
            (copy / "docs/mathematics.md").write_text(text.replace(old, new, 1), encoding="utf-8")
            with self.assertRaises(Mistake, msg=old) as caught:
                appendix(values, Html(values))
            self.assertIn(said, str(caught.exception))

    def test_formulas_have_the_spaces_of_tex(self):
        sys.path.insert(0, str(SOURCE / "paper/report"))
        from mathematics import tidied
        text = r"($f(t) = -\sin(t)$), $a \sin t$ and $\left(\frac ab\right) - b$."
        page = tidied(subprocess.run(["pandoc", "--from=markdown", "--to=html5", "--mathml"], input=text, capture_output=True,
                                     text=True, check=True).stdout)
        first, second, third = re.findall("<math>.*?</math>", page, re.S)
        self.assertEqual(first.count('stretchy="false"'), 4)
        self.assertIn('<mo>=</mo><mo form="prefix">−</mo><mo lspace="0" rspace="0">sin</mo>', first)
        self.assertIn('<mo lspace="0.167em" rspace="0.167em">sin</mo>', second)
        self.assertEqual(third.count('stretchy="true"'), 2)
        self.assertIn("<mo>−</mo>", third)
        self.assertRegex(page, r'(?s)<span class="line">\(<math>.*</math>\),</span>.*</math>\.</span>')

    def test_a_formula_that_cannot_be_set_is_rejected(self):
        copy, text = copied(), MATHEMATICS.read_text(encoding="utf-8")
        self.assertIn(r"$\nu = m/M$", text)
        (copy / "docs/mathematics.md").write_text(text.replace(r"$\nu = m/M$", r"$\nu = \frac{m$", 1), encoding="utf-8")
        self.assertIn("Could not convert TeX math", rejected(copy))


if __name__ == "__main__":
    if not shutil.which("pandoc"):
        print("skipped: pandoc is not here")
        sys.exit(77)
    BUILD, VERDICTS, FOLDER = (Path(argument).resolve() for argument in sys.argv[1:4])
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=[sys.argv[0]], verbosity=2)
