// What a process may do to its arithmetic, and that no engine runs then. The compiler's part:
// tests/same_bits/.
#include "impact_damper/base/floating_point.hpp"

#include <doctest/doctest.h>

#include <cfenv>
#include <clocale>
#include <locale>
#include <string>
#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include "impact_damper/io/run_file.hpp"
#include "impact_damper/simulate.hpp"
#include "rejection.hpp"

using namespace impact_damper;

namespace {

Run short_run(const Engine& engine) { return simulate({.until_time = 20}, engine, {}); }

std::string rejection(const Engine& engine) {
  return rejection_of<NumericalError>([&] { short_run(engine); });
}

const Engine engines[] = {Exact{}, Restitution{}, Cem{}};

}  // namespace

TEST_CASE("every engine runs with the arithmetic that a process starts with") {
  for (const Engine& engine : engines) CHECK(short_run(engine).half_cycles->amplitude.size() > 5);
}

TEST_CASE("no engine runs with another rounding mode, and each does again once it is back") {
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO})
    for (const Engine& engine : engines) {
      std::fesetround(mode);
      const std::string text = rejection(engine);
      std::fesetround(FE_TONEAREST);
      CHECK(contains(text, "the rounding mode is not to nearest"));
      CHECK(rejection(engine) == not_rejected);
    }
}

#ifdef __SSE2__
TEST_CASE("no engine runs where results or operands that are denormal count as zero") {
  const unsigned before = _mm_getcsr();
  for (const unsigned bits : {0x8000u, 0x0040u, 0x8040u}) {  // FTZ, DAZ
    for (const Engine& engine : engines) {
      _mm_setcsr(before | bits);
      const std::string text = rejection(engine);
      _mm_setcsr(before);
      CHECK(contains(text, "denormal numbers are flushed to zero"));
    }
  }
}
#endif

TEST_CASE("a process that writes its own numbers with commas gets the same run file") {
  struct Commas : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const Run run = short_run(Cem{});
  const std::string plain = run_text(run);
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Commas));
  const std::string with_commas = run_text(short_run(Cem{}));
  std::locale::global(before);
  CHECK(with_commas == plain);
}
