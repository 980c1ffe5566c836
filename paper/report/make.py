#!/usr/bin/env python3
"""Makes the report: BUILD/paper/report.html and, unless --html, BUILD/paper/report.pdf, both from text.md, with
docs/mathematics.md as the appendix. With --markdown it makes docs/report.md instead, the same text without the appendix,
which says nothing of commit and day.

    paper/report/make.py BUILD [--html] [--verdicts FILE] [--wasm FOLDER] [--out FOLDER]
    paper/report/make.py BUILD --markdown FILE [--verdicts FILE]

BUILD holds the figures, tables and runs of the exact engine (make figures) and its verdicts (make verify). With what
`make wasm` builds in FOLDER the page has a damper to play with beside some figures, and makes its tables and verdicts anew
where its reader asks for it. Equal
results and commit, equal bytes. Files appear whole or not at all. Exit codes: 1 the text names what is not there, or a
tool fails; 2 usage.
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
from blocks import Html, Latex, Markdown, filled  # noqa: E402
from mathematics import appendix, tidied  # noqa: E402
from values import Mistake, Values  # noqa: E402
from pages import damper_pieces, project_pieces  # noqa: E402

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]


def called(command: list, **options) -> str:
    if not shutil.which(command[0]):
        raise Mistake(f"{command[0]} is not installed: make deps-paper")
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode or done.stderr.strip():
        raise Mistake(f"{command[0]} failed:\n{(done.stderr or done.stdout)[-3000:].strip()}")
    return done.stdout


def converted(text: str, form: str, frame: str, values: Values, *options: str) -> str:
    """By pandoc, which complains on stderr and then exits 0."""
    with tempfile.TemporaryDirectory() as folder:
        template = Path(folder) / "frame.txt"
        template.write_text(frame, encoding="utf-8")
        return called(["pandoc", "--from=markdown", f"--to={form}", "--toc", f"--template={template}",
                       "-M", f"date={values.state['date']}", "-M", f"commit={values.state['commit']}",
                       "-M", f"version={values.version}", "-M", f"author={values.authors}", "--number-sections", *options],
                      input=text)


def put(text, file: Path):
    """Whole or not at all; equal bytes keep their time stamp."""
    data = text if isinstance(text, bytes) else text.encode()
    if file.exists() and file.read_bytes() == data:
        return
    part = file.with_name(f".{file.name}.{os.getpid()}.tmp")
    try:
        part.write_bytes(data)
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)


def whole(text: str, values: Values, form) -> str:
    """Text and appendix in Markdown."""
    return filled(text, values, form) + "\n\n" + appendix(values, form)


def html_of(text: str, values: Values, wasm: Path) -> str:
    parts = SOURCE / "paper/page"
    frame = (HERE / "frame.html").read_text(encoding="utf-8")
    for name in ("page.css", "figures.js", "claims.js"):  # a dollar sign is pandoc's
        frame = frame.replace(f"@{name}@", (parts / name).read_text(encoding="utf-8").replace("$", "$$"))
    page = converted(whole(text, values, Html(values)), "html5", frame, values, "--mathml", "--section-divs",
                     "--shift-heading-level-by=1", "--toc-depth=3")
    page = tidied(page)
    page = re.sub(r"<table>\n<(?:colgroup|thead).*?</table>", r'<div class="wide">\g<0></div>', page, flags=re.S)
    page = re.sub(r'((?:section-number">|data-number="))0\.', r"\1", page)  # headings are shifted, numbers are not
    page = re.sub("<th(?=[ >])(?! scope)", '<th scope="col"', page)  # pandoc's tables have heads of columns only
    pieces = {"damper": damper_pieces(wasm), "project": project_pieces(wasm, values.build / "commands.json")}
    return re.sub("@(damper|project)[.]([a-z]+)@", lambda found: pieces[found[1]][found[2]], page)


def kept_together(latex: str) -> str:
    """The tables as boxes that no page's end divides; pandoc makes long tables, near which floats go astray. What has more
    rows than half a page stays one. A formula belongs to the paragraph before it."""
    def table(match) -> str:
        if match[2].count("\\\\\n") > 25:
            return match[0]
        return rf"\begin{{center}}\begin{{tabular}}{match[1]}{match[2]}\end{{tabular}}\end{{center}}"

    latex = re.sub(r"\\begin\{longtable\}\[\](.*?)\\endhead\n(.*?)\\end\{longtable\}", table, latex, flags=re.S)
    return re.sub(r"\n\n(?=\\begin\{equation\})", r"\n", latex)


def pdf_of(text: str, values: Values) -> bytes:
    frame = (HERE / "frame.tex").read_text(encoding="utf-8")
    # Dates in the PDF come from the commit; frame.tex keeps the folder out of it.
    environment = dict(os.environ, SOURCE_DATE_EPOCH=values.state["seconds"], FORCE_SOURCE_DATE="1", TZ="UTC", LC_ALL="C.UTF-8")
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        form = Latex(values)
        (work / "report.tex").write_text(kept_together(converted(whole(text, values, form), "latex", frame, values)))
        for svg in form.pictures.values():
            called(["rsvg-convert", "--format=pdf", f"--output={work / svg.stem}.pdf", str(svg)], env=environment)
        command = ["latexmk", "-pdf", "-silent", "-interaction=nonstopmode", "-halt-on-error", "report.tex"]
        if not shutil.which(command[0]):
            raise Mistake("latexmk is not installed: make deps-paper")
        done = subprocess.run(command, cwd=work, env=environment, capture_output=True, text=True)
        log = work / "report.log"
        said = log.read_text(errors="replace") if log.exists() else done.stdout + done.stderr
        if done.returncode:
            raise Mistake("LaTeX failed:\n" + said[said.find("\n!"):][:2000].strip())
        wide = [line for line in said.split("\n") if line.startswith(("Overfull", "LaTeX Warning"))]
        if wide:
            raise Mistake("LaTeX complains:\n" + "\n".join(wide))
        return (work / "report.pdf").read_bytes()


def markdown_of(text: str, values: Values) -> str:
    """docs/report.md, in GitHub's Markdown: headings a level lower, links to them by the names that they have there."""
    title, subtitle, text = re.fullmatch("---\ntitle: (.*)\nsubtitle: (.*)\n---\n(.*)", text, re.S).groups()
    text += "\n# Appendix: the mathematics {#mathematics}\n\nEquations, methods and proofs are in [mathematics.md](mathematics.md).\n"
    anchors = {}

    def heading(match) -> str:
        anchors[match[3]] = "#" + re.sub(r"[^\w\- ]", "", match[2].lower()).replace(" ", "-")
        return f"#{match[1]} {match[2]}"

    def link(match) -> str:
        if match[1] not in anchors:
            raise Mistake(f"#{match[1]}: no heading is called so")
        return f"]({anchors[match[1]]})"

    text = re.sub(r"^(#+) (.*) \{#([\w-]+)\}$", heading, filled(text, values, Markdown(values)), flags=re.M)
    text = re.sub(r"\]\(#reference-\d+\)", "](#references)", re.sub(r"\[\]\{#reference-\d+\} ", "", text))
    text = re.sub(r"\n{3,}", "\n\n", re.sub(r"\]\(#(?!figure-)([\w-]+)\)", link, text).replace("\\ ", " ").strip())
    return f"# {title}\n\n*{subtitle}*\n\nMade by `make reference` from [text.md](../paper/report/text.md), with numbers and verdicts " \
        f"from the results; `make paper` makes a page and a PDF of it.\n\n{text}\n"


