"""What the report's text calls for: figures with what stands beside them, numbered equations, the list of references, the
tables of the claims that the figures of a section test, at its end, and of all claims; as HTML, as LaTeX and as Markdown
for docs/report.md.

    ::: figure N             figure N of the catalogue; the lines up to ::: are its caption, in Markdown
    ::: picture LETTER FILE  another picture, an SVG of this project, with the next letter for its number
    ::: equation NAME        a numbered equation, in LaTeX's notation
    {{figure N}}, {{equation NAME}}          links to them
    {{references}}, {{claims}}               references.md; the table of all claims
"""
import csv
import hashlib
import io
import json
import re
import subprocess
import sys
from html import escape
from pathlib import Path

from values import VERDICTS, Mistake, Values, stem_of

sys.path.append(str(Path(__file__).resolve().parents[2] / "src/wasm/page"))
from pages import own_html  # noqa: E402

# Mathematics in the words of claims, which are plain ASCII: what is set, and as which formula.
GREEK = {"eta": r"\eta", "nu": r"\nu", "zeta": r"\zeta", "phi": r"\varphi", "pi": r"\pi"}
FORMULAS = [(re.compile(pattern), formula) for pattern, formula in (
    (r"L/sqrt\(pi\^2 \+ L\^2\) with L = -ln e", r"$L/\\sqrt{\\pi^2 + L^2}$ with $L = -\\ln e$"),
    (r"Omega_m = sqrt\(K_M/M\)", r"$\\Omega_m = \\sqrt{K_M/M}$"),
    (r"sqrt\(k\)", r"$\\sqrt{k}$"),
    (r"\b(zeta|zeta_s) = C/C_c", r"$\\\1 = C/C_c$"),
    (r"\bzeta_s\b", r"$\\zeta_s$"),
    (r"nu \(x'\^2 \+ y'\^2\)/2", r"$\\nu(x'^2 + y'^2)/2$"),
    (r"y'' = -x''", r"$y'' = -x''$"),
    (r"d ln \(w/A\) / d ln A", r"$d\\ln(w/A)/d\\ln A$"),
    (r"d ln (eta|w) / d ln (A|nu)", lambda m: rf"$d\ln {GREEK.get(m[1], m[1])}/d\ln {GREEK.get(m[2], m[2])}$"),
    (r"A \(eta - 2 zeta/\(1 \+ nu\)\)/nu", r"$A(\\eta - 2\\zeta/(1 + \\nu))/\\nu$"),
    (r"2 zeta/\(1 \+ nu\)", r"$2\\zeta/(1 + \\nu)$"),
    (r"2 dx/x", r"$2\\Delta x/x$"),
    (r"A eta_s/nu", r"$A\\eta_s/\\nu$"),
    (r"A eta/nu", r"$A\\eta/\\nu$"),
    (r"\b2 (pi|zeta)\b", lambda m: f"$2{GREEK[m[1]]}$"),
    (r"\b(nu|zeta|eta|phi|d|e|k|A|x0) = ([\d.]+(?:e[+-]?\d+)?)",
     lambda m: f"${GREEK.get(m[1], m[1].replace('x0', 'x_0'))} = {scientific(m[2])}$"),
    (r"\b1 - e\b", r"$1 - e$"),
    (r"\b(nu|zeta|eta|phi|pi)\b", lambda m: f"${GREEK[m[1]]}$"),
    (r"\b[\d.]+e[+-]?\d+\b", lambda m: f"${scientific(m[0])}$"))]


def scientific(number: str) -> str:
    """1e-8 as a formula."""
    mantissa, _, exponent = number.partition("e")
    if not exponent:
        return number
    return ("" if mantissa == "1" else mantissa + r"\times ") + f"10^{{{int(exponent)}}}"


