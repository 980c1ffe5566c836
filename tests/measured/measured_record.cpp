#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "application/measured/record.hpp"
#include "impact_damper/base/errors.hpp"

using namespace impact_damper;

namespace {

std::string rows(std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += std::to_string(i) + ".5,-" + std::to_string(i) + "e-1\n";
  return text;
}
std::string problem_of(const std::string& text, const RecordOptions& options = {}) {
  try {
    parse_measured_record("r.csv", text, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

// The record that the texts below spell: sample i of 80 at i/4 s, with (i - 40)/8 mm. Each row is made from
// these numbers.
constexpr int count = 80;
std::string text_of(double number, bool comma = false) {
  std::string text = std::to_string(number);
  if (comma) text[text.find('.')] = ',';
  return text;
}
std::string made(const std::string& head, const std::function<std::string(double, double)>& row,
                 const std::string& foot = "") {
  std::string text = head;
  for (int i = 0; i < count; ++i) text += row(i / 4.0, (i - 40) / 8.0);
  return text + foot;
}
// Whether this is that record, times a factor. Returns how it was read.
std::string is_the_record(const std::string& text, const RecordOptions& options = {}, double factor = 1,
                          MeasuredQuantity quantity = MeasuredQuantity::displacement) {
  const MeasuredRecord record = parse_measured_record("r.csv", text, options);
  CHECK(record.quantity == quantity);
  REQUIRE(record.time.size() == count);
  double worst = 0;
  for (int i = 0; i < count; ++i) {
    worst = std::max(worst, std::abs(record.time[std::size_t(i)] - record.time[0] - i / 4.0));
    worst = std::max(worst, std::abs(record.value[std::size_t(i)] / factor - (i - 40) / 8.0));
  }
  CHECK(worst < 1e-6);
  return record.read_as;
}
std::string in_utf16(const std::string& ascii, bool little) {
  std::string bytes = little ? "\xff\xfe" : "\xfe\xff";
  for (const char c : ascii) bytes += little ? std::string{c, '\0'} : std::string{'\0', c};
  return bytes;
}

}  // namespace

TEST_CASE("records are read as instruments write them") {
  using std::to_string;
  const auto n = [](double number) { return text_of(number); };
  const auto c = [](double number) { return text_of(number, true); };
  SUBCASE("by hand: semicolons, decimal commas, no head") {
    CHECK(is_the_record(made("", [&](double t, double x) { return c(t) + ";" + c(x) + "\n"; }),
                        {.column = "2:mm", .time = "1:s"}) ==
          "column 2 as displacement in mm; time in column 1 in s; semicolons between cells, decimal commas");
  }
  SUBCASE("LabVIEW: a block above, tabs, decimal commas, an empty column of comments") {
    const std::string head =
        "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\n***End_of_Header***\t\n\t\n"
        "Channels\t2\t\t\nSamples\t80\t80\t\nY_Unit_Label\tmm\tV\t\nDelta_X\t0,250000\t0,250000\t\n"
        "***End_of_Header***\t\t\t\n";
    CHECK(is_the_record(made(head + "X_Value\tWeg\tUntitled 1\tComment\n",
                             [&](double t, double x) { return c(t) + "\t" + c(x) + "\t0,5\t\n"; })) ==
          "column 2, \"Weg\", as displacement in mm; time in column 1 in s; tabs between cells, decimal "
          "commas, "
          "9 lines above left out");
    // Without a column of times: the step is in the block.
    CHECK(is_the_record(made(head + "X_Value\tWeg\tUntitled 1\tComment\n", [&](double, double x) {
            return "\t" + c(x) + "\t0,5\t\n";
          })).find("; 4 samples/s; ") != std::string::npos);
  }
  SUBCASE("a logger: heads in a comment, blanks, g") {
    CHECK(
        is_the_record(made("# logger 7\n# time(s), acceleration(g)\n",
                           [&](double t, double x) { return "  " + n(t) + "   " + n(x) + "\n"; }),
                      {}, 9806.65, MeasuredQuantity::acceleration) ==
        "column 2, \"acceleration(g)\", as acceleration in g; time in column 1 in s; blanks between cells, 1 "
        "line "
        "above left out");
    is_the_record(
        made("time (s) velocity (cm/s)\n", [&](double t, double x) { return n(t) + " " + n(x) + "\n"; }), {},
        10, MeasuredQuantity::velocity);
  }
  SUBCASE("phyphox: quoted heads, five columns") {
    const std::string text = made(
        "\"Time (s)\",\"Linear Acceleration x (m/s^2)\",\"Linear Acceleration y (m/s^2)\","
        "\"Absolute acceleration (m/s^2)\"\n",
        [&](double t, double x) { return n(t) + "," + n(-x) + "," + n(x) + "," + n(x * x) + "\n"; });
    CHECK(problem_of(text) ==
          "r.csv: has several columns that could be the record: give --column N; its columns are 1 \"Time "
          "(s)\" "
          "in s, 2 \"Linear Acceleration x (m/s^2)\" in m/s2, 3 \"Linear Acceleration y (m/s^2)\" in m/s2 "
          "and 4 "
          "\"Absolute acceleration (m/s^2)\" in m/s2");
    for (const char* const column : {"3", "linear acceleration y (m/s^2)"})
      is_the_record(text, {.column = column}, 1e3, MeasuredQuantity::acceleration);
    is_the_record(text, {.column = "3:g"}, 9806.65, MeasuredQuantity::acceleration);
  }
  SUBCASE("clock stamps, also past midnight, with a line drawn below the heads") {
    const auto clock = [](double t) {
      const int of_day = (86395 + int(t)) % 86400;
      return to_string(of_day / 3600) + ":" + to_string(of_day / 60 % 60) + ":" + to_string(of_day % 60) +
             text_of(t - std::floor(t)).substr(1);
    };
    const auto day = [](double t) { return std::string(t < 5 ? "29" : "1"); };
    const std::string head = "time\tx\n--------\n";
    const std::string read_as = is_the_record(made(head,
                                                   [&](double t, double x) {
                                                     return "2024-0" + std::string(t < 5 ? "2-29" : "3-01") +
                                                            "T" + clock(t) + "\t" + n(x) + "\n";
                                                   }),
                                              {.column = "x:mm"});
    CHECK(read_as.find("time in column 1 as clock stamps") != std::string::npos);
    is_the_record(made(head,
                       [&](double t, double x) {
                         return day(t) + (t < 5 ? ".02" : ".03") + ".2024 " + clock(t) + "\t" + n(x) + "\n";
                       }),
                  {.column = "x:mm"});
    is_the_record(made("Date,Time,Position (mm)\n", [&](double t, double x) {
      return (t < 5 ? "2/29" : "3/1") + std::string("/2024,") + clock(t) + "," + n(x) + "\n";
    }));
    CHECK(problem_of(made("time\tx_mm\n",
                          [&](double t, double x) { return clock(std::floor(t)) + "\t" + n(x) + "\n"; }))
              .find("line 3: a time must be larger than in the row before, 86395 s, got 86395 s; of a clock "
                    "that is "
                    "coarser than the samples give --rate instead") != std::string::npos);
    CHECK(is_the_record(made("time\tx_mm\n",
                             [&](double t, double x) { return clock(std::floor(t)) + "\t" + n(x) + "\n"; }),
                        {.rate = 4}) ==
          "column 2, \"x_mm\", as displacement in mm; 4 samples/s; tabs between cells");
  }
  SUBCASE("a day that is none is no clock stamp") {
    for (const char* const day :
         {"2024-02-30", "2023-02-29", "2024-13-01", "1e300.1.2024", "0/1/2024", "1.2"})
      CHECK(problem_of(made("time,x_mm\n", [&](double, double x) {
              return day + std::string("T10:11:12,") + n(x) + "\n";
            })) == "r.csv: must have rows of numbers, got none");
  }
  SUBCASE("Arduino: a byte order mark, CRLF, microseconds by name") {
    CHECK(is_the_record(made("\xef\xbb\xbfmicros,position_um\r\n",
                             [&](double t, double x) {
                               return to_string(int(t * 1e6)) + "," + to_string(int(x * 1e3)) + "\r\n";
                             })) ==
          "column 2, \"position_um\", as displacement in um; time in column 1 in us; commas between cells");
  }
  SUBCASE("an oscilloscope: words beside the numbers, volts") {
    int line = 0;
    const std::string text = made("", [&](double t, double x) {
      return (++line == 1 ? "Record Length,80,Points"
              : line == 2 ? "Vertical Units,V,"
                          : ",,") +
             std::string(",") + n(t) + "," + n(x) + ",\n";
    });
    CHECK(problem_of(text) ==
          "r.csv: has no column with a unit of motion: give --column N:mm, or m/s, g, V and so on; its "
          "columns are "
          "4 and 5\nr.csv: has no column with a unit of time: give --time N:s, or ms or us, or --rate in Hz");
    CHECK(problem_of(text, {.column = "5:V", .time = "4:s"}) ==
          "r.csv: the record is in V: give --sensitivity, as in \"100 mV/g\"");
    is_the_record(text, {.column = "5:V", .time = "4:s", .sensitivity = "100 mV/mm"}, 10);
    is_the_record(text, {.column = "5:mV", .time = "4:s", .sensitivity = "2 V/(m/s)"}, 0.5,
                  MeasuredQuantity::velocity);
    is_the_record(text, {.column = "5:V", .time = "4:s", .sensitivity = "-100 mV/mm"}, -10);
    CHECK(problem_of(text, {.column = "5:V", .time = "4:s", .sensitivity = "100 counts/mm"}) ==
          "r.csv: --sensitivity: must be in V, as the column is, got counts");
    for (const char* const wrong : {"100", "mV/g", "0 mV/g", "100 mV", "100 mV/s", "1e3 mm/g"})
      CHECK(problem_of(text, {.column = "5:V", .time = "4:s", .sensitivity = wrong})
                .find("r.csv: --sensitivity: must be V, mV, counts or FS per unit of the motion, as in \"100 "
                      "mV/g\", "
                      "got \"") == 0);
  }
  SUBCASE("Excel: sep=, units in brackets, Latin 1, a foot") {
    CHECK(is_the_record(made(
              "sep=;\n\"Zeit [ms]\";\"Auslenkung, gro\xdf [\xb5m]\"\n",
              [&](double t, double x) { return c(1e3 * t) + ";" + c(1e3 * x) + ";\n"; },
              "\nEnde der Messung;;\n")) ==
          "column 2, \"Auslenkung, groß [µm]\", as displacement in um; time in column 1 in ms; semicolons "
          "between "
          "cells, decimal commas, 1 line above left out, 1 line below left out");
  }
  SUBCASE("UTF-16, a row of units, CR alone") {
    for (const bool little : {false, true})
      CHECK(is_the_record(in_utf16(made("Zeit\tWeg\rs\tcm\r",
                                        [&](double t, double x) { return n(t) + "\t" + n(x) + "\r"; }),
                                   little),
                          {}, 10) ==
            "column 2, \"Weg\", as displacement in cm; time in column 1 in s; tabs between cells");
  }
  SUBCASE("columns swapped, upper case, a plus sign, samples that are missing, comments between") {
    int line = 0;
    const MeasuredRecord record = parse_measured_record("r.csv", made("X_MM, T_S\n", [&](double t, double x) {
                                                          ++line;
                                                          return (line == 7   ? "NaN"
                                                                  : line == 9 ? "OVLD"
                                                                              : (x < 0 ? "" : "+") + n(x)) +
                                                                 ", " + n(t) +
                                                                 (line == 20 ? "\n# a truck\n" : "\n");
                                                        }));
    CHECK(record.time.size() == count - 2);
    CHECK(record.read_as ==
          "column 1, \"X_MM\", as displacement in mm; time in column 2 in s; commas between cells, 1 line "
          "between "
          "left out; 2 values missing");
  }
  SUBCASE("one column, and how often it was sampled") {
    for (const bool comma : {false, true})
      is_the_record(made("", [&](double, double x) { return text_of(x, comma) + "\n"; }),
                    {.column = "1:m", .rate = 4}, 1e3);
    CHECK(problem_of(made("", [&](double, double x) { return n(x) + "\n"; })) ==
          "r.csv: column 1 has no unit: give --column 1:mm, or m/s, g, V and so on\n"
          "r.csv: has no column with a unit of time: give --time N:s, or ms or us, or --rate in Hz");
  }
  SUBCASE("a part of it") {
    const MeasuredRecord part = parse_measured_record(
        "r.csv", made("t_s,x_mm\n", [&](double t, double x) { return n(t) + "," + n(x) + "\n"; }),
        {.from = 2, .to = 18});
    REQUIRE(part.time.size() == 65);
    CHECK(part.time.front() == 2);
    CHECK(part.time.back() == 18);
    CHECK(part.read_as ==
          "column 2, \"x_mm\", as displacement in mm; time in column 1 in s; from 2 s; to 18 s; commas "
          "between cells");
  }
  SUBCASE("what no unit is does not become one") {
    for (const char* const head : {"x_furlong", "x (kg)", "displacement", "x_s2"})
      CHECK(problem_of(made("t_s," + std::string(head) + "\n", [&](double t, double x) {
              return n(t) + "," + n(x) + "\n";
            })).find("has no unit: give --column 2:mm") != std::string::npos);
    CHECK(problem_of(made("time,x_mm\n", [&](double t, double x) { return n(t) + "," + n(x) + "\n"; })) ==
          "r.csv: column 1, \"time\", has no unit: give --time 1:s, or ms or us");
    CHECK(problem_of(made("t_s,x_mm\n", [&](double t, double x) { return n(t) + "," + n(x) + "\n"; }),
                     {.column = "y"}) ==
          "r.csv: --column: must be one of 1 \"t_s\" in s and 2 \"x_mm\" in mm, got \"y\"");
  }
}

TEST_CASE("each unit is what it is in millimetres and seconds") {
  struct Known {
    const char* unit;
    double factor;
    MeasuredQuantity quantity;
  };
  using enum MeasuredQuantity;
  for (const auto& [unit, factor, quantity] : std::vector<Known>{
           {"m", 1e3, displacement},       {"cm", 10, displacement},        {"um", 1e-3, displacement},
           {"µm", 1e-3, displacement},     {"nm", 1e-6, displacement},      {"in", 25.4, displacement},
           {"inch", 25.4, displacement},   {"ft", 304.8, displacement},     {"m/s", 1e3, velocity},
           {"mm/s", 1, velocity},          {"mm_per_s", 1, velocity},       {"in/s", 25.4, velocity},
           {"m/s²", 1e3, acceleration},    {"m/s**2", 1e3, acceleration},   {"m s^-2", 1e3, acceleration},
           {"M/S2", 1e3, acceleration},    {"m_per_s2", 1e3, acceleration}, {"mm/s2", 1, acceleration},
           {"m/sec^2", 1e3, acceleration}, {"ft/s^2", 304.8, acceleration}, {"mg", 9.80665, acceleration},
           {"Gal", 10, acceleration}}) {
    const std::string head = "t_s,y (" + std::string(unit) + ")\n";
    CAPTURE(head);
    const MeasuredRecord record = parse_measured_record("r.csv", head + rows(64));
    CHECK(record.quantity == quantity);
    CHECK(record.value[10] == doctest::Approx(-factor).epsilon(1e-15));
  }
  for (const auto& [head, factor] : std::vector<std::pair<const char*, double>>{{"t_s", 1},
                                                                                {"time (sec)", 1},
                                                                                {"Time/ms", 1e-3},
                                                                                {"t [µs]", 1e-6},
                                                                                {"millis", 1e-3},
                                                                                {"t_min", 60}})
    CHECK(parse_measured_record("r.csv", std::string(head) + ",x_mm\n" + rows(64)).time[10] ==
          doctest::Approx(10.5 * factor).epsilon(1e-15));
}

template <class... Values>
std::string field(const char* format, const Values&... values) {
  std::array<char, 100> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

TEST_CASE("universal files are read by their fixed columns") {
  for (const bool is_even : {false, true}) {
    for (const bool is_double : {false, true}) {
      for (const char* const unit : {"mm", "NONE"}) {
        std::string text =
            "    -1\n   164\n         1  SI: Meter (newton)         2\n\n    -1\n    -1\n    58\ntip\nNONE\n"
            "03-May-24 10:11:12\nNONE\nNONE\n"
            "    1         0    1         0       NONE         1   3       NONE         0   0\n" +
            field("%10d%10d%10d%13.5E%13.5E%13.5E\n", is_double ? 4 : 2, count, is_even ? 1 : 0, 3.0, 0.25,
                  0.0) +
            field("%10d%5d%5d%5d %-20s %-20s\n", 17, 0, 0, 0, "Time", "s") +
            field("%10d%5d%5d%5d %-20s %-20s\n", 8, 0, 0, 0, "Displacement", unit) + "\n\n";
        const std::size_t in_a_row = !is_double ? 6 : 4;
        std::size_t written = 0;
        const auto write = [&](const std::string& number) {
          text += number + (++written % in_a_row == 0 ? "\n" : "");
        };
        for (int i = 0; i < count; ++i) {
          if (!is_even) write(field("%13.5E", 3 + i / 4.0));
          write(field(is_double ? "%20.11E" : "%13.5E", (i - 40) / 8.0));
        }
        text += "\n    -1\n";
        const double factor = unit == std::string("NONE") ? 1e3 : 1;
        CHECK(
            is_the_record(text, {}, factor).starts_with("column 2, \"Displacement\", as displacement in m"));
        CHECK(problem_of(text.substr(0, text.find('\n', text.size() * 2 / 3)))
                  .find("must have 80 values before it") != std::string::npos);
      }
    }
  }
  CHECK(problem_of("    -1\n    15\n    -1\n") ==
        "r.csv: must have a data set 58 with a real response over time, got none");
}

TEST_CASE("a sound file is a record in full scale, where the program can read one") {
  std::string bytes = "RIFF";
  const auto number = [&](std::uint32_t value, int width) {
    for (int i = 0; i < width; ++i) bytes += char(value >> (8 * i) & 0xff);
  };
  number(36 + 4 * count, 4);
  bytes += "WAVEfmt ";
  for (const auto& [value, width] :
       std::vector<std::pair<std::uint32_t, int>>{{16, 4}, {1, 2}, {2, 2}, {4, 4}, {16, 4}, {4, 2}, {16, 2}})
    number(value, width);
  bytes += "data";
  number(4 * count, 4);
  for (int i = 0; i < count; ++i) number(0, 2), number(std::uint32_t((i - 40) * 256), 2);
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "impact_damper_record.wav";
  std::ofstream(file, std::ios::binary) << bytes;
  const RecordOptions options{.column = "channel 2", .sensitivity = "62.5 FS/m"};
  try {
    const MeasuredRecord record = read_measured_record(file, options);
    REQUIRE(record.time.size() == count);
    CHECK(record.time[7] == 7 / 4.0);
    CHECK(record.value[10] == doctest::Approx(-30 / 128.0 / 62.5 * 1e3));
    CHECK(record.read_as == "column 2, \"channel 2\", as displacement in FS, 62.5 FS/m; 4 samples/s; sound");
  } catch (const InputError& error) {
    CHECK(error.what() ==
          file.string() + ": is a sound file, which this program was built without: libsndfile");
  }
  std::filesystem::remove(file);
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
  CHECK(problem_of("") == "r.csv: must have rows of numbers, got none");
  CHECK(problem_of("no, numbers\nat, all\n") == "r.csv: must have rows of numbers, got none");
  CHECK(problem_of("t_s,x_mm\n" + rows(20) + "20.5,abc\n" + rows(64))
            .find("r.csv: line 22: column 2 must have a number, or nothing where a sample is missing, got "
                  "\"abc\"") == 0);
  CHECK(problem_of("t_s,x_mm\n" + rows(20) + ",1\n" + rows(64)).find("r.csv: line 22: must have a time") ==
        0);
  CHECK(
      problem_of("t_s,x_mm\n" + rows(20) + "19.5,1\n") ==
      "r.csv: line 22: a time must be larger than in the row before, 19.5 s, got 19.5 s; of a clock that is "
      "coarser than the samples give --rate instead");
  CHECK(problem_of("t_s,x_m\n" + rows(64) + "70,-1e13\n") ==
        "r.csv: line 66: a value must be at most 1e+12 m either way, got -1e+13");
  CHECK(problem_of("t_ms,x_m\n" + rows(64) + "1e19,1\n").find("line 66: a time must be at most") !=
        std::string::npos);
  // Equal once they are seconds.
  CHECK(problem_of("t_ms,x_mm\n" + rows(64) + "63.50000000000001,1\n63.500000000000014,1\n")
            .find("line 67: a time must be larger") != std::string::npos);
  CHECK(problem_of("t_s,x_mm\n" + rows(20) + "20.5,1,2\n" + rows(64))
            .find("line 22: must have 2 cells, got 3") != std::string::npos);
  CHECK(problem_of("t_s,x_mm\n" + rows(63)) == "r.csv: must have at least 64 samples, got 63");
  std::string many = "t_s,x_mm\n" + rows(20);
  for (int i = 0; i < 14; ++i) many += "x,1\n";
  CHECK(problem_of(many + rows(64)).find("and 4 more lines that are not valid") != std::string::npos);
  CHECK(problem_of("TDSm.....").find("is a TDMS file, which is not read") != std::string::npos);
  CHECK(problem_of(std::string("1,2\n\0", 5)) == "r.csv: must be text, got bytes that are none");
}
