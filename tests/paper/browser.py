"""The report, or reports about scenes, in a browser: what a reader sees, clicks and hears of them.

    browser.py Report PAGE TABLES [SCREENSHOTS]      PAGE is the report, TABLES the folder of the tables behind its figures
    browser.py ReportsAboutScenes FOLDER [SCREENSHOTS]      FOLDER holds the pages that own_report/scenes.py has made

SCREENSHOTS, if given, is filled with pictures to look at. Exit codes: 1 a fault, 77 there is no Chromium.
"""
import json
import re
import sys
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from browsers import WIDTHS, InABrowser, demand_chromium

SOURCE = Path(__file__).resolve().parents[2]
PAGE, TABLES, FOLDER, SCREENSHOTS = None, None, None, None
FIGURES = {figure["figure"]: figure for figure in json.loads((SOURCE / "figures/catalogue.json").read_text())["figures"]}
CHAPTERS = len(re.findall(r"^## \d+[.]", (SOURCE / "docs/mathematics.md").read_text(encoding="utf-8"), re.MULTILINE))


def luminance(colour: str) -> float:
    """Relative luminance of "rgb(r, g, b)", WCAG 2.1."""
    parts = [float(part) / 255 for part in re.findall(r"[\d.]+", colour)[:3]]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


class Report(InABrowser):
    def test_it_asks_for_nothing_outside(self):
        text = re.sub(r"<script>.*?</script>", "", PAGE.read_text(encoding="utf-8"), flags=re.S)
        outside = re.findall(r"""(?:src|href|action|data)\s*=\s*["'](?!#|data:,)[^"']*|url\((?!#)[^)]*|@import[^;]*""", text)
        self.assertEqual(outside, [])

    def test_every_figure_is_drawn(self):
        for _ in self.each_width(PAGE):
            drawn = self.page.does("""[...document.querySelectorAll("figure.plot")].map(figure => {
              const box = figure.querySelector("svg").getBoundingClientRect();
              return [figure.id, box.width, box.height, figure.querySelectorAll("svg path").length];
            })""")
            self.assertEqual(sorted(each[0] for each in drawn), sorted(f"figure-{number}" for number in FIGURES))
            for name, width, height, paths in drawn:
                self.assertGreater(width, 300, name)
                self.assertGreater(height, 150, name)
                self.assertGreater(paths, 10, name)
        alike = self.page.does("""(() => {
          const seen = new Set(), twice = [];
          for (const {id} of document.querySelectorAll("[id]")) seen.has(id) ? twice.push(id) : seen.add(id);
          return twice;
        })()""")
        self.assertEqual(alike, [], "no two things have one name")

    def test_every_link_lands(self):
        self.page.open(PAGE, WIDTHS["desk"])
        lost = self.page.does("""[...document.querySelectorAll("a[href]")].map(a => a.getAttribute("href"))
          .filter(href => !href.startsWith("blob:"))  // what the page itself holds: see below
          .filter(href => !(href.startsWith("#") && document.getElementById(href.slice(1))))""")
        self.assertEqual(lost, [])
        self.assertGreater(self.page.does('document.querySelectorAll("a[href]").length'), 30)

    def test_the_contents_list_the_chapters_of_the_appendix(self):
        for _ in self.each_width(PAGE):
            seen = self.page.does("""[...document.querySelectorAll('nav a[href^="#mathematics-"]')]
              .filter(a => a.getBoundingClientRect().height > 0).map(a => a.textContent)""")
            self.assertEqual([int(each.split(".")[0]) for each in seen], list(range(1, CHAPTERS + 1)))

    def test_every_figure_offers_its_drawing_and_its_table(self):
        self.page.open(PAGE, WIDTHS["desk"])
        for number, figure in FIGURES.items():
            offered = self.page.does(f"""Promise.all([...document.querySelectorAll("#figure-{number} .files a")]
              .map(async a => [a.download, await (await fetch(a.href)).text()]))""")
            stem = Path(figure["script"]).stem
            (drawing, svg), *tables = offered
            self.assertEqual(drawing, f"{stem}.svg")
            root = ElementTree.fromstring(svg)
            self.assertEqual([root.get(side) for side in ("width", "height")], root.get("viewBox").split()[2:])
            self.assertEqual(dict(tables), {} if figure["table"] == "drawing" else
                             {f"{stem}.csv": (TABLES / f"{stem}.csv").read_text(encoding="utf-8")})

    def test_every_curve_has_its_own_name(self):
        self.page.open(PAGE, WIDTHS["desk"])
        names = self.page.does("""Object.fromEntries([...document.querySelectorAll("figure.plot")].map(figure =>
          [figure.id, [...figure.querySelectorAll(".switches button")].map(button => button.textContent)]))""")
        for figure, curves in names.items():
            self.assertEqual(len(curves), len(set(curves)), figure)
            for curve in curves:
                self.assertNotRegex(curve, "gnuplot|table index|using", figure)
        for number in range(1, 4):
            self.assertEqual(set(names[f"figure-{number}"]) - {"stuck"}, {"secondary mass", "impacts", "cavity"})
        self.assertIn("closed forms, ν → 0", names["figure-15"])
        told = set()
        self.page.does('document.querySelector("#figure-1 svg").focus()')
        for _ in range(8):
            self.page.presses("ArrowDown")
            told.add(self.page.does('document.querySelector("#figure-1 .reading").textContent').split(":")[0])
        self.assertLessEqual(told, {"secondary mass", "impacts", "cavity", "stuck"})

    def test_a_telephone_shows_letters_and_verdicts(self):
        self.page.open(PAGE, WIDTHS["phone"])
        smallest = self.page.does("""Math.min(...[...document.querySelectorAll("figure svg text")].map(text => {
          const svg = text.ownerSVGElement;
          return parseFloat(getComputedStyle(text).fontSize) * svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
        }))""")
        self.assertGreater(smallest, 8, "pixels; a stamp is the smallest")
        hidden = self.page.does(f"""[...document.querySelectorAll("td[data-head=verdict]")].filter(cell => {{
          const {{left, right, width}} = cell.getBoundingClientRect();
          return !(width > 0 && left >= 0 && right <= {WIDTHS["phone"]});
        }}).length""")
        self.assertEqual(hidden, 0)

    def test_nothing_is_wider_than_the_window(self):
        for name in self.each_width(PAGE):
            width = WIDTHS[name]  # a telephone's browser would widen the page, and with it innerWidth
            self.assertEqual(self.page.does("document.documentElement.scrollWidth"), width)
            wide = self.page.does(f"""[...document.querySelectorAll("main *")].filter(each =>
              !each.closest(".wide, pre, svg, math") && each.getBoundingClientRect().right > {width} + 1)
              .map(each => each.tagName + each.className)""")
            self.assertEqual(wide, [])
            if SCREENSHOTS:
                self.page.screenshot(SCREENSHOTS / f"{name}.png")

    def test_the_value_under_the_cursor_is_the_tables(self):
        block = (TABLES / "fig08.dat").read_text(encoding="utf-8").split("# curve-2\n")[1].split("\n\n\n")[0]
        rows = [tuple(map(float, line.split())) for line in block.split("\n") if line and line[0].isdigit()]
        for name in self.each_width(PAGE):
            for amplitude, eta in (rows[50], rows[250], rows[-30]):
                x, y = self.page.does(f"""(() => {{
                  const svg = document.querySelector("#figure-8 svg");
                  svg.scrollIntoView({{block: "center"}});
                  const box = svg.parentNode;  // on a telephone the drawing is scrolled until the value is in sight
                  const {{axes: [{{x, y}}]}} = JSON.parse(svg.querySelector("metadata").textContent);
                  const part = ([, low, high], value) => Math.log(value / low) / Math.log(high / low);
                  const across = x[3] + (x[4] - x[3]) * part(x, {amplitude});
                  box.scrollLeft = across / svg.viewBox.baseVal.width * svg.clientWidth - box.clientWidth / 2;
                  const at = new DOMPoint(across, svg.viewBox.baseVal.height - y[3] - (y[4] - y[3]) * part(y, {eta}))
                    .matrixTransform(svg.getScreenCTM());
                  return [at.x, at.y];
                }})()""")
                self.page.moves(x, y)
                told = self.page.does('document.querySelector("#figure-8 .reading").textContent')
                found = re.fullmatch(r"ν = 2 %: A = ([\d.]+), η = ([\d.]+)", told)
                self.assertTrue(found, told)
                # A pixel of a phone is two hundredths of the ordinate's range, which is logarithmic over 2.9 decades.
                self.assertAlmostEqual(float(found[1]) / amplitude, 1, delta=0.03)
                self.assertAlmostEqual(float(found[2]) / eta, 1, delta=0.05)
                box = self.page.does("""(() => {
                  const {left, right} = document.querySelector("#figure-8 .reading").getBoundingClientRect();
                  return [left, %d - right];
                })()""" % WIDTHS[name])
                self.assertGreaterEqual(min(box), 0, f"{name}: the value stands within the window")
            if SCREENSHOTS and name == "desk":
                self.page.screenshot(SCREENSHOTS / "hovered.png", "#figure-8")

    def test_every_mark_is_a_value_and_the_legends_sample_is_none(self):
        self.page.open(PAGE, WIDTHS["desk"])
        of_curve = """[...document.querySelectorAll("#figure-15 svg g[id*=gnuplot_plot_]")]
          .find(group => group.querySelector("text") && group.querySelector("use")).querySelectorAll("use")"""
        for index, is_value in ((0, True), (-1, False)):
            x, y, across, up = self.page.does(f"""(() => {{
              const svg = document.querySelector("#figure-15 svg");
              svg.scrollIntoView({{block: "center"}});
              const place = [...{of_curve}].at({index}).getAttribute("transform").match(/translate\\(([-\\d.]+),([-\\d.]+)/);
              const at = new DOMPoint(...place.slice(1).map(Number)).matrixTransform(svg.getScreenCTM());
              return [at.x, at.y, Number(place[1]), Number(place[2])];
            }})()""")
            self.page.moves(x, y)
            mark = self.page.does("""(() => {
              const mark = document.querySelector("#figure-15 svg circle.mark");
              return ["cx", "cy"].map(name => Number(mark.getAttribute(name)));
            })()""")
            self.assertEqual(mark == [across, up], is_value, (mark, across, up))

    def test_curves_are_switched(self):
        self.page.open(PAGE, WIDTHS["desk"])
        shown = """[...document.querySelectorAll("#figure-8 svg path[stroke='#d55e00']")]
          .map(each => getComputedStyle(each).visibility)"""
        self.assertEqual(set(self.page.does(shown)), {"visible"})
        button = '[...document.querySelectorAll("#figure-8 .switches button")].find(b => b.textContent === "ν = 4 %")'
        self.page.does(f"{button}.click()")
        self.assertEqual(set(self.page.does(shown)), {"hidden"})
        self.assertEqual(self.page.does(f'{button}.getAttribute("aria-pressed")'), "false")
        self.page.does(f"{button}.focus()")
        self.page.call("Input.dispatchKeyEvent", type="keyDown", key="Enter", code="Enter", text="\r")
        self.assertEqual(set(self.page.does(shown)), {"visible"}, "the keyboard brings it back")
        switched = self.page.does("""[...document.querySelectorAll("figure.plot")].filter(f => f.querySelector(".switches"))
          .map(f => f.id)""")
        for number in range(4, 16):
            self.assertIn(f"figure-{number}", switched)

    def test_the_keyboard_reads_values(self):
        self.page.open(PAGE, WIDTHS["desk"])
        self.page.does('document.querySelector("#figure-8 svg").focus()')
        reading = 'document.querySelector("#figure-8 .reading").textContent'
        told = []
        for key in ["ArrowRight"] * 30 + ["ArrowDown"]:
            self.page.presses(key)
            told.append(self.page.does(reading))
        amplitudes = [float(re.search(r"A = ([\d.]+)", each)[1]) for each in told[:30]]
        self.assertEqual(amplitudes, sorted(amplitudes))
        self.assertGreater(amplitudes[-1], 2 * amplitudes[0])
        self.assertNotEqual(told[-1].split(":")[0], told[-2].split(":")[0], "down goes to the next curve")

    def test_claims_are_filtered_and_sorted(self):
        self.page.open(PAGE, WIDTHS["desk"])
        rows = """[...document.querySelectorAll(".claims tbody tr")].filter(row => !row.hidden)
          .map(row => [...row.cells].map(cell => cell.textContent))"""
        everything = self.page.does(rows)
        for verdict in ("reproduced", "not reproduced", "corrected", "derived", "holds"):
            self.page.does(f"""[...document.querySelectorAll(".claims .switches button")]
              .find(b => b.textContent.match(/^\\d+ {verdict}$/)).click()""")
            self.assertEqual(self.page.does(rows), [row for row in everything if row[-1] == verdict], verdict)
        self.page.does('document.querySelector(".claims .switches button").click()')
        heads = self.page.does('[...document.querySelectorAll(".claims th[scope=col]")].map(th => th.textContent)')
        by_name = f'document.querySelectorAll(".claims th[scope=col] button")[{heads.index("name")}].click()'
        self.page.does(by_name)
        names = [row[0] for row in self.page.does(rows)]
        self.assertEqual(len(names), len(everything))
        self.assertEqual(names, sorted(names, key=str.lower))
        self.page.does(by_name)
        self.assertEqual([row[0] for row in self.page.does(rows)], names[::-1])
        self.assertEqual(self.page.does('document.querySelector(".claims th[aria-sort]").getAttribute("aria-sort")'), "descending")
        self.page.does(f'document.querySelectorAll(".claims th[scope=col] button")[{heads.index("ours")}].click()')
        values = self.page.does('[...document.querySelectorAll(".claims td[data-value]")].map(cell => cell.dataset.value)')
        numbers = [float(value) for value in values if value != "None"]
        self.assertEqual(len(values), len(everything))
        self.assertEqual(numbers, sorted(numbers))

    def test_it_can_be_heard(self):
        self.page.open(PAGE, WIDTHS["desk"])
        nodes = self.page.call("Accessibility.getFullAXTree")["nodes"]
        named = [(node["role"]["value"], node.get("name", {}).get("value", "")) for node in nodes if not node["ignored"]]
        for role in ("image", "button", "link", "heading", "region"):
            of_role = [name for each, name in named if each == role]
            self.assertTrue(of_role, role)
            self.assertTrue(all(of_role), f"every {role} has a name")
        levels = self.page.does('[...document.querySelectorAll("h1, h2, h3, h4")].map(h => Number(h.tagName[1]))')
        self.assertEqual(levels[0], 1)
        self.assertEqual(levels.count(1), 1)
        self.assertTrue(all(after <= before + 1 for before, after in zip(levels, levels[1:])), levels)
        self.assertEqual(self.page.does('document.documentElement.lang'), "en-GB")
        unscoped = self.page.does('[...document.querySelectorAll("main th:not([scope])")].map(th => th.textContent)')
        self.assertEqual(unscoped, [])

    def test_light_and_dark_can_be_read(self):
        for scheme, ground in (("light", "white"), ("dark", "black")):
            with self.subTest(scheme):
                self.page.open(PAGE, WIDTHS["desk"], scheme)
                back = self.page.does("getComputedStyle(document.body).backgroundColor")
                self.assertEqual(luminance(back) > 0.5, ground == "white")
                for what in ("p", ".pale", "a", "td.reproduced", "td.not-reproduced", "td.corrected", "figcaption"):
                    colour = self.page.does(f'getComputedStyle(document.querySelector("main {what}")).color')
                    self.assertGreater(contrast(colour, back), 4.5, what)
                if SCREENSHOTS:
                    for section in ("#figures", "#theory", ".claims", "#mathematics"):
                        self.page.screenshot(SCREENSHOTS / f"{scheme}-{section[1:]}.png", section)

    def test_it_prints(self):
        self.page.open(PAGE, 720, media="print")
        for hidden in (".switches", "nav", ".reading"):
            self.assertEqual(self.page.does(f'getComputedStyle(document.querySelector("{hidden}")).display'), "none")
        self.assertEqual(self.page.does("document.documentElement.scrollWidth"), 720)
        pdf = self.page.call("Page.printToPDF", transferMode="ReturnAsBase64")["data"]
        self.assertGreater(len(pdf), 100_000)


class ReportsAboutScenes(InABrowser):
    """In units and dimensionless."""

    def test_pages_fit_and_figures_are_drawn(self):
        for file, name in ((file, name) for file in sorted(FOLDER.glob("*.html")) for name in self.each_width(file)):
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
                self.page.screenshot(SCREENSHOTS / f"{file.stem}-{name}.png")

    def test_values_can_be_read_off(self):
        self.page.open(FOLDER / "in-units.html", WIDTHS["desk"])
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
        self.page.open(FOLDER / "in-units.html", WIDTHS["phone"], "dark")
        ground = self.page.does("getComputedStyle(document.body).backgroundColor")
        self.assertLess(max(map(int, re.findall(r"\d+", ground)[:3])), 60)
        if SCREENSHOTS:
            self.page.screenshot(SCREENSHOTS / "dark.png")


if __name__ == "__main__":
    demand_chromium()
    which, *words = sys.argv[1:]
    if which == "Report":
        PAGE, TABLES, *words = map(Path, words)
    else:
        FOLDER, *words = map(Path, words)
    if words:
        SCREENSHOTS = words[0]
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:2], verbosity=2)