def markdown(text: str, escaped: str = "\\`*_{}[]<>#^~|@\"'") -> str:
    """The words of a claim with their formulas as Markdown, by default pandoc's."""
    parts = [text]
    for pattern, formula in FORMULAS:
        # What is already a formula is no text: every other part.
        parts = [piece for i, part in enumerate(parts) for piece in
                 (re.split(r"(\$[^$]*\$)", pattern.sub(formula, part)) if i % 2 == 0 else [part])]
    return "".join(re.sub(f"([{re.escape(escaped)}])", r"\\\1", part) if i % 2 == 0 else part for i, part in enumerate(parts))


def rows_of(values: Values, ids) -> list:
    """Claim, statement, what the paper prints, what came out in the statement's terms, verdict."""
    return [(name, values.claims[name]["statement"], values.claims[name]["printed"],
             re.sub(r"(?<![\w^])-(?=\d)", "−", values.verdicts[name]["words"]),
             values.verdicts[name]["verdict"]) for name in ids]


def all_rows(values: Values) -> list:
    """The same of all claims, and behind them the statements that are open."""
    return rows_of(values, values.verdicts) + [(each["id"], each["statement"], each["printed"], "not measured", "open")
                                               for each in values.open]


def sections_of(values: Values) -> dict:
    return {each["id"]: each["section"] for each in [*values.claims.values(), *values.open]}


def where(section: str) -> str:
    """Where a claim is stated; a chapter of the mathematics stands in the page itself."""
    return re.sub(r"docs/mathematics\.md, (?:chapter )?([\d.]+)", r'<a href="#mathematics-\1">mathematics, \1</a>', escape(section))


def scenes_of(values: Values, number: str) -> list:
    """The scenes of its curves, and of the responses that it draws."""
    figure = values.figures[number]
    further = {each["name"]: each for part in ("runs", "responses") for each in values.catalogue[part]}
    curves = figure.get("curves", [])
    return list(dict.fromkeys([curve["scene"] for curve in curves if "scene" in curve] +
                              [further[curve[key]]["scene"] for curve in curves for key in ("run", "alone") if key in curve] +
                              [further[name]["scene"] for name in figure.get("responses", [])]))


def table_of(values: Values, number: str):
    """The file of a figure's table, for whoever wants its numbers; None for a drawing."""
    file = values.build / f"series/exact/{stem_of(values.figures[number])}.csv"
    return file if values.figures[number]["table"] != "drawing" else None


def shortened(table: str) -> str:
    """A table in CSV without what a row shares with others, half of its bytes: its block and its curve if they are those of
    the row before, its x if it is that of the same row of the block's first curve. page/figures.js puts them back."""
    lines, before, first, at = [], [None, None], [], 0
    for line in table.splitlines():
        *names, x, y, low, high = next(csv.reader([line]))
        if names[0] != before[0]:
            first = []
        at = at + 1 if names == before else 0
        out = io.StringIO()
        csv.writer(out, lineterminator="").writerow(["", ""] if names == before else names)
        is_known = at < len(first) and first[at] == x
        if at == len(first):
            first.append(x)
        lines.append(",".join([out.getvalue(), "" if is_known else x, y, low, high]))
        before = names
    return "\n".join(lines) + "\n"


def parameters_of(values: Values, number: str) -> str:
    """What all curves of a figure have in common, from the head of the table that gnuplot reads."""
    table = table_of(values, number)
    text = table.with_suffix(".dat").read_text(encoding="utf-8") if table else ""
    found = re.search("^# Parameters: (.*)$", text, re.M)
    return found[1] if found else ""


def made_from(values: Values, number: str, link=lambda words, file: words) -> str:
    """What a figure is made from, as a sentence. `link` makes a link of words and a file of the project."""
    figure, table = values.figures[number], table_of(values, number)
    scenes = [link(scene, f"data/scenes/{scene}.json") for scene in scenes_of(values, number)]
    parts = [f"scene{'s' * (len(scenes) > 1)} {', '.join(scenes)}"] * bool(scenes) + \
        [f"{what} {link(figure[what], 'figures/' + figure[what])}" for what in ("plan", "script") if what in figure]
    if table:
        parts.insert(-1, f"table {link(table.name, f'data/reference/series/{table.stem}.dat')}")
    return (f"{parameters_of(values, number)}. " if parameters_of(values, number) else "") + \
        f"Made from {', '.join(parts)}; stamp {values.stamps[number]} · {values.version}."


