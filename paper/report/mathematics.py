"""The report's mathematics: how formulas are set, and docs/mathematics.md as the appendix: the same Markdown, in which every number leads to what it names.

Equations (M4.2), lemmas (L1), chapters and the literature get anchors. What the text says of them, and of the report's
figures and claims, becomes links. The report is one file, so a link to another file of the project becomes that file's
name. What leads nowhere is a Mistake.
"""
import re
import xml.etree.ElementTree as ElementTree

from values import Mistake

FILE = "docs/mathematics.md"
# Files whose contents stand in the report -> the anchor there.
HELD = {"paper/report/references.md": "references"}

CHAPTER = re.compile(r"^(##+) (\d+(?:\.\d+)?)(\.?) (.*)$", re.M)
DISPLAY = re.compile(r"^( *)\$\$(.*?)\$\$$", re.M | re.S)
TAG = re.compile(r"\\tag\{(M\d+\.\d+)\}")
LEMMA = re.compile(r"(?=\*\*Lemma (L\d+)\b)")
WORK = re.compile(r"^(\d+)\. ", re.M)
PICTURE = re.compile(r"^!\[([^\]]*)\]\(([^)\s]*)\)$", re.M)
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!#)([^)]*)\)")
# Formulas, words of a program, targets, attributes and a lemma's own name: numbers in these refer to nothing.
CLOSED = re.compile(r"(\$\$.*?\$\$|\$[^$]*\$|`[^`]*`|\]\([^)]*\)|\{#[^}]*\}|\*\*Lemma L\d+)", re.S)
CHAPTERS = re.compile(r"\b(chapters?\s+)(\d+(?:\.\d+)?)(?:( and )(\d+(?:\.\d+)?))?")


def appendix(values, form) -> str:
    """Markdown for pandoc."""
    text = (values.source / FILE).read_text(encoding="utf-8")
    text, _, literature = text.partition("\n## 15. ")
    anchors = {}  # what the text calls a place -> its anchor

    def anchor(called: str, name: str) -> str:
        if called in anchors:
            raise Mistake(f"{FILE}: {called} stands twice")
        anchors[called] = name
        return f"#{name}"

    def link(words: str, called: str) -> str:
        if called not in anchors:
            raise Mistake(f"{FILE}: {called} leads nowhere")
        return f"[{words}](#{anchors[called]})"

    def file_named(match) -> str:
        path = (values.source / "docs" / match[2]).resolve()
        if not path.exists():
            raise Mistake(f"{FILE}: there is no file {match[2]}")
        name = path.relative_to(values.source.resolve()).as_posix()
        return f"[{match[1]}](#{HELD[name]})" if name in HELD else f"{match[1]}, `{name}`"

    def claim(match) -> str:
        if match[2] not in values.claims:
            raise Mistake(f"{FILE}: no claim is called {match[2]}")
        return match[1] + form.claim_reference(match[2])

    def figure(match) -> str:
        if match[1] not in values.figures:
            raise Mistake(f"{FILE}: no figure is called {match[1]}")
        return form.reference(match[1])

    def linked(open_text: str) -> str:
        open_text = re.sub(r"\bFigure\s+(\w+)", figure, open_text)
        open_text = re.sub(r"\b(?:M\d+\.\d+|L\d+)\b", lambda m: link(m[0], m[0]), open_text)
        open_text = re.sub(r"\[\d+\](?!\()", lambda m: link(rf"\[{m[0][1:-1]}\]", m[0]), open_text)
        return CHAPTERS.sub(lambda m: link(m[1] + m[2], f"chapter {m[2]}") +
                            (m[3] + link(m[4], f"chapter {m[4]}") if m[3] else ""), open_text)

    def equation(match) -> str:
        number = TAG.search(match[2])
        if not number:
            raise Mistake(f"{FILE}: {match[2].strip()} has no number")
        block = form.numbered(anchors[number[1]], number[1], TAG.sub("", match[2]).strip())
        return "\n" + "\n".join(match[1] + line for line in block.split("\n")) + "\n"

    def picture(match) -> str:
        if not (values.source / "docs" / match[2]).exists():
            raise Mistake(f"{FILE}: there is no file {match[2]}")
        letter = form.letter_of(values.source / "docs" / match[2])
        return form.picture(letter, form.pictures[letter], match[1])

    # First all anchors, then all links, which may lead forwards, then the blocks, which hold no more links.
    text = text.replace("# The mathematics\n", "# Appendix: the mathematics {#mathematics .unnumbered}\n", 1)
    text += "\n## 15. " + WORK.sub(lambda m: f"{m[0]}[]{{{anchor(f'[{m[1]}]', f'literature-{m[1]}')}}}", literature)
    text = CHAPTER.sub(lambda m: f"{m[1]} {m[2]}{m[3]} {m[4]} "
                                 f"{{{anchor(f'chapter {m[2]}', f'mathematics-{m[2]}')} .unnumbered}}", text)
    text = LEMMA.sub(lambda m: f"[]{{{anchor(m[1], m[1])}}}", text)
    for number in TAG.findall(text):
        anchor(number, number)
    text = re.sub(r"\b(claim\s+)`([\w-]+)`", claim, LINK.sub(file_named, text))
    parts = CLOSED.split(text)
    text = "".join(part if i % 2 else linked(part) for i, part in enumerate(parts))
    return PICTURE.sub(picture, DISPLAY.sub(equation, text))


