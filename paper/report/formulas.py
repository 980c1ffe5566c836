"""The formulas of a page as browsers set them well: pandoc's MathML with TeX's spaces.

Browsers take a stretchy bracket from the font's large ones, with space around it, give an operator between two others the
space of a binary one, and a function's name space on both sides. Here brackets stretch only around what is tall; signs
and functions say what they are. TeX's source, which pandoc writes beside each formula, is left out.
"""
import re
import xml.etree.ElementTree as ElementTree

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