def main() -> int:
    parser = argparse.ArgumentParser(description="Makes the report from paper/report/text.md.")
    parser.add_argument("build", type=Path, help="build folder with figures and verdicts")
    parser.add_argument("--html", action="store_true", help="no PDF: needs pandoc, but no LaTeX")
    parser.add_argument("--verdicts", type=Path, help="default BUILD/verdicts-exact.json")
    parser.add_argument("--wasm", type=Path, help="BUILD/wasm (make wasm); without it the page has no damper and no checks")
    parser.add_argument("--out", type=Path, help="default BUILD/paper")
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="only docs/report.md, to FILE: needs no pandoc")
    asked = parser.parse_args()
    build = asked.build.resolve()
    try:
        values = Values(SOURCE, build, (asked.verdicts or build / "verdicts-exact.json").resolve())
        text = (HERE / "text.md").read_text(encoding="utf-8")
        if asked.markdown:
            put(markdown_of(text, values), asked.markdown)
            return 0
        values.out = (asked.out or build / "paper").resolve()
        values.out.mkdir(parents=True, exist_ok=True)
        put(html_of(text, values, asked.wasm), values.out / "report.html")
        if not asked.html:
            put(pdf_of(text, values), values.out / "report.pdf")
    except Mistake as mistake:
        print(f"paper/report: {mistake}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
