#!/usr/bin/env python3
"""What the text of sources, documents and the Makefile must be.

    sources.py includes     each source has what it uses of the C++ standard library from a header that it or a header of this
                            project includes, not from whatever this compiler's standard library includes in its own headers;
                            each header of this project that is named is there, also by sources that only the bench compiles
    sources.py links        every relative link of every Markdown file leads to a file of the project, and every anchor to a
                            heading. Not of the sources of the report: its links are followed in a browser
    sources.py equations    every equation (M7.2) and lemma (L2) that the code cites stands in docs/mathematics.md, and each of
                            these is cited
    sources.py layers       the folders of src/ include only themselves and those to which arrows lead in the picture of
                            docs/architecture.md, whose table names them all; no arrow is in a circle or without an include
    sources.py scan         nothing in src/ could make a result depend on more than its input. Words, not meanings: what is
                            found is either changed or allowed below with the reason why it can stay. Variables that nobody
                            set cannot be found by words; same_bits/matrix.py runs with patterns in them instead
    sources.py tests BUILD  each test of CTest is run by `make check` or `make check-long`; only what makes a fixture may be run by both

Exit code 1: faults, one a line.
"""
import functools
import json
import os
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path
from urllib.parse import unquote

SOURCE = Path(__file__).resolve().parents[2]


def text_of(file: Path) -> str:
    return file.read_text(encoding="utf-8")


# includes
FOLDERS = [SOURCE / folder for folder in ("src", "src/include", "src/application/cli", "tests", "tests/mutation", "tests/oracle", "tests/stress", "bench")]
ALGORITHMS = ("all_of any_of binary_search clamp copy copy_if copy_n count count_if equal equal_range fill fill_n find find_if generate "
              "is_sorted lower_bound max max_element merge min min_element minmax minmax_element mismatch none_of nth_element "
              "partial_sort partition remove_if replace reverse rotate set_difference shuffle sort stable_sort transform unique upper_bound")
FUNCTIONS = "abs acos asin atan atan2 ceil copysign cos exp fabs floor fma fmod frexp hypot isfinite isinf isnan ldexp log log10 log2 nextafter pow round signbit sin sqrt tan"
# Header -> a pattern of names that it has.
NAMES = {
    "algorithm": rf"std::(ranges::)?({'|'.join(ALGORITHMS.split())})\(",
    "array": "std::array<", "atomic": "std::atomic<", "bit": "std::(bit_cast|bit_width|countl_zero|countr_zero|popcount)",
    "charconv": "std::(from|to)_chars", "chrono": "std::chrono::", "cmath": rf"std::({'|'.join(FUNCTIONS.split())})\(",
    "complex": "std::complex<", "concepts": "std::(convertible_to|floating_point|integral|same_as)\\b",
    "cstdint": r"std::u?int(8|16|32|64)_t", "cstdio": "std::(FILE|fopen|fputs|printf|snprintf)\\b", "cstdlib": "std::(exit|getenv|strtod|system)\\(",
    "cstring": "std::(memcmp|memcpy|strcmp|strerror|strlen)\\(", "filesystem": "std::filesystem::", "fstream": "std::[io]?fstream",
    "functional": "std::(function<|greater|identity|invoke\\(|multiplies|plus|ref\\()", "iomanip": "std::set(fill|precision|w)\\(",
    "iostream": "std::(cerr|cin|clog|cout)\\b", "limits": "std::numeric_limits<", "map": "std::(multi)?map<",
    "memory": "std::(addressof|make_shared|make_unique|shared_ptr|unique_ptr)\\b", "mutex": "std::(lock_guard|mutex|scoped_lock|unique_lock)\\b",
    "numbers": "std::numbers::", "numeric": "std::(accumulate|gcd|inner_product|iota|midpoint|partial_sum|reduce)\\(",
    "optional": "std::(optional<|nullopt)", "random": "std::(mt19937|uniform_\\w+_distribution|normal_distribution)", "set": "std::set<",
    "span": "std::span<", "sstream": "std::[io]?stringstream", "stdexcept": "std::(domain_error|invalid_argument|logic_error|out_of_range|runtime_error)\\b",
    "string": "std::(string\\b|to_string\\()", "string_view": "std::string_view", "system_error": "std::(errc|error_code|system_error)\\b",
    "thread": "std::(jthread|thread|this_thread)\\b", "tuple": "std::(tie\\(|tuple\\b)", "type_traits": "std::(conditional_t|decay_t|is_\\w+_v|remove_cvref_t)\\b",
    "utility": "std::(as_const|declval|exchange|forward|in_range|move|pair|swap)\\b", "variant": "std::(get_if|holds_alternative|monostate|variant|visit)\\b",
    "vector": "std::vector<",
}
# What the standard, or the nature of the thing, says of a header: it has the names of these, too.
ALSO = {"string": ["string_view"], "map": ["utility"], "filesystem": ["system_error"], "iostream": ["ostream", "istream"]}


