#include "application/report/drawings.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "application/report/quantities.hpp"

using namespace impact_damper;

namespace {

Findings examined(const Scene& scene, std::optional<Scales> scales = {}) {
  EnsembleOptions ensemble;
  ensemble.members = 3;
  return examine({"a test", "", scene, scales, Exact{}}, ensemble, [](const std::string&) {});
}

const TableBlock& block(const std::vector<Drawing>& drawings, std::string_view drawing,
                        std::string_view name) {
  const auto found = std::ranges::find(drawings, drawing, &Drawing::name);
  REQUIRE(found != drawings.end());
  const auto in_it = std::ranges::find(found->table.blocks, name, &TableBlock::name);
  REQUIRE(in_it != found->table.blocks.end());
  return *in_it;
}

std::vector<std::string> names(const std::vector<Drawing>& drawings) {
  std::vector<std::string> all;
  for (const Drawing& each : drawings) all.push_back(each.name);
  return all;
}

}  // namespace

TEST_CASE("the closed form drawn for a damped scene is that for zeta = 0 and 2 zeta on top") {
  const Scene scene{.damping_ratio = 0.004, .until_amplitude = 0.05, .dampers = {{.mass_ratio = 0.03}}};
  const std::vector<Drawing> drawings = drawings_of(examined(scene));
  const TableBlock& form = block(drawings, "loss", "one-impact-1");
  // eta/nu = 4 b V^2 / (pi A^2), V the larger root of (pi^2 + 4 b^2) V^2 - 2 pi V + 1 - 4 A^2 = 0.
  const double b = 0.25, pi = std::numbers::pi, c = pi * pi + 4 * b * b;
  for (std::size_t i = 0; i < form.columns[0].values.size(); ++i) {
    const double a = form.columns[0].values[i];
    const double v = (pi + std::sqrt(pi * pi - c * (1 - 4 * a * a))) / c;
    CHECK(form.columns[1].values[i] ==
          doctest::Approx(0.03 * 4 * b * v * v / (pi * a * a) + 0.008).epsilon(1e-12));
  }
}

TEST_CASE("a scene in units has its scales in every table, a dimensionless one in none") {
  const Scene scene{.until_time = 60};
  for (const Drawing& drawing : drawings_of(examined(scene, Scales{2, 50, 4}))) {
    const TableBlock& scales = drawing.table.blocks.front();
    CHECK(scales.name == "scales");
    CHECK(scales.columns[0].values == std::vector<double>{0.2});
    CHECK(scales.columns[1].values == std::vector<double>{4});
    CHECK(scales.columns[2].values[0] == doctest::Approx(5 / (2 * std::numbers::pi)));
  }
  for (const Drawing& drawing : drawings_of(examined(scene)))
    CHECK(std::ranges::find(drawing.table.blocks, "scales", &TableBlock::name) == drawing.table.blocks.end());
}

TEST_CASE("what would be too much for a picture is thinned, and it is said how much") {
  const Scene scene{.until_time = 9000, .dampers = {{.restitution = 0.95}}};
  const Findings findings = examined(scene);
  REQUIRE(findings.run.impacts->time.size() > 8000);
  const std::vector<Drawing> drawings = drawings_of(findings);
  const auto phase = std::ranges::find(drawings, "phase", &Drawing::name);
  REQUIRE(phase != drawings.end());
  CHECK(phase->every > 1);
  for (const TableBlock& each : phase->table.blocks) {
    CHECK(each.columns[0].values.size() <= 4000);
    CHECK_NOTHROW(check(phase->table));
  }
}

TEST_CASE("what a scene has nothing of is not drawn") {
  const Scene still{.x0 = 0, .until_time = 5};
  CHECK(names(drawings_of(examined(still))) == std::vector<std::string>{"begin"});
  Scene forced = still;
  forced.force_amplitude = 0.1;
  forced.damping_ratio = 0.02;
  forced.until_time = 200;
  CHECK(names(drawings_of(examined(forced))) ==
        std::vector<std::string>{"decay", "response", "phase", "begin", "best", "prediction"});
}

