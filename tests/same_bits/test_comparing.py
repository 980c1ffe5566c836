#!/usr/bin/env python3
"""Tests of what says that two results differ, and of what renews the committed ones."""
import importlib.machinery
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from differences import compare, differences
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "checks"))
from sources import WORDS, findings  # noqa: E402

SOURCE = Path(__file__).resolve().parents[2]
RUN = b"""{
 "schema": "impact-damper/run/1",
 "scene": {"mass_ratio": 0.02},
 "half_cycles": {
  "peak_time": [0,3.14,6.28],
  "amplitude": [6,5.97,5.94]
 },
 "provenance": {"version": "0.1.0", "commit": "59bb4bc63dad"}
}
"""
TABLE = '''# Figure 8: Loss factor
# Scene nu1-e06: {"mass_ratio": 0.01}


# curve-1
# column 1: peak amplitude A
"amplitude" "ν = 1 %"
5.9 0.5
5.8 0.25

4.7 -1e-3


# theory-1
"amplitude" "closed form"
1 2
3 4
'''.encode()


class WhatDiffersIsNamed(unittest.TestCase):
    def test_equal_bytes_are_no_difference(self):
        self.assertIsNone(compare("a.json", RUN, RUN))
        self.assertIsNone(compare("a.dat", TABLE, TABLE))

    def test_provenance_is_not_compared(self):
        self.assertIsNone(compare("a.json", RUN, RUN.replace(b"59bb4bc63dad", b"unknown")))

    def test_the_last_bit_of_a_run_is_named_by_column_and_row(self):
        found = compare("exact/nu2-e06.json", RUN, RUN.replace(b"5.97", b"5.970000000000001"))
        self.assertEqual(found.first, "column half_cycles/amplitude, row 1: 5.97 and 5.970000000000001")
        self.assertEqual(found.count, 1)
        self.assertAlmostEqual(found.digits, 15.8, places=1)  # log10(6 / 1e-15)

    def test_first_and_worst_row_of_a_table_are_told_apart(self):
        other = TABLE.replace(b"5.8 0.25", b"5.8 0.25000001").replace(b"4.7 -1e-3", b"4.7 1e-3")
        found = compare("fig08.dat", TABLE, other)
        self.assertEqual(found.first, 'block curve-1, column "ν = 1 %", row 2: 0.25 and 0.25000001')
        self.assertEqual(found.worst, 'block curve-1, column "ν = 1 %", row 3: -1e-3 and 1e-3')
        self.assertEqual(found.count, 2)
        self.assertAlmostEqual(found.digits, 2.4, places=1)  # 0.002 of 0.5

    def test_a_second_block_has_rows_of_its_own(self):
        found = compare("fig08.dat", TABLE, TABLE.replace(b"3 4", b"3 5"))
        self.assertEqual(found.first, 'block theory-1, column "closed form", row 2: 4 and 5')

    def test_a_comment_that_differs_is_named_by_its_line(self):
        found = compare("fig08.dat", TABLE, TABLE.replace(b"0.01}", b"0.02}"))
        self.assertIn("line 2: ", found.first)
        self.assertEqual(found.count, 0)

    def test_rows_and_columns_that_are_missing_are_no_numbers_in_common(self):
        self.assertEqual(compare("a.json", RUN, RUN.replace(b",5.94", b"")).digits, float("-inf"))
        self.assertEqual(compare("a.dat", TABLE, TABLE.replace(b"\n3 4", b"")).digits, float("-inf"))

    def test_columns_that_come_in_another_order_have_no_numbers_in_common(self):
        swapped = RUN.replace(b"peak_time", b"x").replace(b"amplitude", b"peak_time")
        self.assertEqual(compare("a.json", RUN, swapped).digits, float("-inf"))

    def test_no_number_is_worse_than_any(self):
        found = compare("fig08.dat", TABLE, TABLE.replace(b"0.5", b"nan").replace(b"0.25", b"-0.25"))
        self.assertIn("0.5 and nan", found.worst)

    def test_a_file_cut_short_is_told_as_such(self):
        self.assertIn("cannot be read", compare("a.json", RUN, RUN[:100]).first)

    def test_numbers_written_in_another_way_differ(self):
        self.assertIn("row 0: 6 and 6.0", compare("a.json", RUN, RUN.replace(b"[6,", b"[6.0,")).first)

    def test_a_picture_is_named_by_its_line(self):
        self.assertEqual(compare("a.svg", b"<svg>\n<a/>", b"<svg>\n<b/>").first, "line 2: <a/> and <b/>")


class TheScan(unittest.TestCase):
    def test_one_word_of_each_subject_is_found_and_comments_and_texts_are_not(self):
        lines = ["std::unordered_map<int, int> m;", 'std::snprintf(t, 9, "%g", x);', "std::time(nullptr);", "rand();",
                 'getenv("HOME");', "new double[9];", "std::map<const Node*, int> m;", "std::reduce(a, b);", "float x;",
                 "// getenv(), rand()", 'throw Error("float");']
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "a.cpp").write_text("\n".join(lines))
            found = findings(Path(folder))
        self.assertEqual([int(text.split(":")[1]) for text in found], list(range(1, len(WORDS) + 1)))
        self.assertEqual({text.split("depends on ")[1] for text in found}, set(WORDS))


