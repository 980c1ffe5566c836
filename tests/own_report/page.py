"""A report's page as this test reads it: well-formed, and its numbers with what stands about them."""
from html.parser import HTMLParser

VOID = {"meta", "br", "hr", "img", "input", "link"}


class Page(HTMLParser):
    """Holds what every page must be; what is not is in `faults`."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.faults, self.open, self.ids, self.headings, self.links = [], [], [], [], []
        self.sections, self.tables, self.figures, self.svgs = {}, [], [], []
        self.section, self.numbers, self.words = None, {}, {}
        self.value = None
        if not text.startswith("<!DOCTYPE html>\n"):
            self.faults.append("no doctype")
        self.feed(text)
        self.close()
        if self.open:
            self.faults.append(f"not closed: {self.open}")
        self.look()

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        if len(given) != len(attributes):
            self.faults.append(f"<{tag}> has an attribute twice")
        if tag not in VOID:
            self.open.append(tag)
        self.ids += [given["id"]] if "id" in given else []
        if tag in ("h1", "h2", "h3"):
            self.headings.append(int(tag[1]))
        if tag == "html" and not given.get("lang"):
            self.faults.append("no language")
        if tag in ("section", "header"):
            self.section = given.get("id", tag)
            self.numbers[self.section], self.words[self.section] = [], ""
        if tag == "table":
            self.tables.append({"caption": False})
        if tag == "caption":
            self.tables[-1]["caption"] = True
        if tag == "th" and given.get("scope") not in ("row", "col"):
            self.faults.append("a <th> without scope")
        if tag == "figure":
            self.figures.append(given.get("id"))
        if tag == "svg":
            self.svgs.append(given)
        if tag == "data":
            self.value = given["value"]
            float(self.value)
            if self.section:
                self.numbers[self.section].append(float(self.value))
        for name in ("href", "src", "xlink:href"):
            if name in given:
                self.links.append(given[name])

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.handle_endtag(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open[-1] != tag:
            self.faults.append(f"</{tag}> closes {self.open[-1:]}")
            return
        self.open.pop()
        if tag in ("section", "header"):
            self.section = None
        if tag == "data":
            self.value = None

    def handle_data(self, text):
        if self.section and "svg" not in self.open and "style" not in self.open:
            self.words[self.section] += text
        if self.value is not None and not self.reads_as(text, float(self.value)):
            self.faults.append(f"{text!r} is shown for {self.value}")

    def reads_as(self, text, value):
        """What is shown is the number rounded; a power of ten comes apart from it, in <sup>."""
        text = text.replace("−", "-")
        if self.open[-1] == "sup":
            return abs(float(text)) < 400
        if text.endswith("×10"):
            return float(text[:-3]) != 0
        return abs(float(text) - value) <= 0.006 * abs(value)

    def look(self):
        if self.headings[:1] != [1] or any(b > a + 1 for a, b in zip(self.headings, self.headings[1:])):
            self.faults.append(f"headings out of order: {self.headings}")
        if len(set(self.ids)) != len(self.ids):
            self.faults.append(f"an id twice: {sorted(i for i in self.ids if self.ids.count(i) > 1)[:3]}")
        if not all(table["caption"] for table in self.tables):
            self.faults.append("a table without caption")
        for svg in self.svgs:
            if svg.get("role") != "img" or not svg.get("aria-label"):
                self.faults.append("an <svg> without role or description")
        for link in self.links:
            if not link.startswith("#") or link[1:] not in self.ids:
                self.faults.append(f"a link to elsewhere or nowhere: {link}")
