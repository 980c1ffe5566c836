"""What the report's text calls for by {{figures N...}}, {{picture FILE WORDS}} and {{claims}}: figures with what stands
beside them, and the table of all claims; as HTML and as LaTeX."""
import re
from html import escape
from pathlib import Path

from values import Mistake, Values, stem_of

# What the claims' and figures' words hold beyond ASCII, for a LaTeX that reads it as text (frame.tex declares the
# rest). A character that is missing there stops LaTeX with its name.
LATEX = {"\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "_": r"\_", "%": r"\%",
         "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\textless{}", ">": r"\textgreater{}"}


def latex(text: str) -> str:
    return "".join(LATEX.get(c, c) for c in text)


def rows_of(values: Values, ids) -> list:
    """Claim, statement, what the paper prints, what came out in the statement's terms, verdict."""
    return [(name, values.claims[name]["statement"], values.claims[name]["printed"],
             re.sub(r"(?<![\w^])-(?=\d)", "−", values.verdicts[name]["words"]),
             values.verdicts[name]["verdict"]) for name in ids]


def files_of(figure: dict) -> str:
    scenes = dict.fromkeys(curve["scene"] for curve in figure.get("curves", []))
    parts = [f"scene{'s' * (len(scenes) > 1)} {', '.join(scenes)}"] if scenes else []
    parts += [f"table {stem_of(figure['figure'])}.dat"] if scenes else []
    return "; ".join(parts + [f"script {figure['script']}"])


def parameters_of(values: Values, number: str) -> str:
    table = values.build / f"series/exact/{stem_of(number)}.dat"
    found = re.search("^# Parameters: (.*)$", table.read_text(encoding="utf-8"), re.M) if table.exists() else None
    return found[1] if found else ""


def picture_html(svg: str, name: str, words: str) -> str:
    """An SVG to stand inline: no head, scaled by the page, described, its ids its own."""
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r"<svg\s+width=\"\d+\" height=\"\d+\"", f'<svg role="img" aria-label="{escape(words)}"', svg, count=1)
    return re.sub(r"(id=['\"]|href='#|url\(#)(?!" + name + "-)", rf"\g<1>{name}-", svg)


class Html:
    def __init__(self, values: Values):
        self.values = values

    def value(self, name: str, text: str) -> str:
        """Whose value it is shows under the cursor."""
        return f'[{text}]{{.value title="{name}"}}'

    def reference(self, number: str) -> str:
        return f"[Figure {number}](#figure-{number})"

    def figures(self, numbers: list) -> str:
        return "\n\n".join(self.figure(number) for number in numbers)

    def figure(self, number: str) -> str:
        values, figure = self.values, self.values.figures[number]
        svg = (values.build / f"figures/{stem_of(number)}.svg").read_text(encoding="utf-8")
        rows = "".join(
            f"<tr><td>{escape(statement)}</td><td>{escape(paper)}</td><td>{escape(ours)}</td>"
            f'<td class="{verdict.replace(" ", "-")}">{verdict}</td></tr>\n'
            for _, statement, paper, ours, verdict in rows_of(values, figure["claims"]))
        return raw("html", f"""<figure class="plot" id="figure-{number}">
<div class="drawing">{picture_html(svg, stem_of(number), figure['title'])}</div>
<figcaption><b>Figure {number}.</b> {escape(figure['title'])}{'. ' * bool(parameters_of(values, number))}{escape(parameters_of(values, number))}
<span class="pale">— {escape(files_of(figure))}; stamp {values.stamps[number]} · {values.version}</span></figcaption>
<div class="wide"><table><thead><tr><th scope="col">claim</th><th scope="col">paper</th><th scope="col">ours</th><th scope="col">verdict</th></tr></thead>
<tbody>{rows}</tbody></table></div>
</figure>""")

    def picture(self, file: Path, words: str) -> str:
        name = file.stem.replace("_", "-")
        return raw("html", f'<figure id="{name}"><div class="drawing">'
                           f'{picture_html(file.read_text(encoding="utf-8"), name, words)}</div>'
                           f"<figcaption>{escape(words)}</figcaption></figure>")

    def claims(self) -> str:
        counts = {verdict: sum(v["verdict"] == verdict for v in self.values.verdicts.values())
                  for verdict in ("reproduced", "not reproduced", "corrected", "derived")}
        buttons = f'<button type="button" aria-pressed="true">all {sum(counts.values())}</button>' + "".join(
            f'<button type="button" aria-pressed="false" data-verdict="{verdict.replace(" ", "-")}">{count} {verdict}</button>'
            for verdict, count in counts.items())
        rows = "".join(
            f'<tr id="claim-{name}"><th scope="row"><code>{name}</code></th><td>{escape(self.values.claims[name]["section"])}</td>'
            f"<td>{escape(statement)}</td><td>{escape(paper)}</td>"
            f"<td>{escape(ours)}</td>"
            f'<td class="{verdict.replace(" ", "-")}">{verdict}</td></tr>\n'
            for name, statement, paper, ours, verdict in rows_of(self.values, self.values.verdicts))
        heads = "".join(f'<th scope="col">{head}</th>' for head in ("name", "where", "claim", "paper", "ours", "verdict"))
        return raw("html", f"""<div class="claims"><div class="switches" role="group" aria-label="Claims shown">{buttons}</div>
<div class="wide" tabindex="0" role="region" aria-label="All claims"><table><caption>Ours is the median over an ensemble of minutely different releases, on which the verdict is; in brackets its extremes.</caption>
<thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table></div></div>""")