@functools.lru_cache(1)
def code(file: Path) -> str:
    """Without comments and texts."""
    text = re.sub(r'R"(\w*)\(.*?\)\1"', '""', text_of(file), flags=re.S)
    return re.sub(r'"(\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', "", text, flags=re.S)


@functools.lru_cache(None)
def own_includes(file: Path) -> tuple:
    """The standard headers that a file itself includes, and this project's."""
    found, own = set(), []
    for mark, name in re.findall(r'^ *#include ([<"])(.*?)[>"]', text_of(file), re.M):
        if mark == "<":
            found |= {name, *ALSO.get(name, [])}
        else:
            own += [there for folder in (file.parent, *FOLDERS) if (there := folder / name).exists()][:1]
    return found, own


@functools.lru_cache(None)
def included(file: Path) -> frozenset:
    """The standard headers that a file includes, by way of this project's headers, too."""
    found, seen, left = set(), set(), [file]
    while left:
        at = left.pop()
        if at not in seen:
            seen.add(at)
            found |= own_includes(at)[0]
            left += own_includes(at)[1]
    return frozenset(found)


def includes():
    files = sorted(file for folder in ("src", "tests", "bench", "examples")
                   for file in (SOURCE / folder).rglob("*.[ch]pp") if "build" not in file.parts)
    faults = [f"{file.relative_to(SOURCE)}: <{header}> is not included, for {used[0]}" for file in files
              for header, names in NAMES.items() if header not in included(file)
              and (used := re.search(names, code(file)))]
    faults += [f"{file.relative_to(SOURCE)}: {name}: there is no such header" for file in files
               for name in re.findall(r'^ *#include "(.*?)"', text_of(file), re.M)
               if not any((folder / name).exists() for folder in (file.parent, *FOLDERS))]
    return faults, len(files) >= 100, f"{len(files)} sources"


# links
def without_code(text: str) -> str:
    text = re.sub(r"^( *)(```+|~~~+).*?^\1\2 *$", "", text, flags=re.M | re.S)
    return re.sub(r"(`+)(?!`).*?(?<!`)\1(?!`)", "", text, flags=re.S)


def anchors_of(text: str) -> set:
    """What a heading is called in a link, as GitHub and GitLab call it, and ids that are given."""
    text = re.sub(r"^(```+).*?^\1 *$", "", text, flags=re.M | re.S)
    found, counted = set(re.findall(r"\{#([\w-]+)|<a (?:id|name)=\"([\w-]+)\"", text)), {}
    found = {one or other for one, other in found}
    for heading in re.findall(r"^#{1,6} +(.*?)[ #]*$", text, re.M):
        heading = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"\{#.*\}$", "", heading))
        name = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        counted[name] = counted.get(name, -1) + 1
        found.add(f"{name}-{counted[name]}" if counted[name] else name)
    return found


def links_of(text: str) -> list:
    text = without_code(text)
    return re.findall(r"\]\(<?([^)\s>]+)>?(?: +\"[^\"]*\")?\)", text) + re.findall(r"^\[[^\]]+\]: *(\S+)", text, re.M) + \
        re.findall(r"(?:href|src)=\"([^\"]+)\"", text)


def faults_of(file: Path) -> list:
    faults = []
    for link in links_of(text_of(file)):
        if re.match(r"[a-z][a-z0-9+.-]*:", link):
            continue
        path, _, anchor = unquote(link).partition("#")
        target = (file.parent / path).resolve() if path else file
        if not target.is_relative_to(SOURCE) or not target.exists():
            faults.append(f"{file.relative_to(SOURCE)}: {link}: there is no such file")
        elif anchor and target.suffix == ".md" and anchor not in anchors_of(text_of(target)):
            faults.append(f"{file.relative_to(SOURCE)}: {link}: there is no such heading")
    return faults