def damper_html(values: Values, number: str) -> str:
    """The place for a damper to play with (src/wasm/page/damper.js), beside figures of one motion and of its phases."""
    figure = values.figures[number]
    if figure["table"] not in ("motion", "phase"):
        return ""
    scene = json.loads((values.source / f"data/scenes/{scenes_of(values, number)[0]}.json").read_text(encoding="utf-8"))
    parameters = {name: scene[name] for name in ("mass_ratio", "restitution", "damping_ratio", "wall_stiffness", "x0") if name in scene}
    begin = {"parameters": parameters} | ({"amplitude": figure["window"]} if "window" in figure else {})
    return f"\n<div id='damper-{number}' data-damper='{json.dumps(begin)}' data-words='Play with the damper of Figure {number}'></div>"


def own_damper_html(values: Values, number: str) -> str:
    """The place for one's own damper (src/wasm/page/own.js), beside the charts to design one by."""
    if values.figures[number]["table"] != "design_charts":
        return ""
    return f"\n<div data-own='{own_html()}' data-words='Your own damper, in kilograms and millimetres'></div>"


def picture_html(svg: str, name: str, words: str) -> str:
    """An SVG to stand inline: no head, scaled by the page, described, its ids its own; without empty groups, colours and
    coordinates without spaces and zeros that say nothing."""
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r"<svg\s+width=\"\d+\" height=\"\d+\"", f'<svg role="img" aria-label="{escape(words)}"', svg, count=1)
    svg = re.sub(r"rgb\(\s*(\d+),\s*(\d+),\s*(\d+)\)", lambda m: "#%02x%02x%02x" % tuple(map(int, m.groups())), svg)
    svg = re.sub(r"<g [^>]*>\s*</g>\s*", "", svg)
    svg = re.sub(r"(\b(?:d|points|transform)\s*=\s*)(['\"])([^'\"]*)\2", lambda m: m[1] + m[2] + re.sub(
        r"(\.\d*?)0+(?!\d)", lambda n: n[1].rstrip("."), re.sub(r"\s+", " ", m[3])) + m[2], svg)
    return re.sub(r"(id=['\"]|href='#|url\(#)(?!" + name + "-)", rf"\g<1>{name}-", svg)


class Form:
    """What HTML and LaTeX have in common."""

    def __init__(self, values: Values):
        self.values = values
        self.pictures = {}   # letter -> SVG file
        self.equations = {}  # name -> number, in the order of the text
        self.set = {}        # words of a claim -> the same, set

    def letter_of(self, file: Path) -> str:
        """The next letter, for a picture that the text does not give one."""
        letter = chr(ord(max(name for name in [*self.pictures, *self.values.figures] if name.isalpha())) + 1)
        self.pictures[letter] = file
        return letter

    def equation_reference(self, name: str) -> str:
        return f"[equation ({self.equations[name]})](#equation-{name})"

    def equation(self, name: str, formula: str) -> str:
        return self.numbered(f"equation-{name}", str(self.equations[name]), formula)

    def words(self, text: str) -> str:
        """The words of a claim, set: all claims' by one call of pandoc, a paragraph each."""
        if not self.set:
            known = list(dict.fromkeys(text for row in all_rows(self.values) for text in row[1:4]))
            done = subprocess.run(["pandoc", "--from=markdown-smart", f"--to={self.pandoc}", "--mathml", "--wrap=none"],
                                  input="\n\n".join(map(markdown, known)), capture_output=True, text=True, check=True)
            self.set = dict(zip(known, self.paragraphs(done.stdout), strict=True))
        return self.set[text]


