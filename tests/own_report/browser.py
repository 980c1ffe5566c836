#!/usr/bin/env python3
"""A report's page in a browser, in units and dimensionless: what a reader sees of it.

    browser.py FOLDER [SCREENSHOTS]

FOLDER holds the pages that scenes.py has made. Exit codes: 1 a fault, 77 there is no Chromium.
"""
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "paper"))
import chromium

FOLDER, SCREENSHOTS = None, None
WIDTHS = {"phone": 390, "desk": 1280}


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.page = chromium.Page()

    @classmethod
    def tearDownClass(cls):
        cls.page.__exit__()

    def each_page(self):
        for file in sorted(FOLDER.glob("*.html")):
            for name, width in WIDTHS.items():
                with self.subTest(f"{file.stem}, {name}"):
                    self.page.open(file.resolve(), width)
                    yield file.stem, name

    def test_pages_fit_and_figures_are_drawn(self):
        for stem, name in self.each_page():
            self.assertEqual(self.page.messages, [], "the browser's console is empty")
            self.assertEqual(self.page.does("document.documentElement.scrollWidth"), WIDTHS[name])
            drawn = self.page.does("""[...document.querySelectorAll("figure.plot svg")].map(svg => {
              const box = svg.getBoundingClientRect();
              return [box.width, box.height, svg.querySelectorAll("path").length];
            })""")
            self.assertTrue(drawn)
            for width, height, paths in drawn:
                self.assertGreater(width, 300)
                self.assertGreater(height, 150)
                self.assertGreater(paths, 3)
            self.assertEqual(self.page.does('document.querySelectorAll("figure.plot .reading").length'), len(drawn))
            if SCREENSHOTS:
                self.page.screenshot(SCREENSHOTS / f"{stem}-{name}.png")

    def test_values_can_be_read_off(self):
        self.page.open((FOLDER / "in-units.html").resolve(), WIDTHS["desk"])
        x, y = self.page.does("""(() => {
          const svg = document.querySelector("#figure-decay svg");
          svg.scrollIntoView({block: "center"});
          const {axes: [{x, y}]} = JSON.parse(svg.querySelector("metadata").textContent);
          const at = new DOMPoint((x[3] + x[4]) / 2, svg.viewBox.baseVal.height - (y[3] + y[4]) / 2)
            .matrixTransform(svg.getScreenCTM());
          return [at.x, at.y];
        })()""")
        self.page.moves(x, y)
        told = self.page.does('document.querySelector("#figure-decay .reading").textContent')
        self.assertRegex(told, r"time in s = [\d.]+, peak amplitude in mm = [\d.]+")
        names = self.page.does('[...document.querySelectorAll(".switches button")].map(b => b.textContent)')
        self.assertIn("secondary mass", names)
        self.assertEqual([name for name in names if re.match("gnuplot", name)], [])

    def test_dark_pages_are_dark(self):
        self.page.open((FOLDER / "in-units.html").resolve(), WIDTHS["phone"], "dark")
        ground = self.page.does("getComputedStyle(document.body).backgroundColor")
        self.assertLess(max(map(int, re.findall(r"\d+", ground)[:3])), 60)
        if SCREENSHOTS:
            self.page.screenshot(SCREENSHOTS / "dark.png")


if __name__ == "__main__":
    if not chromium.program():
        print("skipped: Chromium is not here (Debian: chromium)")
        sys.exit(77)
    FOLDER = Path(sys.argv[1])
    SCREENSHOTS = Path(sys.argv[2]) if len(sys.argv) > 2 else None
    if SCREENSHOTS:
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1])