# The formulas of a page as browsers set them well: pandoc's MathML with TeX's spaces.
#
# Browsers take a stretchy bracket from the font's large ones, with space around it, give an operator between two others the
# space of a binary one, and a function's name space on both sides. Here brackets stretch only around what is tall; signs
# and functions say what they are. TeX's source, which pandoc writes beside each formula, is left out.
TALL = {"mfrac", "munder", "munderover", "mtable"}
THIN = "0.167em"  # TeX's thin space


def is_open(before) -> bool:
    """Nothing stands there that an operator could bind to."""
    return before is None or before.tag in ("mspace", "mtext") or (before.tag == "mo" and before.get("form") != "postfix")


def begins_with_bracket(element) -> bool:
    return element is not None and len(element) > 0 and element[0].get("form") == "prefix"


def space(parent):
    children = list(parent)
    is_fenced = len(children) > 1 and children[0].get("form") == "prefix" and children[-1].get("form") == "postfix"
    if is_fenced and not any(each.tag in TALL for each in parent.iter()):
        for fence in (children[0], children[-1]):
            fence.set("stretchy", "false")
    for i, child in enumerate(children):
        before, after = (children[i - 1] if i else None), (children[i + 1] if i + 1 < len(children) else None)
        operator = child[0] if child.tag == "munder" else child
        if operator.tag == "mo" and (operator.text or "").isalpha() and len(operator.text) > 1:
            operator.set("lspace", "0" if is_open(before) else THIN)
            operator.set("rspace", "0" if begins_with_bracket(after) else THIN)
        elif child.tag == "mo" and child.text in "+−±∓" and is_open(before):
            child.set("form", "prefix")
        if child.tag == "mtable":
            child.set("displaystyle", "true")
        space(child)


def formula(match) -> str:
    math = ElementTree.fromstring(match[0].replace(' xmlns="http://www.w3.org/1998/Math/MathML"', "", 1))
    semantics = math[0]
    math.remove(semantics)
    math.append(semantics[0])
    if math.get("display") == "inline":
        math.attrib.pop("display")
    space(math)
    return ElementTree.tostring(math, encoding="unicode")


def tidied(page: str) -> str:
    """The page with its formulas so; brackets and stops of the text stay on the line of the formula that they belong to."""
    page = re.sub(r"<math .*?</math>", formula, page, flags=re.S)
    beside = r"(\(?)(<math>(?:(?!</math>).)*</math>)([,.;:)]*)"
    return re.sub(beside, lambda m: f'<span class="line">{m[0]}</span>' if m[1] or m[3] else m[0], page, flags=re.S)