class Html(Form):
    pandoc = "html5"

    def paragraphs(self, text: str) -> list:
        # The formula's source, which MathML carries beside it, would be part of the words.
        return re.findall(r"<p>(.*)</p>", re.sub(r"<annotation.*?</annotation>", "", text))

    def value(self, name: str, text: str) -> str:
        """Whose value it is shows under the cursor."""
        return f'[{text}]{{.value title="{name}"}}'

    def reference(self, number: str) -> str:
        return f"[Figure {number}](#figure-{number})"

    def numbered(self, anchor: str, number: str, formula: str) -> str:
        return f"::: {{#{anchor} .equation}}\n$${formula}$$\n\n[({number})]{{.number}}\n:::"

    def claim_reference(self, name: str) -> str:
        return f"[`{name}`](#claim-{name})"

    def figure(self, number: str, caption: str) -> str:
        values, figure = self.values, self.values.figures[number]
        svg = (values.build / f"figures/{stem_of(figure)}.svg").read_text(encoding="utf-8")
        table = table_of(values, number)
        # The page's script makes a link of it.
        data = f'<script type="text/csv" data-file="{table.name}">\n{shortened(table.read_text(encoding="utf-8"))}</script>' if table else ""
        cited = f' data-table="build/series/exact/{stem_of(figure)}.dat" data-sha256="{values.sha256[number]}"' if table else ""
        return raw("html", f"""<figure class="plot" id="figure-{number}" data-file="{stem_of(figure)}.svg"{cited}>
<div class="drawing">{picture_html(svg, stem_of(figure), figure['title'])}</div>{data}
<figcaption>""") + f"\n\n**Figure {number}. {figure['title']}.** {caption}\n\n" + raw("html", f"""<p class="pale">{escape(made_from(values, number))}</p>
</figcaption>
</figure>{damper_html(values, number)}{own_damper_html(values, number)}""")

    def picture(self, letter: str, file: Path, caption: str) -> str:
        name = file.stem.replace("_", "-")
        drawing = picture_html(file.read_text(encoding="utf-8"), name, caption.split(". ")[0].replace("\n", " "))
        return raw("html", f'<figure class="other" id="figure-{letter}"><div class="drawing">{drawing}</div>\n<figcaption>') + \
            f"\n\n**Figure {letter}.** {caption}\n\n" + raw("html", "</figcaption></figure>")

    def tested(self, figures: list, ids: list) -> str:
        rows = "".join(
            f'<tr><td data-head="claim">{self.words(statement)}</td><td data-head="paper">{self.words(paper)}</td>'
            f'<td data-head="ours">{self.words(ours)}</td><td data-head="verdict" class="{verdict.replace(" ", "-")}">{verdict}</td></tr>\n'
            for _, statement, paper, ours, verdict in rows_of(self.values, ids))
        heads = "".join(f'<th scope="col">{head}</th>' for head in ("claim", "paper", "ours", "verdict"))
        return raw("html", f"""<div class="wide rows tested"><table><caption>Tested by {figures_named(figures)}.</caption>
<thead><tr>{heads}</tr></thead>
<tbody>{rows}</tbody></table></div>""")

    def claims(self) -> str:
        counts = {verdict: sum(v["verdict"] == verdict for v in self.values.verdicts.values())
                  for verdict in dict.fromkeys(each for verdicts in VERDICTS.values() for each in verdicts)}
        counts = {verdict: count for verdict, count in (counts | {"open": len(self.values.open)}).items() if count}
        sections = sections_of(self.values)
        buttons = f'<button type="button" aria-pressed="true">all {sum(counts.values())}</button>' + "".join(
            f'<button type="button" aria-pressed="false" data-verdict="{verdict.replace(" ", "-")}">{count} {verdict}</button>'
            for verdict, count in counts.items())

        def cited(name: str) -> str:
            line = self.values.lines.get(name)
            return f' data-sha256="{hashlib.sha256(line.encode()).hexdigest()}"' if line else ""

        rows = "".join(
            f'<tr id="claim-{name}"{cited(name)}><th scope="row" data-head="name"><code>{name}</code></th>'
            f'<td data-head="where">{where(sections[name])}</td>'
            f'<td data-head="claim">{self.words(statement)}</td><td data-head="paper">{self.words(paper)}</td>'
            f'<td data-head="ours" data-value="{self.values.verdicts.get(name, {}).get("ours")}">{self.words(ours)}</td>'
            f'<td data-head="verdict" class="{verdict.replace(" ", "-")}">{verdict}</td></tr>\n'
            for name, statement, paper, ours, verdict in all_rows(self.values))
        heads = "".join(f'<th scope="col">{head}</th>' for head in ("name", "where", "claim", "paper", "ours", "verdict"))
        return raw("html", f"""<div class="check" data-check-all></div>
<div class="claims"><div class="switches" role="group" aria-label="Claims shown">{buttons}</div>
<div class="wide rows" tabindex="0" role="region" aria-label="All claims"><table><caption>Ours is the median of the ensemble;
in brackets its extremes.</caption>
<thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table></div></div>""")