def pages() -> list:
    found = []
    for folder, folders, files in os.walk(SOURCE):
        folders[:] = [name for name in folders if not name.startswith(".") and not (Path(folder) / name / "CMakeCache.txt").exists()]
        found += [Path(folder) / name for name in files if name.endswith(".md")]
    return [page for page in sorted(found) if page.parent != SOURCE / "paper/report"]


def links():
    count = sum(len(links_of(text_of(page))) for page in pages())
    return [fault for page in pages() for fault in faults_of(page)], count >= 50, f"{len(pages())} files, {count} links"


# equations
EQUATION = r"\bM\d+\.\d+\b"
LEMMA = r"\bLemmas?\s+(?://\s*)?(L\d+)\b"


def equations():
    text = text_of(SOURCE / "docs/mathematics.md")
    stated = re.findall(r"\\tag\{(" + EQUATION + r")\}", text) + re.findall(r"\*\*" + LEMMA, text)
    faults = [f"docs/mathematics.md: {number} stands {count} times" for number, count in Counter(stated).items() if count > 1]
    faults += [f"docs/mathematics.md: there is no {number}" for number in sorted(set(re.findall(EQUATION, text)) - set(stated))]

    cited = set()
    for folder in ("src", "tests", "figures", "paper"):
        for file in sorted((SOURCE / folder).rglob("*.?pp" if folder in ("src", "tests") else "*.gp")):
            code = text_of(file)
            numbers = set(re.findall(EQUATION, code)) | set(re.findall(LEMMA, code))
            faults += [f"{file.relative_to(SOURCE)}: there is no {number}" for number in sorted(numbers - set(stated))]
            cited |= numbers if folder == "src" else set()
    faults += [f"docs/mathematics.md: nothing in src/ cites {number}" for number in stated if number not in cited]
    return faults, len(stated) >= 40, f"{len(stated)} equations and lemmas"


# layers
def folder_of(path: str, rows: list):
    """The node of the first row of the table that fits: a folder, else a beginning of names, else the library's own folder."""
    for row in sorted(rows, key=lambda row: (not row.endswith("/"), row == "impact_damper/*")):
        if path.startswith(row.rstrip("*")) and (row.endswith("/") or path.count("/") == 1):
            return "model" if row == "impact_damper/*" else row.rstrip("/*").split("/")[-1]
    return None


def reached(node: str, arrows: dict) -> set:
    found, left = set(), [node]
    while left:
        new = arrows.get(left.pop(), set()) - found
        found |= new
        left += new
    return found


def layers():
    page = text_of(SOURCE / "docs/architecture.md")
    rows = [row for row in re.findall(r"^\| `([\w/*]+)` \|", page, re.M) if "/" in row]
    arrows = {}
    for node, others in re.findall(r"^ *(\w+) --> ([\w& ]+)$", page, re.M):
        arrows.setdefault(node, set()).update(others.split(" & "))
    faults, used, count = [f"{node}: arrows lead back to it" for node in arrows if node in reached(node, arrows)], set(), 0
    for file in sorted((SOURCE / "src").rglob("*.?pp")):
        path = str(file.relative_to(SOURCE / "src")).removeprefix("include/")
        own = folder_of(path, rows)
        if own is None:
            faults.append(f"src/{path}: docs/architecture.md does not name its folder")
        for included in re.findall(r'^#include "((?:impact_damper|application)/[^"]+)"', text_of(file), re.M):
            count += 1
            used.add((own, folder_of(included, rows)))
            if folder_of(included, rows) not in {own} | reached(own, arrows):
                faults.append(f"src/{path}: includes {included}, to which no arrow leads")
    faults += [f"{node} --> {other}: nothing is included" for node in arrows for other in arrows[node] if (node, other) not in used]
    return faults, count >= 200, f"{len(rows)} folders, {count} includes"


