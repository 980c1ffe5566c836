#include <doctest/doctest.h>

#include <string>

#include "application/measured/reduction.hpp"
#include "impact_damper/base/errors.hpp"

using namespace impact_damper;

namespace {

std::string rows(std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += std::to_string(i) + ".5,-" + std::to_string(i) + "e-1\n";
  return text;
}
std::string problem_of(const std::string& text) {
  try {
    parse_measured_record("r.csv", text);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("a record is read in each of its units") {
  const auto record = parse_measured_record("r.csv", "t_ms,x_um\n" + rows(64));
  CHECK(record.quantity == MeasuredQuantity::displacement);
  REQUIRE(record.time.size() == 64);
  CHECK(record.time[10] == 10.5 * 1e-3);
  CHECK(record.value[10] == -1.0 * 1e-3);
  CHECK(parse_measured_record("r.csv", "t_s,x_m\n" + rows(64)).value[10] == -1e3);
  CHECK(parse_measured_record("r.csv", "t_s,x_mm\n" + rows(64)).value[10] == -1);
  const auto acceleration = parse_measured_record("r.csv", "t_s,a_g\n" + rows(64));
  CHECK(acceleration.quantity == MeasuredQuantity::acceleration);
  CHECK(acceleration.value[10] == -9806.65);
  CHECK(parse_measured_record("r.csv", "t_s,a_m_per_s2\n" + rows(64)).value[10] == -1e3);
  CHECK(parse_measured_record("r.csv", "t_s,a_mm_per_s2\n" + rows(64)).value[10] == -1);
}

TEST_CASE("quotes, a byte order mark, CRLF and empty lines are what RFC 4180 and spreadsheets make of them") {
  std::string text = "\xef\xbb\xbf\"t_s\",\"x_mm\"\r\n";
  for (int i = 0; i < 64; ++i) text += "\"" + std::to_string(i) + "\"," + std::to_string(2 * i) + "\r\n";
  const auto record = parse_measured_record("r.csv", text + "\r\n");
  REQUIRE(record.time.size() == 64);
  CHECK(record.value[63] == 126);
}

TEST_CASE("a plus sign and a number too small for a double are read as elsewhere") {
  const auto record = parse_measured_record("r.csv", "t_s,x_mm\n-1,+1e-400\n+0.25,+3\n" + rows(64));
  CHECK(record.value[0] == 0);
  CHECK(record.time[1] == 0.25);
  CHECK(record.value[1] == 3);
}

TEST_CASE("an empty cell is a missing sample") {
  const auto record = parse_measured_record("r.csv", "t_s,x_mm\n-1,\n" + rows(64));
  CHECK(record.time.size() == 64);
  CHECK(record.empty_cells == 1);
}

TEST_CASE("what is wrong is told with its line") {
  CHECK(problem_of("") ==
        "r.csv: line 1: must head two columns with their units, as in \"t_s,x_mm\", got \"\"");
  CHECK(problem_of("t_s;x_mm\n").find("line 1: must head two columns") != std::string::npos);
  CHECK(problem_of("t_s,x_cm\n")
            .find("line 1: a column must be headed x_mm, x_m, x_um, a_m_per_s2, a_mm_per_s2 or "
                  "a_g, got \"x_cm\"") != std::string::npos);
  CHECK(problem_of("time,x_mm\n").find("line 1: a column must be headed t_s or t_ms, got \"time\"") !=
        std::string::npos);
  CHECK(problem_of("t_s,x_mm\n0,1\n1,abc\n") ==
        "r.csv: line 3: x_mm must be a number, or empty where a sample is missing, got \"abc\"");
  CHECK(problem_of("t_s,x_mm\n0,1\n1,nan\n").find("line 3: x_mm must be a number") != std::string::npos);
  CHECK(problem_of("t_s,x_mm\n,1\n").find("line 2: t_s must be a number, got \"\"") != std::string::npos);
  CHECK(problem_of("t_s,x_mm\n0,1\n0,1\n") ==
        "r.csv: line 3: t_s must be larger than in the row before, 0, got 0");
  CHECK(problem_of("t_ms,x_m\n0,1\n1,-1e13\n") ==
        "r.csv: line 3: x_m must be at most 1e+12 either way, got -1e+13");
  CHECK(problem_of("t_ms,x_m\n0,1\n1e19,1\n").find("line 3: t_ms must be at most") != std::string::npos);
  // Equal once they are seconds.
  CHECK(problem_of("t_ms,x_mm\n1.9800000000000002,1\n1.9800000000000004,1\n")
            .find("line 3: t_ms must be larger") != std::string::npos);
  CHECK(problem_of("t_s,x_mm\n0,1,2\n") == "r.csv: line 2: must have 2 cells, got 3");
  CHECK(problem_of("t_s,x_mm\n" + rows(63)) == "r.csv: must have at least 64 samples, got 63");
  std::string many = "t_s,x_mm\n";
  for (int i = 0; i < 14; ++i) many += "x,1\n";
  CHECK(problem_of(many).find("and 4 more lines that are not valid") != std::string::npos);
}