class Latex(Form):
    pandoc = "latex"

    def paragraphs(self, text: str) -> list:
        return [part.strip() for part in text.strip().split("\n\n")]

    def value(self, name: str, text: str) -> str:
        return text

    def reference(self, number: str) -> str:
        return rf"`\hyperlink{{figure-{number}}}{{Figure~{number}}}`{{=latex}}"

    def numbered(self, anchor: str, number: str, formula: str) -> str:
        return raw("latex", rf"\begin{{equation}}\hypertarget{{{anchor}}}{{}}\tag{{{number}}}" + f"\n{formula}\n" + r"\end{equation}")

    def claim_reference(self, name: str) -> str:
        return f"`{name}`"

    def figure(self, number: str, caption: str) -> str:
        values, figure = self.values, self.values.figures[number]
        picture = values.build / f"figures/{stem_of(figure)}.pdf"
        made = made_from(values, number).replace("_", r"\_").replace("%", r"\%").replace("#", r"\#")
        return raw("latex", rf"\begin{{paperfigure}}{{{number}}}{{{picture}}}") + f"\n\n**Figure {number}. {figure['title']}.** {caption}\n\n" + \
            raw("latex", rf"\madefrom{{{made}}}" + "\n" + r"\end{paperfigure}")

    def picture(self, letter: str, file: Path, caption: str) -> str:
        return raw("latex", rf"\begin{{widepicture}}{{{letter}}}{{{file.stem}.pdf}}") + f"\n\n**Figure {letter}.** {caption}\n\n" + \
            raw("latex", r"\end{widepicture}")

    def table(self, rows: list) -> str:
        rows = "\n".join(rf"{self.words(statement)} & {self.words(paper)} & {self.words(ours)} & {verdict} \\"
                         for _, statement, paper, ours, verdict in rows)
        return raw("latex", r"\begin{claimtable}" + "\n" + rows + "\n" + r"\end{claimtable}")

    def tested(self, figures: list, ids: list) -> str:
        return f"Tested by {figures_named(figures)}:\n\n" + self.table(rows_of(self.values, ids))

    def claims(self) -> str:
        return self.table(all_rows(self.values))


