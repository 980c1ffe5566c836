#!/usr/bin/env python3
"""Looks through src/ for what could make a result depend on more than its input: scan.py [FOLDER]

Words, not meanings: what is found is either changed or listed below with the reason why it can stay. Variables that
nobody set cannot be found by words; the matrix runs with patterns in them instead.
"""
import re
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2] / "src"
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
    if folder == SOURCE:
        found += [f"{name}: {word} is allowed, but not there any more" for name, word in sorted(ALLOWED.keys() - used)]
    return found


if __name__ == "__main__":
    all_found = findings(Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else SOURCE)
    for text in all_found:
        print(text)
    sys.exit(1 if all_found else 0)
