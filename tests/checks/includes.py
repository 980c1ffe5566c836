#!/usr/bin/env python3
"""Each source has what it uses of the C++ standard library from a header that it or a header of this project includes, not
from whatever this compiler's standard library includes in its own headers.

    includes.py SOURCE

Known are the names below. Exit code 1: a header is missing.
"""
import functools
import re
import sys
from pathlib import Path

SOURCE = Path(sys.argv[1])
FOLDERS = [SOURCE / folder for folder in ("src", "src/include", "src/application/cli", "tests", "tests/mutation", "tests/stress", "bench")]
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
    text = re.sub(r'R"(\w*)\(.*?\)\1"', '""', file.read_text(encoding="utf-8"), flags=re.S)
    return re.sub(r'"(\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', "", text, flags=re.S)


@functools.lru_cache(None)
def included(file: Path) -> frozenset:
    """The standard headers that a file includes, by way of this project's headers, too."""
    found, seen, left = set(), set(), [file]
    while left:
        at = left.pop()
        if at in seen:
            continue
        seen.add(at)
        for mark, name in re.findall(r'^ *#include ([<"])(.*?)[>"]', at.read_text(encoding="utf-8"), re.M):
            if mark == "<":
                found |= {name, *ALSO.get(name, [])}
            else:
                left += [there for folder in (at.parent, *FOLDERS) if (there := folder / name).exists()][:1]
    return frozenset(found)


def main() -> int:
    files = sorted(file for folder in ("src", "tests", "bench", "examples")
                   for file in (SOURCE / folder).rglob("*.[ch]pp") if "build" not in file.parts)
    missing = [f"{file.relative_to(SOURCE)}: <{header}> is not included, for {used[0]}" for file in files
               for header, names in NAMES.items() if header not in included(file)
               and (used := re.search(names, code(file)))]
    print("\n".join(missing) or f"{len(files)} sources")
    return 1 if missing or len(files) < 100 else 0


if __name__ == "__main__":
    sys.exit(main())