class InAFolder(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)


class TheReferenceIsHeldAgainstTheNewOne(InAFolder):
    def make(self, name: str, gnuplot="gnuplot 5.4"):
        folder = self.folder / name
        (folder / "series").mkdir(parents=True)
        (folder / "series/fig08.dat").write_bytes(TABLE)
        (folder / "fig08.svg").write_text("<svg>\n")
        (folder / "made_with.txt").write_text(gnuplot + "\n")
        (folder / "other-engines.sha256").write_text("ab  series/cem/fig08.dat\n")
        self.add_sums(folder)
        return folder

    def add_sums(self, folder: Path):
        command = "find . -type f ! -name SHA256SUMS -printf '%P\\n' | sort | xargs sha256sum > SHA256SUMS"
        subprocess.run(["sh", "-c", command], cwd=folder, check=True)

    def test_what_is_equal_is_content(self):
        self.assertEqual(differences(self.make("old"), self.make("new")), [])

    def test_a_changed_byte_in_a_table_is_told_with_the_worst_row(self):
        old, new = self.make("old"), self.make("new")
        (new / "series/fig08.dat").write_bytes(TABLE.replace(b"0.25", b"0.26"))
        [text] = differences(old, new)
        self.assertIn('series/fig08.dat: first at block curve-1, column "ν = 1 %", row 2: 0.25 and 0.26', text)
        self.assertIn('worst of 1: block curve-1, column "ν = 1 %", row 2: 0.25 and 0.26, 1.7 digits in common', text)

    def test_a_committed_file_without_its_sum_is_told(self):
        old, new = self.make("old"), self.make("new")
        for folder in (old, new):
            (folder / "series/fig08.dat").write_bytes(TABLE.replace(b"0.25", b"0.26"))
        self.assertEqual(differences(old, new), ["committed series/fig08.dat: does not have the sum in SHA256SUMS"])

    def test_a_table_that_is_made_no_more_is_told(self):
        old, new = self.make("old"), self.make("new")
        (new / "series/fig08.dat").unlink()
        self.assertIn("is missing", differences(old, new)[0])

    def test_another_engine_s_table_is_told_by_its_sum(self):
        old, new = self.make("old"), self.make("new")
        (new / "other-engines.sha256").write_text("cd  series/cem/fig08.dat\n")
        self.assertEqual(differences(old, new), ["series/cem/fig08.dat: another SHA-256 sum than in other-engines.sha256"])

    def test_bytes_of_pictures_are_compared_where_gnuplot_is_the_same_and_what_they_show_where_it_is_another(self):
        old = self.make("old")
        picture = (SOURCE / "data/reference/figures/fig08.svg").read_text()
        (old / "fig08.svg").write_text(picture)
        self.add_sums(old)
        curve = re.search('<g id="fig08-gnuplot_plot_2".*?(?=<g id)', picture, re.S)[0]
        for name, gnuplot, wanted in (("same", "gnuplot 5.4", 1), ("other", "gnuplot 6.0", 0)):
            new = self.make(name, gnuplot)
            # As gnuplot 6 draws it: other attributes, and positions of another rounding.
            (new / "fig08.svg").write_text(re.sub(r"\.\d\d(?=,\d)", ".00", picture).replace('plot_2" >', 'plot_2"  fill="none">'))
            self.assertEqual(len(differences(old, new)), wanted)
            for fault in (picture.replace("closed forms", "closed form"), picture.replace("0.03, 7,", "0.03, 8,"),
                          picture.replace("111.75", "114"), picture.replace(curve, ""), "<svg>\n",
                          picture.replace(curve, re.sub(r",(\d\d\d)\.", lambda y: f",{int(y[1]) + 3}.", curve)),
                          picture.replace(curve, re.sub("(d='M[^L]* L[^L]*)[^']*", r"\1", curve))):
                self.assertNotEqual(fault, picture)
                (new / "fig08.svg").write_text(fault)
                self.assertEqual(len(differences(old, new)), 1)
            (new / "fig08.svg").write_text(picture)
            (new / "manifest.json").write_text('{"sha256": "ab"}')
            self.assertEqual(len(differences(old, new)), wanted)