class Latex:
    def __init__(self, values: Values):
        self.values = values
        self.pictures = []  # SVG files that are wanted as PDF

    def value(self, name: str, text: str) -> str:
        return text

    def reference(self, number: str) -> str:
        return rf"`\hyperlink{{figure-{number}}}{{Figure~{number}}}`{{=latex}}"

    def figures(self, numbers: list) -> str:
        return "\n\n".join(self.figure(number) for number in numbers)

    def figure(self, number: str) -> str:
        values, figure = self.values, self.values.figures[number]
        picture = values.build / f"figures/{stem_of(number)}.pdf"
        rows = "\n\n".join(rf"\claim{{{latex(statement)}}}{{{latex(paper)}}}{{{latex(ours)}}}{{{verdict}}}"
                           for _, statement, paper, ours, verdict in rows_of(values, figure["claims"]))
        words = ". ".join(part for part in (figure["title"], parameters_of(values, number)) if part)
        return raw("latex", rf"""\paperfigure{{{number}}}{{{picture}}}{{{latex(words)}.}}{{{latex(files_of(figure))}; stamp
{values.stamps[number]}~· {values.version}}}{{{rows}}}""")

    def picture(self, file: Path, words: str) -> str:
        self.pictures.append(file)
        return raw("latex", rf"\widepicture{{{file.stem}.pdf}}{{{latex(words)}}}")

    def claims(self) -> str:
        rows = "\n".join(rf"{latex(statement)} & {latex(paper)} & {latex(ours)} & {verdict} \\"
                         for _, statement, paper, ours, verdict in rows_of(self.values, self.values.verdicts))
        return raw("latex", rf"\begin{{claimtable}}" + "\n" + rows + "\n" + r"\end{claimtable}")


def raw(form: str, text: str) -> str:
    return f"```{{={form}}}\n{text}\n```"


def filled(text: str, values: Values, form) -> str:
    """The Markdown of `text` with all names and blocks put in."""
    def called(match) -> str:
        name, _, how = match[1].replace("\\|", "|").partition("|")  # in a table's row it is written \|
        word, *rest = name.split()
        if word in ("figure", "figures"):
            for number in rest:
                if number not in values.figures:
                    raise Mistake(f"{{{{{match[1]}}}}}: no figure is called {number}")
            return form.reference(rest[0]) if word == "figure" else form.figures(rest)
        if word == "picture":
            return form.picture(values.source / rest[0], " ".join(rest[1:]))
        if name == "claims":
            return form.claims()
        return form.value(name, values.written(name, how))

    return re.sub(r"\{\{([^{}]+)\}\}", called, text)
