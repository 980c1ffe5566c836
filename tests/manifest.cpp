#include "application/reproduction/manifest.hpp"

#include <doctest/doctest.h>

#include <string>
#include <utility>

using namespace impact_damper;

namespace {

// "1a2b3c4d" and then the digit `last` up to the end.
std::string sum(char last) { return "1a2b3c4d" + std::string(56, last); }

CitedFigure figure_of(std::string number, char exact, char cem) {
  CitedFigure figure;
  figure.number = std::move(number);
  figure.tables = {{"exact", {"a.dat", sum(exact)}}, {"cem", {"b.dat", sum(cem)}}};
  figure.script = {"a.gp", std::string(64, 'f')};
  return figure;
}

}  // namespace

TEST_CASE("a stamp is read as it stands on a picture, or as somebody types it") {
  for (const std::string text :
       {"1a2b3c4d · 0.1.0", "1A2B3C4D · 0.1.0", "  1a2b3c4d  0.1.0 ", "1a2b3c4d·0.1.0", "1a2B3c4D ·0.1.0"}) {
    CAPTURE(text);
    const auto stamp = parse_stamp(text);
    REQUIRE(stamp);
    CHECK(stamp->digits == "1a2b3c4d");
    CHECK(stamp->version == "0.1.0");
  }
  for (const std::string text : {"1a2b3c4d", " 1A2B3C4D ", "1a2b3c4d ·", "1a2b3c4d · "}) {
    CAPTURE(text);
    const auto stamp = parse_stamp(text);
    REQUIRE(stamp);
    CHECK(stamp->digits == "1a2b3c4d");
    CHECK_FALSE(stamp->version);
  }
  CHECK(parse_stamp(sum('0'))->digits == sum('0'));
}

TEST_CASE("what is no stamp is none") {
  for (const std::string& text : {std::string(), std::string("figure 8"), std::string("1a2b3c4"),
                                  std::string("1a2b3c4g"), std::string("1a2b3c4d-0.1.0"),
                                  std::string("1a2b3c4d · · 0.1.0"), std::string("1a2b3c4d · 0.1.0 beta"),
                                  std::string("1a2b3c4d \xc2"), std::string("1a2b3c4d\n"), sum('0') + '0'}) {
    CAPTURE(text);
    CHECK_FALSE(parse_stamp(text));
  }
}

TEST_CASE("a stamp finds every table that begins with it, and the script of a drawing only") {
  Manifest manifest;
  manifest.figures = {figure_of("1", '0', '1'), figure_of("2", '2', '3'), figure_of("A", '4', '5')};
  manifest.figures[2].tables.clear();
  const auto all = find_stamped(manifest, "1a2b3c4d");
  REQUIRE(all.size() == 4);
  CHECK(all[0].figure == &manifest.figures[0]);
  CHECK(all[0].table == &manifest.figures[0].tables[0]);
  CHECK(all[3].table == &manifest.figures[1].tables[1]);

  const auto one = find_stamped(manifest, "1a2b3c4d3");
  REQUIRE(one.size() == 1);
  CHECK(one[0].table->engine == "cem");

  const auto drawing = find_stamped(manifest, "ffffffff");
  REQUIRE(drawing.size() == 1);
  CHECK(drawing[0].figure == &manifest.figures[2]);
  CHECK_FALSE(drawing[0].table);

  CHECK(find_stamped(manifest, "00000000").empty());
}