# scan
WORDS = {
    "an order of the library's own": r"\bunordered_\w+|\bstd::hash\b",
    "the locale": r"\bsetlocale\b|\bstd::locale\b|\bimbue\b|\blocaleconv\b|\b\w*(printf|scanf)\b|\b(strtod|strtof|atof|"
                  r"stod|stof|stold)\b|\bo?stringstream\b|\bofstream\b|\bstd::cout\b|\bstd::format\b|"
                  r"\b(isalpha|isspace|isdigit|toupper|tolower|iswalpha)\b",
    "the clock or the time zone": r"\w+_clock\b|\b(gmtime|localtime|mktime|strftime|gettimeofday|clock_gettime)\w*\b|"
                                  r"\bstd::(time|clock)\b|__DATE__|__TIME__|__TIMESTAMP__|\blast_write_time\b",
    "chance": r"\brandom_device\b|\bs?rand(om)?\(|_distribution\b|_engine\b<|\bdefault_random_engine\b",
    "the surroundings": r"\b(secure_)?getenv\b|\benviron\b|\bhardware_concurrency\b|\bgethostname\b|\bcurrent_path\b",
    "memory that nobody set": r"\b(m|re)alloc\(|\baligned_alloc\b|_for_overwrite\b|\bnew (double|float|int|char|bool)\b|"
                              r"\balloca\b",
    "addresses": r"\buintptr_t\b|\bget_id\b|\bstd::less<\w+\s*\*>|%p\b|\b(map|set)<(const )?\w+\s*\*",
    "an order of summation": r"\bstd::execution\b|\b(transform_)?reduce\(|#pragma omp|\batomic<double>",
    "another precision": r"\bfloat\b|\blong double\b|\b__float128\b|\bfma\(",
}
ALLOWED = {
    ("application/cli/main.cpp", "ostringstream"): "CLI11 writes its help into it, in the classic locale; no number of a result",
    ("application/cli/drawing.cpp", "environ"): "where gnuplot is looked for, and what it inherits; what it heeds is set (figures/draw)",
    ("application/cli/sweep.cpp", "steady_clock"): "when to show progress on stderr, and how long a sweep will take",
    ("impact_damper/base/number_by_c_library.cpp", "snprintf"):
        "only for WebAssembly, whose C library has one locale; the text is held against to_chars (number_text: ...)",
    ("impact_damper/base/number_by_c_library.cpp", "strtod"): "the same",
    ("impact_damper/io/json_reader.cpp", "map<const Json*"): "objects are looked up in it, never gone through in its order",
    ("include/impact_damper/analysis/parallel.hpp", "hardware_concurrency"):
        "how many threads; that results do not depend on it is tested (cli: equal bytes with any number of threads)",
}


def findings(folder: Path) -> list:
    """What is not valid, as text; also what is allowed, but no longer there."""
    found, used = [], set()
    for path in sorted(path for path in folder.rglob("*") if path.suffix in (".cpp", ".hpp", ".in")):
        name = str(path.relative_to(folder))
        for number, line in enumerate(path.read_text().split("\n"), 1):
            code = re.sub(r'"(\\.|[^"\\])*"', '""', line).split("//")[0]
            for subject, words in WORDS.items():
                for match in re.finditer(words, code):
                    if (name, match[0]) in ALLOWED:
                        used.add((name, match[0]))
                    else:
                        found.append(f"{name}:{number}: {match[0]}: depends on {subject}")
    if folder == SOURCE / "src":
        found += [f"{name}: {word} is allowed, but not there any more" for name, word in sorted(ALLOWED.keys() - used)]
    return found


def scan():
    return findings(SOURCE / "src"), True, f"{len(ALLOWED)} words are allowed"


# tests
def listed(*options) -> dict:
    """Of each test that ctest would run with these options: its properties, by its name."""
    shown = subprocess.run(["ctest", "--test-dir", sys.argv[2], "--show-only=json-v1", *options], check=True, stdout=subprocess.PIPE)
    return {test["name"]: {each["name"]: each["value"] for each in test["properties"]} for test in json.loads(shown.stdout)["tests"]}


def tests():
    rules = {target: re.search(rf"^{target}:.*\n\t@\$\(run_tests\) (-LE?) '(.*)'$", text_of(SOURCE / "Makefile"), re.M).groups()
             for target in ("test", "check-long")}
    every, quick, long = listed(), *(listed(option, regex.replace("$$", "$")) for option, regex in rules.values())
    both = quick.keys() & long.keys()
    faults = [f"neither runs {name}" for name in every.keys() - quick.keys() - long.keys()]
    faults += [f"both run {name}" for name in both if "FIXTURES_SETUP" not in every[name]]
    faults += [f"make check runs {name}, whose label is long" for name in quick if "long" in every[name]["LABELS"]]
    return faults, bool(long), f"{len(every)} tests: {len(quick)} by make check, {len(long)} by make check-long, {len(both)} of them by both"


if __name__ == "__main__":
    faults, is_enough, summary = {"includes": includes, "links": links, "equations": equations, "layers": layers, "scan": scan,
                                  "tests": tests}[sys.argv[1]]()
    print("\n".join([*faults, f"{summary}, {len(faults)} faults"]))
    sys.exit(bool(faults) or not is_enough)