TEST_CASE("each motion of the response is drawn once, the closed forms beside it where they are finite") {
  const Scene forced{.x0 = 0, .force_amplitude = 0.1, .force_frequency = 1.02, .until_time = 200};
  const Findings findings = examined(forced);
  const std::vector<Drawing> drawings = drawings_of(findings);
  const auto response = std::ranges::find(drawings, "response", &Drawing::name);
  REQUIRE(response != drawings.end());
  std::size_t drawn = 0;
  for (const TableBlock& each : response->table.blocks) {
    const bool rises = each.name.starts_with("rising"), falls = each.name.starts_with("falling");
    if (!rises && !falls) continue;
    const bool is_open = each.name.ends_with("-open");
    for (std::size_t i = 0; i < each.columns[0].values.size(); ++i, ++drawn) {
      const auto point =
          std::ranges::find(findings.response.points, each.columns[0].values[i], &ResponsePoint::frequency);
      REQUIRE(point != findings.response.points.end());
      const SteadyState& steady = (rises ? point->rising : point->falling).steady;
      CHECK(each.columns[1].values[i] == steady.means->amplitude);
      CHECK(is_open == !steady.period);
    }
  }
  CHECK(drawn == 2 * findings.response.points.size());
  for (const auto& [name, mass] : {std::pair{"locked", 1.02}, std::pair{"empty", 1.0}}) {
    const TableBlock& form = block(drawings, "response", name);
    REQUIRE(form.columns[0].values.size() > 100);
    for (std::size_t i = 0; i < form.columns[0].values.size(); ++i) {
      const double omega = form.columns[0].values[i];
      CHECK(form.columns[1].values[i] == doctest::Approx(0.1 / std::abs(1 - mass * omega * omega)));
    }
  }
  CHECK(block(drawings, "response", "given").columns[0].values == std::vector<double>{1.02});
}

TEST_CASE("the loss factor is drawn up to impact failure, apart behind it, with the fold") {
  const Scene scene{.until_amplitude = 0.02, .dampers = {{.mass_ratio = 0.04}}};
  const Findings findings = examined(scene);
  const std::vector<Drawing> drawings = drawings_of(findings);
  CHECK(block(drawings, "loss", "curve-1").columns[1].values == findings.loss.eta);
  CHECK(block(drawings, "loss", "failed-1").columns[1].values == findings.loss_after_failure.eta);
  // A = b / sqrt(pi^2 + 4 b^2), b = 1/4.
  CHECK(block(drawings, "loss", "fold").columns[0].values[0] ==
        doctest::Approx(0.25 / std::sqrt(std::numbers::pi * std::numbers::pi + 0.25)));
  const TableBlock& band = block(drawings, "loss", "band-1");
  REQUIRE(band.columns[0].values.size() > 50);
  for (std::size_t i = 0; i < band.columns[0].values.size(); ++i)
    CHECK(band.columns[1].values[i] <= band.columns[2].values[i]);
}

TEST_CASE("from rest the releases differ in the exciting force") {
  const Scene forced{.damping_ratio = 0.05, .x0 = 0, .force_amplitude = 0.1, .until_time = 60};
  const Findings findings = examined(forced);
  CHECK(findings.others[0].scene.force_amplitude != 0.1);
  CHECK(std::ranges::max(findings.spread) > 0);
}

TEST_CASE("numbers are rounded for reading and keep their digits for programs") {
  CHECK(number_html(0.07876543) == R"(<data value="0.07876543">0.0788</data>)");
  CHECK(number_html(-12345.6) == R"(<data value="-12345.6">−12346</data>)");
  CHECK(number_html(1.6e8) == R"(<data value="1.6e+08">1.6×10<sup>8</sup></data>)");
  CHECK(number_html(-2.5e-12) == R"(<data value="-2.5e-12">−2.5×10<sup>−12</sup></data>)");
  CHECK(number_html(999.6) == R"(<data value="999.6">1000</data>)");
  CHECK(number_html(1e100) == R"(<data value="1e+100">1×10<sup>100</sup></data>)");
  CHECK(Quantities(std::nullopt).length(6) == "<data value=\"6\">6</data>\u00a0ε");
  CHECK(Quantities(Scales{2, 50, 4}).length(6) ==
        "<data value=\"24\">24</data>\u00a0mm (<data value=\"6\">6</data>\u00a0ε)");
  CHECK(Quantities(Scales{2, 50, 4}).length(0.01) ==
        "<data value=\"40\">40</data>\u00a0µm (<data value=\"0.01\">0.01</data>\u00a0ε)");
  CHECK(Quantities(Scales{2, 50, 4}).velocity(0.5) ==
        "<data value=\"0.01\">0.01</data>\u00a0m/s (<data value=\"0.5\">0.5</data>\u00a0εΩ)");
  CHECK(Quantities(Scales{2, 50, 4}).force(0.5) ==
        "<data value=\"0.1\">0.1</data>\u00a0N (<data value=\"0.5\">0.5</data>\u00a0Kε)");
  CHECK(Quantities(Scales{2, 50, 4}).duration(0.5) ==
        "<data value=\"100\">100</data>\u00a0ms (<data value=\"0.5\">0.5</data>\u00a0/Ω)");
  CHECK(Quantities(std::nullopt).frequency(0.5) == "<data value=\"0.5\">0.5</data>\u00a0Ω");
  CHECK(without_tags(number_html(0.5) + " m") == "0.5 m");
  CHECK(escaped("<\"a&b\">") == "&lt;&quot;a&amp;b&quot;&gt;");
}