class RenewingTheReference(InAFolder):
    """paper/renew in a repository of its own, with a paper/refresh, a cmake and a program that only pretend."""
    CHANGELOG = "# Changelog\n\n## [0.1.0] - Unreleased\n\n### Added\n\n- All of it.\n"

    def setUp(self):
        super().setUp()
        for part in ("paper", "data/reference", "bin", "build/src"):
            (self.folder / part).mkdir(parents=True)
        shutil.copy(SOURCE / "paper/renew", self.folder / "paper/renew")
        self.script("bin/cmake", "exit 0")
        self.script("paper/refresh", f"cp {self.folder}/build/verdicts.json {self.folder}/data/reference/")
        self.script("build/src/impact-damper", 'echo "$*"; echo "$*" >paper/power.md')
        (self.folder / "CHANGELOG.md").write_text(self.CHANGELOG)
        (self.folder / ".gitignore").write_text("build/\n")
        self.verdicts("data/reference", 0.33651, 5.0623)
        self.git("init", "-q")
        self.commit()

    def script(self, name: str, text: str):
        (self.folder / name).write_text(f"#!/bin/sh\n{text}\n")
        (self.folder / name).chmod(0o755)

    def verdicts(self, folder: str, middle, end, verdict="reproduced"):
        rows = (f'{{"claim": "product-mid-range", "ours": {middle}, "verdict": "reproduced"}}',
                f'{{"claim": "bounce-down-end", "ours": {end}, "verdict": "{verdict}"}}')
        (self.folder / folder / "verdicts.json").write_text(f'{{"verdicts": [{",".join(rows)}]}}')

    def git(self, *arguments):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=b", *arguments], cwd=self.folder, check=True,
                       stdout=subprocess.DEVNULL)

    def commit(self):
        self.git("add", "-A")
        self.git("commit", "-q", "-m", "a")

    def renew(self):
        environment = dict(os.environ, PATH=f"{self.folder}/bin:{os.environ['PATH']}")
        return subprocess.run([self.folder / "paper/renew", self.folder / "build"], env=environment,
                              capture_output=True, text=True)

    def changelog(self):
        return (self.folder / "CHANGELOG.md").read_text()

    def test_a_dirty_tree_is_rejected_and_named(self):
        self.verdicts("build", 1, 2)
        (self.folder / "CHANGELOG.md").write_text("typed")
        (self.folder / "new.txt").write_text("typed")
        done = self.renew()
        self.assertEqual(done.returncode, 1)
        self.assertIn("nothing is renewed", done.stderr)
        self.assertIn(" M CHANGELOG.md", done.stderr)
        self.assertIn("?? new.txt", done.stderr)
        self.assertIn("0.33651", (self.folder / "data/reference/verdicts.json").read_text())

    def test_what_is_in_no_repository_is_rejected(self):
        shutil.rmtree(self.folder / ".git")
        self.assertEqual(self.renew().returncode, 1)

    def test_a_claim_that_moved_is_noted_and_rounding_is_counted(self):
        self.verdicts("build", 0.33678, 5.06230001)
        done = self.renew()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.changelog(), self.CHANGELOG + "\n### Changed\n\n- Claim `product-mid-range`: "
                         "0.3365 (reproduced) before, 0.3368 (reproduced) now.\n")
        self.assertIn("1 claims moved, and are noted in CHANGELOG.md; 1 by less", done.stdout)
        self.assertRegex((self.folder / "paper/power.md").read_text(), "^verify --power .*-o paper/power.json --markdown paper/power.md")

    def test_a_verdict_that_moved_is_noted(self):
        self.verdicts("build", 0.33651, "null", "not reproduced")
        self.renew()
        self.assertIn("- Claim `bounce-down-end`: 5.062 (reproduced) before, none (not reproduced) now.",
                      self.changelog())

    def test_a_second_renewal_keeps_the_released_value_and_a_return_is_no_change(self):
        for middle, line in ((0.4, "- Claim `product-mid-range`: 0.3365 (reproduced) before, 0.4 (reproduced) now.\n"),
                             (0.5, "- Claim `product-mid-range`: 0.3365 (reproduced) before, 0.5 (reproduced) now.\n"),
                             (0.33651, "- All of it.\n")):
            self.verdicts("build", middle, 5.0623)
            self.renew()
            self.assertTrue(self.changelog().endswith(line), self.changelog())
            self.commit()

    def test_a_renewal_that_moves_nothing_leaves_the_changelog(self):
        self.verdicts("build", 0.33651, 5.0623)
        self.renew()
        self.assertEqual(self.changelog(), self.CHANGELOG)


class TheChangelog(unittest.TestCase):
    def setUp(self):
        loader = importlib.machinery.SourceFileLoader("renew", str(SOURCE / "paper/renew"))
        spec = importlib.util.spec_from_loader("renew", loader)
        self.renew = importlib.util.module_from_spec(spec)
        loader.exec_module(self.renew)

    def test_a_released_version_is_not_touched(self):
        text = "# Changelog\n\n## [0.1.0] - 2024-01-01\n\n### Changed\n\n- Old.\n"
        noted = self.renew.noted(text, {"a": ("1", "2")})
        self.assertEqual(noted, "# Changelog\n\n## [Unreleased]\n\n### Changed\n\n- Claim `a`: 1 before, 2 now.\n\n" +
                         text.split("\n\n", 1)[1])

    def test_lines_go_to_the_end_of_what_is_changed_already(self):
        text = "## [Unreleased]\n\n### Changed\n\n- Old.\n\n### Fixed\n\n- A fault.\n\n## [0.1.0]\n"
        noted = self.renew.noted(text, {"a": ("1", "2")})
        self.assertEqual(noted, text.replace("- Old.\n", "- Old.\n- Claim `a`: 1 before, 2 now.\n"))


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    unittest.main()