class Markdown(Form):
    """docs/report.md: GitHub's Markdown, with links to files of the project."""

    def words(self, text: str) -> str:
        return markdown(text, "\\`*_[]<>|~")

    def value(self, name: str, text: str) -> str:
        return text

    def reference(self, number: str) -> str:
        return f"[Figure {number}](#figure-{number})"

    def equation_reference(self, name: str) -> str:
        return f"equation ({self.equations[name]})"

    def numbered(self, anchor: str, number: str, formula: str) -> str:
        return rf"$$ {formula} \tag{{{number}}} $$"

    def shown(self, number: str, file: str, title: str, caption: str) -> str:
        return f'<a id="figure-{number}"></a>![{title}](../{file})\n\n**Figure {number}.** {caption}'

    def figure(self, number: str, caption: str) -> str:
        figure = self.values.figures[number]
        shown = self.shown(number, f"data/reference/figures/{stem_of(figure)}.svg", figure["title"], caption)
        made = made_from(self.values, number, lambda words, file: f"[{Path(file).name}](../{file})")
        return shown.replace(f"{number}.**", f"{number}. {figure['title']}.**", 1) + f"\n\n{made}"

    def picture(self, letter: str, file: Path, caption: str) -> str:
        return self.shown(letter, file.relative_to(self.values.source).as_posix(), re.sub(r"\s+", " ", caption.split(". ")[0]), caption)

    def tested(self, figures: list, ids: list) -> str:
        rows = "".join(f"| {' | '.join(map(self.words, row[1:]))} |\n" for row in rows_of(self.values, ids))
        return f"Tested by {figures_named(figures)}:\n\n| claim | paper | ours | verdict |\n|:--|:--|:--|:--|\n{rows}"

    def claims(self) -> str:
        return "The table of all claims is [paper/claims.md](../paper/claims.md)."


def raw(form: str, text: str) -> str:
    return f"```{{={form}}}\n{text}\n```"


def figures_named(numbers: list) -> str:
    *first, last = numbers
    return f"Figures {', '.join(first)} and {last}" if first else f"Figure {last}"


def with_claims(text: str, values: Values) -> str:
    """The text with a line {{tested FIGURES : CLAIMS}} at the end of each section that has figures which test claims."""
    parts = re.split(r"^(?=#+ )", text, flags=re.M)
    for i, part in enumerate(parts):
        tested = {number: values.figures[number]["claims"] for number in re.findall(r"^::: figure (.*)$", part, re.M)
                  if values.figures.get(number, {}).get("claims")}
        ids = list(dict.fromkeys(name for claims in tested.values() for name in claims))
        if ids:
            parts[i] = f"{part.rstrip()}\n\n{{{{tested {' '.join(tested)} : {' '.join(ids)}}}}}\n\n"
    return "".join(parts)


BLOCK = re.compile(r"^::: (figure|picture|equation) (.*)\n((?:(?!:::).*\n)*?):::$", re.M)


def filled(text: str, values: Values, form) -> str:
    """The Markdown of `text` with all names and blocks put in."""
    text = with_claims(text, values)
    for kind, words, _ in BLOCK.findall(text):
        if kind == "equation":
            if words in form.equations:
                raise Mistake(f"::: equation {words}: there are two")
            form.equations[words] = len(form.equations) + 1
        elif kind == "picture":
            letter, _, file = words.partition(" ")
            form.pictures[letter] = values.source / file
        elif words not in values.figures:
            raise Mistake(f"::: figure {words}: no figure is called {words}")

    def block(match) -> str:
        kind, words, inside = match[1], match[2], match[3].strip()
        if kind == "equation":
            return form.equation(words, inside)
        if kind == "figure":
            return form.figure(words, inside)
        letter = words.partition(" ")[0]
        return form.picture(letter, form.pictures[letter], inside)

    def called(match) -> str:
        name, _, how = match[1].replace("\\|", "|").partition("|")  # in a table's row it is written \|
        word, _, rest = name.partition(" ")
        if word == "figure":
            if rest not in values.figures and rest not in form.pictures:
                raise Mistake(f"{{{{{match[1]}}}}}: no figure is called {rest}")
            return form.reference(rest)
        if word == "equation":
            if rest not in form.equations:
                raise Mistake(f"{{{{{match[1]}}}}}: no equation is called {rest}")
            return form.equation_reference(rest)
        if word == "tested":
            figures, _, ids = rest.partition(" : ")
            return form.tested(figures.split(), ids.split())
        if name == "references":
            return (Path(__file__).parent / "references.md").read_text(encoding="utf-8")
        if name == "claims":
            return form.claims()
        return form.value(name, values.written(name, how))

    # First the values: a figure's claims and table, which blocks put in, are no text to fill.
    return BLOCK.sub(block, re.sub(r"\{\{([^{}]+)\}\}", called, text))
