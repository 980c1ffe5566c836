// The catalogue, and the tables made from runs whose answer is known beforehand.
#include "application/reproduction/series.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "application/sweeps/plan.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "rejection.hpp"

using namespace impact_damper;

namespace {

namespace fs = std::filesystem;
constexpr double pi = std::numbers::pi;

// A decay that loses the fraction 2 pi zeta per cycle without any impact: A = 6 exp(-zeta t).
Run exponential_decay(double zeta, int half_cycles) {
  Run run;
  run.scene.damping_ratio = zeta;
  run.half_cycles = HalfCycles{};
  for (int i = 0; i < half_cycles; ++i) {
    run.half_cycles->peak_time.push_back(i * pi);
    run.half_cycles->zero_crossing.push_back((i + 0.5) * pi);
    run.half_cycles->amplitude.push_back(6 * std::exp(-zeta * i * pi));
    run.half_cycles->impacts.push_back(1);
  }
  return run;
}

// x = A sin(t) from 0 to 4 pi, sampled finely, with y a triangle between the walls: an impact at every half
// pi.
Run triangle_motion() {
  Run run = exponential_decay(0.01, 5);
  run.half_cycles->zero_crossing = {0, pi, 2 * pi, 3 * pi, 4 * pi};
  run.history = History{};
  for (int i = 0; i <= 400; ++i) {
    const double t = 2 * pi * i / 400;
    const double part = std::fmod(t / (pi / 2) + 0.5, 2.0);
    run.history->time.push_back(t);
    run.history->x.push_back(std::sin(t));
    run.history->v.push_back(std::cos(t));
    run.history->dampers[0].y.push_back(part < 1 ? part : 2 - part);
    run.history->dampers[0].w.push_back(0);
  }
  run.impacts = Impacts{};
  for (int i = 0; i < 4; ++i) {
    run.impacts->time.push_back((i + 0.5) * pi / 2);
    run.impacts->wall.push_back(i % 2 == 0 ? Wall::right : Wall::left);
    run.impacts->relative_velocity.push_back(i % 2 == 0 ? 1 : -1);
    run.impacts->phase_deg.push_back(45 + 90.0 * (i % 2));
    run.impacts->amplitude.push_back(1);
    run.impacts->displacement.push_back(std::sin(run.impacts->time.back()));
  }
  run.contacts = Contacts{{1.0}, {2.0}, {Wall::right}};
  return run;
}

const TableBlock& block(const Table& table, const std::string& name) {
  const auto found = std::ranges::find(table.blocks, name, &TableBlock::name);
  REQUIRE(found != table.blocks.end());
  return *found;
}

bool has_block(const Table& table, const std::string& name) {
  return std::ranges::count(table.blocks, name, &TableBlock::name) > 0;
}

// With a curve of each scene.
Figure figure_of(const std::string& number, TableKind table, const std::vector<std::string>& scenes) {
  Figure figure{.number = number, .title = "t", .table = table, .script = "fig" + number + ".gp"};
  for (const std::string& scene : scenes) figure.curves.push_back({.scene = scene});
  return figure;
}
// Of responses.
Figure response_figure(const std::string& number, TableKind table,
                       const std::vector<std::string>& responses) {
  Figure figure = figure_of(number, table, {});
  figure.responses = responses;
  return figure;
}
Figure loss_figure(LossOrdinate ordinate) {
  Figure figure = figure_of("8", TableKind::loss_factor, {"decay"});
  figure.ordinate = ordinate;
  return figure;
}
// Of one run, whose scene has the name of the figure's curve.
Table table_of(const Figure& figure, const Run& run) {
  const std::string& name = figure.curves[0].scene;
  return figure_table(figure, {{name, {name + ".json", run}}});
}

std::string rejection(const Figure& figure, const FigureRuns& runs) {
  return rejection_of<InputError>([&] { figure_table(figure, runs); });
}
std::string catalogue_rejection(const std::string& text) {
  return rejection_of<InputError>([&] { parse_catalogue("catalogue.json", text); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

const std::string small_catalogue = R"({"schema": "impact-damper/catalogue/1",
  "scenes": [{"scene": "a", "record": ["half_cycles"]}],
  "figures": [{"figure": "8", "title": "t", "table": "loss_factor", "ordinate": "eta", "down_to": 0.1,
               "curves": [{"scene": "a", "half_cycles": 12}], "script": "fig08.gp"}]})";

const fs::path source = IMPACT_DAMPER_SOURCE;

}  // namespace

TEST_CASE("the project's catalogue has Figures 1 to 15, A to J, from eight distinct scenes") {
  const Catalogue catalogue = read_catalogue(source / "figures/catalogue.json");
  REQUIRE(catalogue.figures.size() == 25);
  for (int n = 1; n <= 15; ++n) CHECK(find_figure(catalogue, std::to_string(n)) != nullptr);
  for (const char* letter : {"A", "B", "C", "D", "E", "F", "G", "H", "I", "J"})
    CHECK(find_figure(catalogue, letter) != nullptr);
  for (const Figure& figure : catalogue.figures) CHECK(fs::exists(source / "figures" / figure.script));

  // Those that measures compare with.
  const Engine near_contact = Cem{.locate = true, .large_step = 0.02};
  REQUIRE(catalogue.runs.size() == 35);
  for (const CatalogueRun& run : catalogue.runs)
    CHECK(run.scene ==
          (run.name.starts_with("dampers-") ? run.name : run.name.substr(0, run.name.find('.'))));
  CHECK(find_run(catalogue.runs, "nu2-e06.restitution")->engine == Engine(Restitution{}));
  CHECK(find_run(catalogue.runs, "nu2-e06.restitution")->set.empty());
  CHECK(find_run(catalogue.runs, "nu2-e06.soft")->set.at("wall_stiffness") == 1e3);
  CHECK_FALSE(find_run(catalogue.runs, "nu2-e06.soft")->engine);
  CHECK(find_run(catalogue.runs, "nu2-e06.later")->set.at("x0") == 10);
  CHECK(find_run(catalogue.runs, "nu2-e06.cem")->engine == near_contact);
  CHECK(std::get<Cem>(*find_run(catalogue.runs, "nu2-e06.cem-stuck-04")->engine).stuck_speed == 0.4);
  CHECK(find_run(catalogue.runs, "nu2-e06.cem")->set.at("until_amplitude") == 0.075);
  CHECK(find_run(catalogue.runs, "nu2-e06") == nullptr);

  REQUIRE(catalogue.scenes.size() == 8);
  std::set<std::string> distinct;
  for (const CatalogueScene& scene : catalogue.scenes)
    distinct.insert(scene_text(read_scene(source / "data/scenes" / (scene.name + ".json"))));
  CHECK(distinct.size() == 8);
}

TEST_CASE("a figure's files are named after its script") {
  for (const auto& [script, stem] :
       {std::pair{"fig08.gp", "fig08"}, {"loss.2.gp", "loss.2"}, {"decay", "decay"}}) {
    Figure figure;
    figure.script = script;
    CHECK(file_stem(figure) == stem);
  }
}

TEST_CASE("a catalogue that does not hold together is rejected at the place that is wrong") {
  CHECK(catalogue_rejection(small_catalogue) == not_rejected);
  const auto rejected = [](const std::string& from, const std::string& to, const std::string& at) {
    const std::string message = catalogue_rejection(replaced(small_catalogue, from, to));
    CAPTURE(message);
    CHECK(contains(message, at));
  };
  rejected("catalogue/1", "catalogue/2", "/schema");
  rejected(R"([{"scene": "a", "half)", R"([{"scene": "b", "half)", "/figures/0/curves");
  rejected(R"(["half_cycles"])", R"(["impacts"])", "/figures/0/curves");
  rejected(R"(["half_cycles"])", R"(["half_cycles", "history"])", "/scenes/0/history_below");
  rejected(R"(["half_cycles"])", R"(["half_cycle"])", "/scenes/0/record");
  rejected("12}", "13}", "/figures/0/curves/0/half_cycles");
  rejected("12}", "20}", "/figures/0/curves/0/half_cycles");
  rejected(R"("eta")", R"("theta")", "/figures/0/ordinate");
  rejected(R"("down_to": 0.1)", R"("down_to": -1)", "/figures/0/down_to");
  rejected(R"("down_to": 0.1,)", R"("down_to": 0.1, "varied": "mass_ratio",)", "/figures/0/varied");
  rejected(R"("title")", R"("titel")", "titel");
  const auto with_runs = [&](const std::string& runs, const std::string& at) {
    rejected(R"("figures")", R"("runs": [)" + runs + R"(], "figures")", at);
  };
  const std::string run =
      R"({"name": "a.r", "scene": "a", "engine": {"name": "restitution"}, "record": ["half_cycles"]})";
  with_runs(run, not_rejected);
  with_runs(run + ", " + run, "/runs/1/name");
  with_runs(replaced(run, R"("a")", R"("b")"), not_rejected);
  with_runs(R"({"name": "b.r", "scene": "b", "record": ["half_cycles"]})", "/runs/0/scene");
  with_runs(replaced(run, "restitution", "rigid"), "/runs/0/engine/name");
  rejected(R"("fig08.gp"})",
           R"("fig08.gp"}, {"figure": "9", "title": "t", "table": "drawing", "script": "fig08.plt"})",
           "/figures/1/script");
}

TEST_CASE("a viscous decay has the loss factor 2 zeta, and no loss is left for the impacts") {
  const double zeta = 0.004;
  const FigureRuns runs{{"decay", {"decay.json", exponential_decay(zeta, 40)}}};
  // The parabola's own bias, (89/30) (zeta pi)^2 relative (loss_factor.hpp), and ten times rounding.
  const double bias = 89.0 / 30 * zeta * pi * zeta * pi;
  const Table total = figure_table(loss_figure(LossOrdinate::eta), runs);
  const TableBlock& curve = block(total, "curve-1");
  REQUIRE(curve.columns[0].values.size() == 30);
  for (std::size_t i = 0; i < 30; ++i) {
    const double exact_amplitude = 6 * std::exp(-zeta * static_cast<double>(i + 5) * pi);
    CHECK(curve.columns[0].values[i] == doctest::Approx(exact_amplitude).epsilon(2 * bias));
    CHECK(curve.columns[1].values[i] == doctest::Approx(2 * zeta).epsilon(1.1 * bias));
  }
  const Table impacts_only = figure_table(loss_figure(LossOrdinate::specific_secondary), runs);
  for (const double value : block(impacts_only, "curve-1").columns[1].values)
    CHECK(std::abs(value) <= 2 * zeta / 0.02 * 1.1 * bias);
  CHECK_FALSE(has_block(total, "one-impact-1"));  // the closed forms are for zeta = 0
}

TEST_CASE("the closed forms in the tables meet their own landmarks") {
  Run run = exponential_decay(1e-3, 40);
  run.scene.damping_ratio = 0;
  const Table table = table_of(loss_figure(LossOrdinate::specific), run);
  const std::vector<double>& loss = block(table, "one-impact-1").columns[1].values;
  // A point each hundredth miss its maximum by less than a thousandth.
  CHECK(*std::ranges::max_element(loss) == doctest::Approx(16 / pi).epsilon(1e-3));  // (4/pi)(1+e)/(1-e)
  const TableBlock& bounced = block(table, "bounce-down-1");
  CHECK(bounced.columns[0].values.front() == bounce_down_end(0.6));
  CHECK(bounced.columns[0].values.back() == 6);
}

TEST_CASE("the spread is half way between the least and the greatest ordinate of its range") {
  Run run = exponential_decay(1e-3, 400);
  run.scene.damping_ratio = 0;
  Figure figure = loss_figure(LossOrdinate::amplitude_times);
  figure.range = {2, 4};
  const Table table = table_of(figure, run);
  // A eta / nu = A 2e-3 / 0.02, a straight line through the origin: the points next to 2 and 4 decide.
  const TableBlock& spread = block(table, "spread");
  CHECK(spread.columns[1].values[0] == doctest::Approx(0.2).epsilon(2e-3));
  CHECK(spread.columns[2].values[0] == doctest::Approx(0.4).epsilon(2e-3));
  CHECK(spread.columns[3].values[0] == doctest::Approx(0.3).epsilon(2e-3));
  CHECK(spread.columns[3].heading == "0.3 ± 33 %");
}

TEST_CASE("the spread leaves out each curve's first point, which the release enters") {
  // A A' is constant but for a release that stands out: with it the greatest ordinate would be larger.
  Run run = exponential_decay(1e-3, 400);
  run.scene.damping_ratio = 0;
  for (std::size_t i = 0; i < 400; ++i) run.half_cycles->amplitude[i] = 6 - 0.01 * double(i);
  run.half_cycles->amplitude[0] = 6.2;
  Figure figure = loss_figure(LossOrdinate::amplitude_times);
  figure.range = {2.5, 7};
  const Table table = table_of(figure, run);
  const TableBlock& spread = block(table, "spread");
  CHECK(spread.columns[1].values[0] == doctest::Approx(2 * 0.01 / pi / 0.02));
  CHECK(spread.columns[2].values[0] == doctest::Approx(2 * 0.01 / pi / 0.02));
  CHECK(block(table, "curve-1").columns[1].values[0] > 1.1 * spread.columns[2].values[0]);
}

TEST_CASE("a second panel holds the same amplitudes with its own ordinate") {
  Run run = exponential_decay(4e-3, 60);
  run.scene.damper().mass_ratio = 0.25;
  Figure figure = loss_figure(LossOrdinate::amplitude_times);
  CHECK_FALSE(has_block(table_of(figure, run), "second-1"));
  figure.second_ordinate = LossOrdinate::carried;
  const Table table = table_of(figure, run);
  const TableBlock &first = block(table, "curve-1"), &second = block(table, "second-1");
  CHECK(second.columns[0].values == first.columns[0].values);
  for (std::size_t i = 0; i < second.columns[0].values.size(); ++i) {
    // 2 zeta - 2 zeta / 1.25 is left over, a fifth of 2 zeta.
    const double a = second.columns[0].values[i];
    CHECK(second.columns[1].values[i] - first.columns[1].values[i] == doctest::Approx(a * 0.2 * 8e-3 / 0.25));
  }
}

TEST_CASE("points that average no peak before impact failure stand apart") {
  Run run = exponential_decay(1e-3, 60);
  run.scene.damping_ratio = 0;
  for (std::size_t i = 40; i < 60; ++i) run.half_cycles->impacts[i] = 0;
  const Table table = table_of(loss_figure(LossOrdinate::eta), run);
  // Peaks 5 to 54 have a point; those from 45 on average only peaks from 40 on.
  CHECK(block(table, "curve-1").columns[0].values.size() == 40);
  CHECK(block(table, "failed-1").columns[0].values.size() == 10);
}

TEST_CASE("a run that lacks what a figure draws is rejected with the figure's and the file's name") {
  const auto expect = [](const Figure& figure, const Run& run, const std::string& why) {
    const std::string name = figure.curves[0].scene;
    const std::string message = rejection(figure, {{name, {"runs/" + name + ".json", run}}});
    CAPTURE(message);
    CHECK(message.starts_with("figure " + figure.number + ": runs/" + name + ".json: "));
    CHECK(contains(message, why));
  };
  Figure loss = loss_figure(LossOrdinate::eta);
  Run run = exponential_decay(0.01, 11);
  expect(loss, run, "11 half cycles, the averaging needs at least 12");
  run = exponential_decay(0.01, 40);
  loss.down_to = 0.5;
  expect(loss, run, "must reach an amplitude of 0.5");
  run.half_cycles->amplitude[20] = std::numeric_limits<double>::quiet_NaN();
  expect(loss, run, "not finite");
  run.half_cycles.reset();
  expect(loss, run, "holds no half_cycles");

  Figure motion = figure_of("4", TableKind::motion, {"triangle"});
  motion.window = 0.001;
  expect(motion, triangle_motion(), "no half cycle has an amplitude below 0.001");
  motion.window = 5.9;  // undercut in the second half cycle, which ends at pi
  run = triangle_motion();
  std::ranges::for_each(run.history->time, [](double& t) { t += 50; });
  expect(motion, run, "has no window beginning at");
  motion.window = 7;
  run = triangle_motion();
  run.history->dampers[0].y[30] = std::numeric_limits<double>::infinity();
  expect(motion, run, "must be finite");
  run = triangle_motion();
  run.impacts.reset();
  expect(motion, run, "holds no impacts");
  run.history.reset();
  expect(motion, run, "holds no history");
}

TEST_CASE("curves of one figure must differ in what it varies and in nothing else") {
  Figure figure = loss_figure(LossOrdinate::eta);
  figure.curves = {{"one", {}}, {"two", {}}};
  figure.varied = Varied::mass_ratio;
  FigureRuns runs{{"one", {"one.json", exponential_decay(0.01, 40)}},
                  {"two", {"two.json", exponential_decay(0.01, 40)}}};
  runs["two"].run.scene.damper().mass_ratio = 0.04;
  const Table table = figure_table(figure, runs);
  CHECK(block(table, "curve-1").columns[1].heading == "ν = 2 %");
  CHECK(block(table, "curve-2").columns[1].heading == "ν = 4 %");
  CHECK(table.header[1] == "Parameters: e = 0.6, ζ = 1 %");
  runs["two"].run.scene.damper().restitution = 0.5;
  CHECK(contains(rejection(figure, runs), "same restitution"));
  runs["two"].run.scene.damper().restitution = 0.6;
  runs["two"].run.scene.damper().wall_stiffness = 5e3;
  CHECK(contains(rejection(figure, runs), "same wall_stiffness"));
  runs["two"].run.engine = Restitution{};
  CHECK(contains(rejection(figure, runs), "another engine"));
  runs["one"].run.engine = Restitution{};  // rigid walls: their stiffness changes nothing
  CHECK_NOTHROW(figure_table(figure, runs));
}

TEST_CASE("a table's text heads its blocks as gnuplot finds them, and interrupts lines at gaps") {
  const Table table{.header = {"title"},
                    .blocks = {{.name = "curve-1",
                                .columns = {{"a", "first", {1, 2}}, {"b c", "second", {0.1, 0.25}}},
                                .gaps = {1}}}};
  CHECK(to_text(table) ==
        "# title\n\n\n# curve-1\n# column 1: first\n# column 2: second\n\"a\" \"b c\"\n1 0.1\n\n2 0.25\n");
  CHECK_THROWS_AS(check({.blocks = {{.name = "empty"}}}), std::domain_error);
  CHECK_THROWS_AS(check({.blocks = {{.name = "uneven", .columns = {{"a", "", {1}}, {"b", "", {}}}}}}),
                  std::domain_error);
}

TEST_CASE("a table as CSV has a row for each x of each curve, and empty cells for what there is not") {
  const Table table{
      .header = {"title"},
      .blocks = {{.name = "curve-1",
                  .columns = {{"a", "", {1, 2}}, {"b, \"c\"", "", {0.1, 0.25}}, {"d", "", {3, 1e-9}}},
                  .gaps = {1}},
                 {.name = "band",
                  .columns = {{"a", "", {1}},
                              {"least", "", {5}, Ordinate::low},
                              {"16 releases", "", {7}, Ordinate::high}}},
                 {.name = "spread",
                  .columns = {{"a", "", {1}},
                              {"least", "", {5}, Ordinate::low},
                              {"most", "", {7}, Ordinate::high},
                              {"middle", "", {6}}}}}};
  CHECK(to_csv(table) ==
        "block,curve,x,y,low,high\n"
        "curve-1,\"b, \"\"c\"\"\",1,0.1,,\n"
        "curve-1,\"b, \"\"c\"\"\",,,,\n"
        "curve-1,\"b, \"\"c\"\"\",2,0.25,,\n"
        "curve-1,d,1,3,,\n"
        "curve-1,d,,,,\n"
        "curve-1,d,2,1e-09,,\n"
        "band,16 releases,1,,5,7\n"
        "spread,middle,1,6,5,7\n");
  CHECK_THROWS_AS(to_csv({.blocks = {{.name = "empty"}}}), std::domain_error);
}

// What follows holds every column of every table against numbers worked out on paper: mutation/outputs.py
// sees to it that none is forgotten.

// A straight envelope, A = 6 - 0.05 i at t = i pi. A parabola meets it exactly, so that eta = (0.1 / pi) / A.
Run linear_decay(int half_cycles, int with_impacts) {
  Run run = exponential_decay(0, half_cycles);
  for (std::size_t i = 0; i < run.half_cycles->amplitude.size(); ++i) {
    run.half_cycles->amplitude[i] = 6 - 0.05 * double(i);
    run.half_cycles->impacts[i] = int(i) < with_impacts;
  }
  return run;
}

double ordinate_of(LossOrdinate which, const Scene& scene, double amplitude, double eta) {
  const double nu = scene.damper().mass_ratio, left = (eta - 2 * scene.damping_ratio) / nu;
  const std::map<LossOrdinate, double> all{
      {LossOrdinate::eta, eta},
      {LossOrdinate::specific, eta / nu},
      {LossOrdinate::specific_secondary, left},
      {LossOrdinate::amplitude_times, amplitude * left},
      {LossOrdinate::by_restitution, amplitude * left / (1 - scene.damper().restitution)},
      {LossOrdinate::carried, amplitude * (eta - 2 * scene.damping_ratio / (1 + nu)) / nu}};
  return all.at(which);
}

const std::vector<double>& column(const TableBlock& block, std::size_t number) {
  REQUIRE(number <= block.columns.size());
  REQUIRE(!block.columns[number - 1].values.empty());
  return block.columns[number - 1].values;
}

TEST_CASE(
    "the curves of a straight envelope are its own, in each ordinate, before and after impact failure") {
  Run run = linear_decay(120, 100);
  run.scene.damping_ratio = 0.001;
  run.scene.damper().restitution = 0.25;
  run.scene.damper().mass_ratio = 0.05;
  for (const LossOrdinate which : all_of<LossOrdinate>) {
    CAPTURE(name_of(which));
    Figure figure = loss_figure(which);
    figure.range = {1.97, 4.03};  // amplitudes from 2 to 4
    const Table table = table_of(figure, run);
    const auto expected = [&](double amplitude) {
      return ordinate_of(which, run.scene, amplitude, 0.1 / pi / amplitude);
    };
    // A point averages the five peaks on either side: the first is that of peak 5, the last that of 114, and
    // from 105 on they average no peak with impacts.
    int peak = 5;
    for (const char* name : {"curve-1", "failed-1"}) {
      const TableBlock& points = block(table, name);
      for (std::size_t i = 0; i < column(points, 1).size(); ++i, ++peak) {
        const double amplitude = 6 - 0.05 * peak;
        CHECK(column(points, 1)[i] == doctest::Approx(amplitude).epsilon(1e-12));
        CHECK(column(points, 2)[i] == doctest::Approx(expected(amplitude)).epsilon(1e-10));
      }
      CHECK(peak == (name[0] == 'c' ? 105 : 115));
    }
    const TableBlock& spread = block(table, "spread");
    const double least = std::min(expected(2), expected(4)), most = std::max(expected(2), expected(4));
    CHECK(column(spread, 1) == figure.range);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(column(spread, 2)[i] == doctest::Approx(least).epsilon(1e-10));
      CHECK(column(spread, 3)[i] == doctest::Approx(most).epsilon(1e-10));
      CHECK(column(spread, 4)[i] == doctest::Approx((least + most) / 2).epsilon(1e-10));
    }
  }
}

// With e -> 0 the closed forms are explicit: the bounce-down ends as it begins.
constexpr double nearly_plastic = 1e-6, b = (1 - nearly_plastic) / (1 + nearly_plastic);

// One impact per half cycle at amplitude A: absolute speed V of the secondary mass.
double single_speed(double amplitude) {
  const double c = pi * pi + 4 * b * b;
  return (pi + std::sqrt(std::max(0.0, pi * pi - c * (1 - 4 * amplitude * amplitude)))) / c;
}
const double fold = b / std::sqrt(pi * pi + 4 * b * b);
// Where A cos(theta) = 2 / (pi^2 - 4), and pi V = 1 + 2 A cos(theta), A sin(theta) = b V.
const double equally_spaced_until = std::hypot(2 / (pi * pi - 4), b*(1 + 4 / (pi * pi - 4)) / pi);
// When a mass released at x = 0 by a wall of speed A meets the other wall: A (t - sin t) = 1.
double flight_time(double amplitude) {
  double low = 0, high = pi;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (amplitude * (middle - std::sin(middle)) < 1 ? low : high) = middle;
  }
  return low;
}

TEST_CASE("the closed forms in the tables of the loss factor are those for a nearly plastic impact") {
  Run run = linear_decay(40, 40);
  run.scene.damper().restitution = nearly_plastic;
  for (const LossOrdinate which : all_of<LossOrdinate>) {
    CAPTURE(name_of(which));
    const Table table = table_of(loss_figure(which), run);
    const auto check = [&](const char* name, double from, double to, double (*specific_loss)(double)) {
      CAPTURE(name);
      const TableBlock& form = block(table, name);
      const std::vector<double>&amplitude = column(form, 1), &loss = column(form, 2);
      const double factor = amplitude[2] / amplitude[1];
      CHECK(factor > 1.001);
      CHECK(std::min(amplitude[0] / from, factor) / std::max(1.0, from / amplitude[0]) ==
            doctest::Approx(1).epsilon(0.011));
      CHECK(amplitude.back() == doctest::Approx(to).epsilon(1e-10));
      for (std::size_t i = 0; i < amplitude.size(); ++i) {
        if (i > 0) CHECK(amplitude[i] / amplitude[i - 1] == doctest::Approx(factor).epsilon(1e-9));
        const double eta = run.scene.damper().mass_ratio * specific_loss(amplitude[i]);
        CHECK(loss[i] == doctest::Approx(ordinate_of(which, run.scene, amplitude[i], eta)).epsilon(1e-4));
      }
    };
    check("one-impact-1", fold, equally_spaced_until, [](double amplitude) {
      const double speed = single_speed(amplitude);
      return 4 * b * speed * speed / (pi * amplitude * amplitude);
    });
    // All of the relative energy is lost.
    check("bounce-down-1", 1 / pi, 6, [](double amplitude) {
      const double w = amplitude * (1 - std::cos(flight_time(amplitude)));
      return w * w / (pi * amplitude * amplitude);
    });
  }
}

// Half cycles of length 1 after row 0, with two impacts each in rows 1 to 14 and one in rows 15 to 29; one of
// them recorded, at 30 degrees and one more in each row; the mass sticks in rows 2, 3 and 5, in row 3 until a
// little past its end.
Run made_by_hand() {
  Run run;
  run.scene.damper().wall_stiffness = 1e12;  // a contact is over in no time, so these last
  run.scene.damper().restitution = nearly_plastic;
  run.half_cycles.emplace(), run.impacts.emplace();
  for (int i = 0; i < 30; ++i) {
    run.half_cycles->zero_crossing.push_back(i);
    run.half_cycles->peak_time.push_back(i - 0.5);
    run.half_cycles->amplitude.push_back(6 - 0.1 * i);
    run.half_cycles->impacts.push_back(i < 15 ? 2 : 1);
    run.impacts->time.push_back(i - 1 + (30 + i) / 180.0);
    run.impacts->wall.push_back(Wall::left);
    run.impacts->relative_velocity.push_back(-1);
    run.impacts->phase_deg.push_back(i == 0 ? std::nullopt : std::optional(30.0 + i));
    run.impacts->amplitude.push_back(6 - 0.1 * i);
  }
  run.contacts = Contacts{{1.5, 2.75, 4.25}, {1.75, 3.125, 4.5}, {Wall::left, Wall::right, Wall::left}};
  return run;
}

using Columns = std::vector<std::vector<double>>;

// The block has these columns first, to 1e-9.
void same(const TableBlock& block, const Columns& expected) {
  for (std::size_t c = 0; c < expected.size(); ++c) {
    const std::vector<double>& found = column(block, c + 1);
    REQUIRE(found.size() == expected[c].size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      INFO(block.name, ", column ", c + 1, ", row ", i);
      CHECK(found[i] == doctest::Approx(expected[c][i]).epsilon(1e-9));
    }
  }
}

TEST_CASE("the table of phases is what it is for impacts made by hand and a nearly plastic impact") {
  const Run run = made_by_hand();
  Figure figure = figure_of("15", TableKind::phase, {"made"});
  const Table table = table_of(figure, run);

  std::vector<double> amplitude, phase;
  for (int i = 1; i < 30; ++i) {
    amplitude.push_back(6 - 0.1 * i);
    phase.push_back(30 + i);
  }
  same(block(table, "impacts"), {amplitude, phase});
  same(block(table, "stuck"), {{5.8, 5.7, 5.5}, {90, 135, 45}, {135, 180, 90}});
  CHECK(block(table, "stuck").gaps == std::vector<std::size_t>{2});  // row 4, in which it does not stick
  same(block(table, "windows"), {{2, 1}, {5.9, 4.5}, {4.6, 3.1}});

  // Amplitudes are equally spaced; the fold itself may be missing.
  const TableBlock& one = block(table, "one-impact");
  const std::size_t rows = column(one, 1).size(), missing = 121 - rows;
  CHECK(missing <= 1);
  for (std::size_t i = 0; i < rows; ++i) {
    const double a = fold + (equally_spaced_until - fold) * double(i + missing) / 120,
                 speed = single_speed(a);
    CHECK(column(one, 1)[i] == doctest::Approx(a).epsilon(1e-9));
    const double behind_peak = std::atan2(b * speed, (pi * speed - 1) / 2);
    CHECK(column(one, 2)[i] == doctest::Approx(90 + 180 / pi * behind_peak).epsilon(1e-6));
  }
  // At the end of bounce-down itself the mass is hardly pressed and bounces for long; elsewhere it bounces
  // once.
  for (const char* name : {"bounce-1", "accumulation"}) {
    CAPTURE(name);
    const TableBlock& form = block(table, name);
    const std::size_t count = column(form, 1).size(), none = 121 - count;
    CHECK(none <= 1);
    for (std::size_t i = 2; i < count; ++i) {
      const double a = 1 / pi + (6 - 1 / pi) * double(i + none) / 120;
      CHECK(column(form, 1)[i] == doctest::Approx(a).epsilon(1e-3));
      CHECK(column(form, 2)[i] == doctest::Approx(180 / pi * flight_time(a)).epsilon(1e-3));
    }
  }
}

TEST_CASE("the table of a motion has each sample and each impact in its place") {
  Run run = triangle_motion();
  run.contacts = Contacts{{1, 3}, {2, 3.5}, {Wall::right, Wall::left}};
  Figure figure = figure_of("4", TableKind::motion, {"triangle"});
  figure.window = 7;
  const Table table = table_of(figure, run);
  // The impacts, at odd multiples of pi/4, are samples, too, but for rounding.
  const TableBlock& motion = block(table, "motion");
  std::size_t samples = 0;
  for (std::size_t i = 0; i < column(motion, 1).size(); ++i) {
    const double t = column(motion, 1)[i], part = std::fmod(t / (pi / 2) + 0.5, 2.0);
    if (std::abs(t - 2 * pi * double(samples) / 400) < 1e-12) ++samples;
    const double x = std::sin(t), y = part < 1 ? part : 2 - part;
    CHECK(column(motion, 5)[i] == doctest::Approx(y).epsilon(1e-9).scale(1));
    CHECK(column(motion, 2)[i] == x);
    CHECK(column(motion, 3)[i] == x + 1);
    CHECK(column(motion, 4)[i] == x + column(motion, 5)[i]);
  }
  CHECK(samples == 401);
  CHECK(std::ranges::is_sorted(column(motion, 1)));
  // The wall stands where the impact was, not between two samples of where it was.
  for (std::size_t i = 0; i < column(block(table, "impacts"), 1).size(); ++i) {
    const auto vertex = std::ranges::find(column(motion, 1), column(block(table, "impacts"), 1)[i]);
    REQUIRE(vertex != column(motion, 1).end());
    const auto row = static_cast<std::size_t>(vertex - column(motion, 1).begin());
    CHECK(column(motion, 5)[row] == column(block(table, "impacts"), 2)[i]);
    CHECK(column(block(table, "impacts"), 3)[i] == std::sin(*vertex) + column(block(table, "impacts"), 2)[i]);
  }
  const double root = std::sqrt(0.5);
  same(block(table, "impacts"),
       {{pi / 4, 3 * pi / 4, 5 * pi / 4, 7 * pi / 4}, {1, 0, 1, 0}, {root + 1, root, 1 - root, -root}});
  same(block(table, "stuck"), {{1, 3}, {2, 3.5}, {1, 0}});
}

TEST_CASE("the table of a decay has its peaks and their times") {
  Figure figure = figure_of("7", TableKind::decay, {"decay"});
  const Table table = table_of(figure, linear_decay(50, 50));
  for (int i = 0; i < 50; ++i) {
    CHECK(column(block(table, "curve-1"), 1)[std::size_t(i)] == doctest::Approx(i * pi));
    CHECK(column(block(table, "curve-1"), 2)[std::size_t(i)] == doctest::Approx(6 - 0.05 * i));
  }
}

TEST_CASE("the law of a decay has each curve's slope, and the line their mean") {
  Figure figure = figure_of("7", TableKind::decay, {"light", "heavy"});
  figure.down_to = 2.02;
  figure.varied = Varied::mass_ratio;
  // A = 6 - 0.05 i at t = i pi: the slope is the same from any peak to any other. The heavy mass begins
  // later.
  Run light = linear_decay(100, 100), heavy = light;
  light.scene.damper().mass_ratio = 0.01;
  heavy.scene.damper().mass_ratio = 0.04;
  for (double& time : heavy.half_cycles->peak_time) time += 2;
  // Its last peaks, below 2.02, are off the line and must not count.
  for (std::size_t i = 81; i < 100; ++i) heavy.half_cycles->amplitude[i] /= 2;
  const FigureRuns runs{{"light", {"light.json", light}}, {"heavy", {"heavy.json", heavy}}};
  const Table table = figure_table(figure, runs);
  const double slope = 0.05 / pi, least = slope / 0.04, most = slope / 0.01;
  same(block(table, "law"), {{0.01, 0.04}, {most, least}});
  const double mean = (least + most) / 2, begin = 0.04 * 2 / 2;
  same(block(table, "line"), {{begin, begin + 6 / mean}, {6, 0}});
  CHECK(block(table, "line").columns[1].heading == "dA/dt = −0.99 ν");
  figure.down_to = 6;  // the first peak: there is no chord
  CHECK_FALSE(has_block(figure_table(figure, runs), "law"));
  figure.down_to.reset();
  CHECK_FALSE(has_block(figure_table(figure, runs), "line"));
}

TEST_CASE(
    "an ensemble's band is the least and the greatest of its members' curves at amplitudes equally spaced") {
  const Run run = simulate({.x0 = 3, .until_amplitude = 2}, Exact{}, {});
  Figure figure = loss_figure(LossOrdinate::amplitude_times);
  std::vector<Table> members;
  FigureRun decay{"decay.json", run};
  for (const Scene& scene : ensemble_of(run.scene, {.members = 4})) {
    const Run member = simulate(scene, Exact{}, {});
    members.push_back(table_of(figure, member));
    if (members.size() > 1) decay.others.push_back(member);
  }
  CHECK(members_shown(figure, "decay") == 0);
  figure.curves[0].ensemble = 5;
  CHECK(members_shown(figure, "decay") == 5);
  CHECK(members_shown(figure, "another") == 0);
  CHECK_THROWS_WITH_AS(figure_table(figure, {{"decay", decay}}),
                       "figure 8: decay.json: has 4 of the 5 members of its ensemble", InputError);
  figure.curves[0].ensemble = 4;
  const Table table = figure_table(figure, {{"decay", decay}});
  const TableBlock& band = block(table, "band-1");
  const double from = std::ranges::min(column(block(table, "curve-1"), 1));
  double last_step = 0;
  for (std::size_t i = 0; i < column(band, 1).size(); ++i) {
    const double amplitude = column(band, 1)[i], step = 240 * std::log(amplitude / from) / std::log(3 / from);
    CHECK(step == doctest::Approx(i == 0 ? std::round(step) : last_step + 1));
    last_step = step;
    double least = 1e9, most = 0;
    for (const Table& member : members) {
      const std::vector<double>&a = column(block(member, "curve-1"), 1),
            &y = column(block(member, "curve-1"), 2);
      std::size_t k = 1;
      while (k + 1 < a.size() && a[k] >= amplitude) ++k;
      const double value = y[k - 1] + (y[k] - y[k - 1]) * (amplitude - a[k - 1]) / (a[k] - a[k - 1]);
      least = std::min(least, value);
      most = std::max(most, value);
    }
    CHECK(column(band, 2)[i] == doctest::Approx(least).epsilon(1e-9));
    CHECK(column(band, 3)[i] == doctest::Approx(most).epsilon(1e-9));
  }
  CHECK(column(band, 1).size() > 100);
}

namespace {

SteadyState steady_of(std::optional<std::int64_t> period, double amplitude) {
  SteadyState state;
  state.period = period;
  state.means = SteadyMeans{.amplitude = amplitude};
  return state;
}
SteadyState ended_state() {
  SteadyState state;
  state.stop_reason = StopReason::impact_budget;
  return state;
}

const Scene driven{.damping_ratio = 0.1, .force_amplitude = 0.006, .dampers = {{.mass_ratio = 0.02}}};

void check_block(const Table& table, const std::string& name, const Columns& wanted,
                 const std::vector<std::size_t>& gaps = {}) {
  INFO(name);
  const TableBlock& its = block(table, name);
  REQUIRE(its.columns.size() == wanted.size());
  for (std::size_t c = 0; c < wanted.size(); ++c) CHECK(its.columns[c].values == wanted[c]);
  CHECK(its.gaps == gaps);
}

SweepResponse sweep_of(const Scene& scene, const Axis& axis, const std::vector<Sweep>& sweeps) {
  return {scene, Exact{}, {}, axis, sweeps};
}

OrbitPoint point_at(double value, double amplitude, bool stable, ImpactCounts impacts = {1, 1}) {
  OrbitPoint point;
  point.value = value;
  point.amplitude = amplitude;
  point.stable = stable;
  point.impacts = impacts;
  return point;
}

}  // namespace

TEST_CASE("a table of responses has the sweeps' motions, the branches' pieces and the linear oscillators") {
  const Axis axis{&Scene::force_frequency, 0.5, 1, 2};
  const SweepResponse sweep =
      sweep_of(driven, axis,
               {{{}, {steady_of(1, 0.3), steady_of({}, 0.4)}, {steady_of({}, 0.5), steady_of(2, 0.6)}},
                {{}, {ended_state(), steady_of(1, 0.7)}, {steady_of(1, 0.8), ended_state()}},
                {{}, {steady_of({}, 0.9), ended_state()}, {ended_state(), steady_of({}, 0.95)}}});
  OrbitsResponse orbits;
  orbits.scene = driven;
  orbits.range = {Parameter::force_frequency, 0.5, 1};
  orbits.branches.resize(2);
  orbits.branches[0].points = {point_at(0.5, 0.1, true), point_at(0.6, 0.2, true),
                               point_at(0.6001, 0.2001, true),  // too close to be seen
                               point_at(0.7, 0.25, true), point_at(0.65, 0.3, false)};
  orbits.branches[1].points = {point_at(0.8, 0.01, false, {0, 0}), point_at(0.9, 0.4, true)};
  SweepResponse other = sweep;
  other.scene.force_amplitude = 0.004;
  other.sweeps.resize(1);

  Figure figure = response_figure("C", TableKind::response, {"a", "b", "c"});
  const Table table = figure_table(
      figure, {}, {{"a", {"a.json", sweep}}, {"b", {"b.json", orbits}}, {"c", {"c.json", other}}});
  CHECK(table.header[1] == "Parameters: ν = 2 %, e = 0.6, ζ = 10 %");
  check_block(table, "panel-1", {{0.3}, {0.3}});
  check_block(table, "panel-2", {{0.2}, {0.2}});
  check_block(table, "rising-1", {{0.5, 1}, {0.3, 0.7}});
  check_block(table, "rising-open-1", {{1, 0.5}, {0.4, 0.9}});
  check_block(table, "falling-1", {{1, 0.5}, {0.6, 0.8}});
  check_block(table, "falling-open-1", {{0.5, 1}, {0.5, 0.95}});
  check_block(table, "stable-1", {{0.5, 0.6, 0.7, 0.9}, {0.1, 0.2, 0.25, 0.4}}, {3});
  check_block(table, "unstable-1", {{0.7, 0.65}, {0.25, 0.3}});
  check_block(table, "rising-2", {{0.5}, {0.3}});
  CHECK(!has_block(table, "stable-2"));
  for (const auto& [name, mass] : {std::pair{"empty-1", 1.0}, {"locked-1", 1.02}}) {
    const TableBlock& its = block(table, name);
    const std::vector<double>& frequency = its.columns[0].values;
    REQUIRE(frequency == std::vector<double>{0.5, 0.625, 0.75, 0.875, 1});
    for (std::size_t i = 0; i < frequency.size(); ++i) {
      const std::complex<double> h(1 - mass * frequency[i] * frequency[i], 0.2 * frequency[i]);
      CHECK(its.columns[1].values[i] == doctest::Approx(0.006 / std::abs(h)).epsilon(1e-13));
    }
  }
  // Orbits of a force that no sweep is of, and a response of another damper.
  figure.responses = {"b"};
  CHECK_THROWS_AS(figure_table(figure, {}, {{"b", {"b.json", orbits}}}), InputError);
  other.scene.damper().restitution = 0.7;
  figure.responses = {"a", "c"};
  CHECK_THROWS_WITH_AS(figure_table(figure, {}, {{"a", {"a.json", sweep}}, {"c", {"c.json", other}}}),
                       doctest::Contains("c.json: must have the same restitution"), InputError);
  other.scene = sweep.scene;
  other.scene.damper().wall_stiffness = 5e3;
  CHECK_THROWS_WITH_AS(figure_table(figure, {}, {{"a", {"a.json", sweep}}, {"c", {"c.json", other}}}),
                       doctest::Contains("c.json: must have the same wall_stiffness"), InputError);
}

TEST_CASE("at resonance without damping a linear oscillator's curve is interrupted") {
  Scene scene = driven;
  scene.damping_ratio = 0;
  const SweepResponse sweep = sweep_of(scene, {&Scene::force_frequency, 0.5, 1.5, 3},
                                       {{{}, {steady_of(1, 1), steady_of(1, 1), steady_of(1, 1)}, {}}});
  Figure figure = response_figure("C", TableKind::response, {"a"});
  const Table table = figure_table(figure, {}, {{"a", {"a.json", sweep}}});
  const TableBlock& its = block(table, "empty-1");
  CHECK(its.columns[0].values == std::vector<double>{0.5, 0.625, 0.75, 0.875, 1.125, 1.25, 1.375, 1.5});
  CHECK(its.gaps == std::vector<std::size_t>{4});
}

TEST_CASE(
    "the table of the largest responses has the largest of sweeps along the same forces, and the decay's "
    "prediction") {
  const Axis axis{&Scene::force_amplitude, 0.002, 0.004, 2},
      further{&Scene::force_amplitude, 0.006, 0.008, 2};
  const auto sweep = [&](const Axis& along, double up1, double up2, double down1, double down2) {
    return sweep_of(  // zeta = 0, as the decay's
        {.force_amplitude = 0.001}, along,
        {{{}, {steady_of(1, up1), steady_of({}, up2)}, {steady_of(1, down1), steady_of(1, down2)}}});
  };
  SweepResponse ended = sweep(further, 5, 6, 7, 8);
  ended.sweeps[0].up[1] = ended_state();
  Figure figure = response_figure("D", TableKind::largest_response, {"a", "b", "c"});
  figure.curves = {{.scene = "decay", .ensemble = 2}};
  // Straight envelopes: eta follows from the slope, A eta = -2 A'.
  FigureRun decay{"decay.json", exponential_decay(0.01, 60)};
  decay.run.scene.damping_ratio = 0;
  decay.others.push_back(exponential_decay(0.012, 60));
  // From two starts, each of which has a largest.
  SweepResponse a = sweep(axis, 1, 2, 3, 4), other = sweep(axis, 2, 1, 2, 5);
  a.sweeps.push_back(sweep(axis, 7, 6, 9, 1).sweeps[0]);
  other.sweeps.push_back(sweep(axis, 1, 8, 1, 2).sweeps[0]);
  const Table table = figure_table(
      figure, {{"decay", decay}}, {{"a", {"a.json", a}}, {"b", {"b.json", other}}, {"c", {"c.json", ended}}});
  const double nu = decay.run.scene.damper().mass_ratio, f1 = 0.002 / nu, f2 = 0.004 / nu, f3 = 0.006 / nu,
               f4 = 0.008 / nu;
  check_block(table, "rising", {{f1, f2, f1, f2, f3}, {2, 2, 7, 8, 5}});
  check_block(table, "falling", {{f1, f2, f1, f2, f3, f4}, {3, 5, 9, 2, 7, 8}});
  // The loss factor of an exponential decay is 2 zeta, so the force falls with the amplitude: the largest is
  // the first.
  const TableBlock& prediction = block(table, "prediction");
  REQUIRE(prediction.columns[0].values.size() > 10);
  for (std::size_t i = 0; i < prediction.columns[0].values.size(); ++i) {
    const double amplitude = prediction.columns[1].values[i];
    CHECK(prediction.columns[0].values[i] ==
          doctest::Approx(std::sqrt(1 + nu) * amplitude * 0.02 / nu).epsilon(5e-3));
  }
  const TableBlock& band = block(table, "band");
  const std::vector<double>&force = band.columns[0].values, &at = band.columns[1].values;
  REQUIRE(force.size() % 2 == 0);
  for (std::size_t i = 0; i < force.size() / 2; ++i) {
    CHECK(at[i] == at[at.size() - 1 - i]);
    CHECK(force[i] == doctest::Approx(std::sqrt(1 + nu) * at[i] * 0.02 / nu).epsilon(5e-3));
    CHECK(force[force.size() - 1 - i] ==
          doctest::Approx(std::sqrt(1 + nu) * at[i] * 0.024 / nu).epsilon(5e-3));
  }
  const TableBlock& beyond = block(table, "beyond");
  CHECK(beyond.columns[1].values == std::vector<double>{prediction.columns[1].values[0]});
  CHECK(beyond.columns[0].values == std::vector<double>{prediction.columns[0].values[0]});
}

TEST_CASE("beyond the largest force of a decay the prediction is a curve of its own") {
  // In each half cycle it loses d(A), the most at A = 3: A eta = 2 d / pi.
  const auto lost = [](double amplitude) {
    return 0.01 + 0.01 * std::exp(-(amplitude - 3) * (amplitude - 3) / 4);
  };
  FigureRun decay{"decay.json", exponential_decay(0, 0)};
  double amplitude = 5;
  for (int i = 0; amplitude > 0.5; ++i, amplitude -= lost(amplitude)) {
    decay.run.half_cycles->peak_time.push_back(i * pi);
    decay.run.half_cycles->zero_crossing.push_back((i + 0.5) * pi);
    decay.run.half_cycles->amplitude.push_back(amplitude);
    decay.run.half_cycles->impacts.push_back(1);
  }
  const SweepResponse sweep =
      sweep_of({.force_amplitude = 0.001}, {&Scene::force_amplitude, 0.002, 0.004, 2},
               {{{}, {steady_of(1, 1), steady_of(1, 2)}, {steady_of(1, 1), steady_of(1, 2)}}});
  Figure figure = response_figure("D", TableKind::largest_response, {"a"});
  figure.curves = {{.scene = "decay"}};
  const Table table = figure_table(figure, {{"decay", decay}}, {{"a", {"a.json", sweep}}});
  CHECK_FALSE(has_block(table, "band"));
  const double nu = decay.run.scene.damper().mass_ratio;
  for (const auto& [name, most, least] : {std::tuple{"beyond", 4.9, 3.0}, {"prediction", 3.0, 0.6}}) {
    const TableBlock& its = block(table, name);
    const std::vector<double>&force = its.columns[0].values, &at = its.columns[1].values;
    CHECK(at.front() == doctest::Approx(most).epsilon(0.02));
    CHECK(at.back() == doctest::Approx(least).epsilon(0.03));
    CHECK(std::ranges::is_sorted(at, std::greater{}));
    for (std::size_t i = 0; i < at.size(); ++i)
      CHECK(force[i] == doctest::Approx(std::sqrt(1 + nu) * 2 * lost(at[i]) / pi / nu).epsilon(2e-3));
  }
}

TEST_CASE("the table of a map has each point under the motion that it ends in") {
  BasinResponse map;
  map.scene = driven;
  map.scene.damper().mass_ratio = 0.5;
  map.first = {&Scene::force_frequency, 0.5, 1.5, 3};
  map.second = {&Scene::force_amplitude, 0.5, 2.5, 5};
  map.basin.attractors = {{false, 1, {1, 1}, true, 2},  {false, 1, {1, 1}, false, 1},
                          {false, 1, {2, 2}, true, 1},  {false, 1, {3, 3}, false, 1},
                          {false, 1, {1, 2}, false, 1}, {true, 1, {0, 0}, true, 1},
                          {false, 2, {1, 1}, false, 1}};
  map.basin.attractor = {0, 1, 2, 3, 4, 5, 6, undecided, 0, 1, 2, undecided, 5, 3, 0};
  Figure figure = response_figure("E", TableKind::response_map, {"a"});
  const Table table = figure_table(figure, {}, {{"a", {"a.json", map}}});
  check_block(table, "cell", {{0.5}, {1}});
  check_block(table, "one-symmetric", {{0.5, 1.5, 1.5}, {1, 3, 5}});
  check_block(table, "one-asymmetric", {{1, 0.5}, {1, 4}});
  check_block(table, "each-2", {{1.5, 1}, {1, 4}});
  check_block(table, "each-3", {{0.5, 1}, {2, 5}});
  check_block(table, "other", {{1, 0.5}, {2, 3}});
  check_block(table, "idle", {{1.5, 0.5}, {2, 5}});
  check_block(table, "irregular", {{1, 1.5}, {3, 4}});
  // Another kind of response cannot be drawn so.
  CHECK_THROWS_WITH_AS(figure_table(figure, {}, {{"a", {"a.json", SweepResponse{driven}}}}),
                       doctest::Contains("a.json: must be a basin, got sweep"), InputError);
}

TEST_CASE("the table of design charts has the mean of the releases, down to where one of them has none") {
  SweepTable sweep{"charts.csv",
                   parse_plan("charts.json", R"({"schema": "impact-damper/plan/1",
      "scene": {"until_amplitude": 0.1}, "grid": [{"number": "restitution", "values": [0.1, 0.6]},
      {"number": "mass_ratio", "values": [0.02, 0.1]}], "samples": {"count": 2, "numbers": [{"number": "x0",
      "half_width": 0.1}]}, "quantities": ["loss_factor_at=0.2", "loss_factor_at=1", "loss_factor_at=6",
      "loss_factor_at=9"]})"),
                   {}};
  // Of run, restitution, mass ratio, x0, the loss factors, end and problem, only these are read.
  const auto add = [&](const std::vector<std::string>& losses) {
    std::vector<std::string> row{"", "", "", ""};
    row.insert(row.end(), losses.begin(), losses.end());
    row.insert(row.end(), {"done", ""});
    sweep.rows.push_back(row);
  };
  add({"0.5", "0.25", "0.125", ""});
  add({"0.25", "0.75", "0.625", ""});
  add({"", "1", "2", "4"});
  add({"7", "3", "4", "8"});
  add({"1", "1", "1", ""});  // missing above, as the release of the other is
  add({"1", "3", "5", "7"});
  add({"9", "", "1", "1"});
  add({"9", "9", "2", "3"});
  Figure figure = figure_of("H", TableKind::design_charts, {});
  figure.plan = "charts.json";
  const Table table = figure_table(figure, {}, {}, {{"charts.json", sweep}});
  check_block(table, "panel-1", {{0.1}, {0.1}});
  check_block(table, "panel-2", {{0.6}, {0.6}});
  check_block(table, "curve-1-1",
              {{6, 1, 0.2}, {0.375, 0.5, 0.375}, {0.125, 0.25, 0.25}, {0.625, 0.75, 0.5}});
  check_block(table, "curve-1-2", {{9, 6, 1}, {6, 3, 2}, {4, 2, 1}, {8, 4, 3}});
  check_block(table, "curve-2-1", {{6, 1, 0.2}, {3, 2, 1}, {1, 1, 1}, {5, 3, 1}});
  check_block(table, "curve-2-2", {{9, 6}, {2, 1.5}, {1, 1}, {3, 2}});
  // The fold for e = 0.1, b = 9/11; that for 0.6 is below all amplitudes. The other limit as in theory.hpp.
  const auto check_limit = [&](const std::string& name, double amplitude, double accuracy, double e) {
    INFO(name);
    const TableBlock& its = block(table, name);
    CHECK(std::abs(its.columns[0].values.at(0) - amplitude) < accuracy);
    CHECK(its.columns[1].values == std::vector{e});
  };
  check_limit("failure-1", 1 / std::sqrt(pi * pi * 121 / 81 + 4), 1e-15, 0.1);
  CHECK_FALSE(has_block(table, "failure-2"));
  check_limit("bounce-down-2", 5.23, 0.005, 0.6);
  check_block(table, "reading", {{1}, {2}, {0.6}, {0.02}});
  CHECK(contains(to_text(table), "# Parameters: ζ = 0; mean of 2 releases\n"));
  sweep.plan.grid[0].variable.name = "x0";
  CHECK_THROWS_WITH_AS(figure_table(figure, {}, {}, {{"charts.json", sweep}}),
                       doctest::Contains("figure H: charts.csv: must be dimensionless"), InputError);
}

TEST_CASE("several dampers are drawn by their mass, beside the sum of what each does alone") {
  // eta down to 5 / sqrt(10), where the seventh of twelve bins begins, and twice as much below. 0.02 of two
  // releases and 0.06 of a third: the mean of the times is that of 0.18/7. Alone 0.01 with nu = 0.02.
  const double kink = 5 / std::sqrt(10), wide = std::pow(10, 0.25);
  const auto decay = [&](double eta, const std::vector<SceneDamper>& dampers) {
    Run run = exponential_decay(0, 800);
    const int above = static_cast<int>(std::ceil(std::log(6 / kink) / (eta * pi / 2)));
    for (int i = 0; i < 800; ++i)
      run.half_cycles->amplitude[std::size_t(i)] =
          kink * std::exp(-eta * (i - above) * (i < above ? 1 : 2) * pi / 2);
    run.engine = Restitution{};
    run.scene.damping_ratio = 0;
    run.scene.dampers = dampers;
    return run;
  };
  const std::vector<SceneDamper> dampers{{.mass_ratio = 0.01, .clearance = wide},
                                         {.mass_ratio = 0.03, .clearance = 1}};
  Run alone = decay(0.01, {{.mass_ratio = 0.02}});
  alone.scene.until_amplitude = 0.02;
  FigureRuns runs{{"set", {"set.json", decay(0.02, dampers), {decay(0.06, dampers), decay(0.02, dampers)}}},
                  {"one", {"one.json", alone, {alone}}}};
  Figure figure = figure_of("F", TableKind::damper_sets, {""});
  figure.range = {0.5, 5};
  figure.curves[0].run = "set";
  figure.curves[0].alone = "one";
  const Table table = figure_table(figure, runs);
  REQUIRE(table.blocks.size() == 3);
  const TableBlock &set = block(table, "set-1"), &sum = block(table, "sum-1"),
                   &list = block(table, "dampers-1");
  REQUIRE(set.columns.size() == 4);
  REQUIRE(set.columns[0].values.size() == 12);
  REQUIRE(sum.columns[0].values.size() == 12);
  for (std::size_t i = 0; i < 12; ++i) {
    const double amplitude = 5 * std::pow(10, -(double(i) + 0.5) / 12), more = i < 6 ? 1 : 2;
    CHECK(set.columns[0].values[i] == doctest::Approx(amplitude));
    CHECK(set.columns[1].values[i] == doctest::Approx(more * 3 / (2 / 0.02 + 1 / 0.06) / 0.04));
    CHECK(set.columns[2].values[i] == doctest::Approx(more * 0.5));
    CHECK(set.columns[3].values[i] == doctest::Approx(more * 1.5));
    CHECK(sum.columns[0].values[i] == doctest::Approx(amplitude));
    // The wide one is below its kink from the fourth bin on. Next to the kinks the steps of what is known of
    // one alone do not end where the bins do.
    const bool at_kink = i == 2 || i == 3 || i == 5 || i == 6;
    CHECK(sum.columns[1].values[i] == doctest::Approx(i < 3   ? 0.5
                                                      : i < 6 ? 0.625
                                                              : 1)
                                          .epsilon(at_kink ? 0.15 : 1e-9));
  }
  CHECK(list.columns[0].values == std::vector<double>{wide, 1});
  CHECK(list.columns[1].values[0] == doctest::Approx(0.25));
  CHECK(list.columns[1].values[1] == doctest::Approx(0.75));
  CHECK(set.columns[1].heading == "2 dampers");

  const auto rejected = [&](auto change, const std::string& why) {
    FigureRuns changed = runs;
    change(changed);
    CHECK(contains(rejection(figure, changed), why));
  };
  rejected([](FigureRuns& all) { all["set"].run.scene.dampers = {{}}; },
           "set.json: must be of a scene with a list");
  rejected([&](FigureRuns& all) { all["one"].run.scene.dampers = dampers; },
           "one.json: must be of a single damper");
  rejected([](FigureRuns& all) { all["one"].run.scene.until_amplitude.reset(); },
           "one.json: must stop at an amplitude");
  rejected([](FigureRuns& all) { all["one"].run.scene.damper().restitution = 0.5; },
           "one.json: must have the restitution");
  rejected([](FigureRuns& all) { all["set"].run.half_cycles.reset(); }, "set.json: holds no half_cycles");
}

TEST_CASE("friction, weight and drag are drawn in a panel each, beside none, with the amplitudes that lock") {
  // A = 6 exp(-eta t / 2), with one component or none.
  const auto decay = [](double eta, double phi, double gamma, double d) {
    Run run = exponential_decay(eta / 2, 400);
    run.engine = Restitution{};
    run.scene.dampers = {{.mass_ratio = 0.21, .friction = phi, .drag = d}};
    run.scene.damping_ratio = 0;
    run.scene.weight = gamma;
    return run;
  };
  FigureRuns runs{{"none", {"none.json", decay(0.02, 0, 0, 0), {decay(0.06, 0, 0, 0)}}},
                  {"held", {"held.json", decay(0.03, 0.8, 0, 0)}},
                  {"little", {"little.json", decay(0.03, 0.1, 0, 0)}},
                  {"heavy", {"heavy.json", decay(0.04, 0, 2, 0)}},
                  {"wet", {"wet.json", decay(0.05, 0, 0, 0.3)}},
                  {"hertz", {"hertz.json", decay(0.06, 0, 0, 0)}},
                  {"lined", {"lined.json", decay(0.07, 0, 0, 0)}}};
  runs["held"].run.scene.damper().static_friction = 1.5;
  runs["hertz"].run.scene.damper().wall = {.law = WallForm::power, .exponent = 1.5};
  runs["lined"].run.scene.damper().wall = {.law = WallForm::table, .pairs = {{0, 0}, {0.1, 5}}};
  Figure figure = figure_of("I", TableKind::components, {"", "", "", "", "", "", ""});
  figure.range = {0.5, 5};
  const char* const names[] = {"none", "little", "held", "heavy", "wet", "hertz", "lined"};
  for (std::size_t i = 0; i < 7; ++i) figure.curves[i].run = names[i];
  const Table table = figure_table(figure, runs);
  REQUIRE(table.blocks.size() == 12);
  const auto check_curve = [&](const std::string& name, double eta, const std::string& legend) {
    CAPTURE(name);
    const TableBlock& curve = block(table, name);
    REQUIRE(curve.columns[0].values.size() == 12);
    CHECK(curve.columns[1].heading == legend);
    for (std::size_t i = 0; i < 12; ++i) {
      const double amplitude = 5 * std::pow(10, -(double(i) + 0.5) / 12);
      CHECK(curve.columns[0].values[i] == doctest::Approx(amplitude));
      CHECK(curve.columns[1].values[i] == doctest::Approx(amplitude * eta / 0.21));
    }
  };
  check_curve("curve-1-1", 0.03, "φ = 0");  // by the mean of the times
  check_curve("curve-1-2", 0.03, "φ = 0.1");
  check_curve("curve-1-3", 0.03, "φ = 0.8");
  check_curve("curve-2-1", 0.03, "γ = 0");
  check_curve("curve-2-2", 0.04, "γ = 2");
  check_curve("curve-3-1", 0.03, "d = 0");
  check_curve("curve-3-2", 0.05, "d = 0.3");
  check_curve("curve-4-1", 0.03, "rigid");
  check_curve("curve-4-2", 0.06, "p = 1.5");
  check_curve("curve-4-3", 0.07, "table");
  const TableBlock& none = block(table, "curve-1-1");
  for (std::size_t i = 0; i < 12; ++i) {
    CHECK(none.columns[2].values[i] == doctest::Approx(none.columns[0].values[i] * 0.02 / 0.21));
    CHECK(none.columns[3].values[i] == doctest::Approx(none.columns[0].values[i] * 0.06 / 0.21));
  }
  // x'' of all together is A / (1 + nu), to be held by static friction; 0.1 lies below the range.
  CHECK(block(table, "locking-1-3").columns[0].values[0] == doctest::Approx(1.5 * 1.21));
  CHECK(block(table, "locking-2-2").columns[0].values[0] == doctest::Approx(2 * 1.21));

  const auto rejected = [&](auto change, const std::string& why) {
    FigureRuns changed = runs;
    change(changed);
    CHECK(contains(rejection(figure, changed), why));
  };
  rejected([](FigureRuns& all) { all["wet"].run.scene.weight = 1; },
           "wet.json: must have one of friction, weight, drag and a law of the walls");
  rejected([](FigureRuns& all) { all["hertz"].run.scene.weight = 1; },
           "hertz.json: must have one of friction, weight, drag and a law of the walls");
  rejected(
      [](FigureRuns& all) {
        all["none"].run.scene.spring.cubic = 1, all["none"].run.scene.spring.law = SpringForm::cubic;
      },
      "none.json: must have one of friction, weight, drag and a law of the walls");
  rejected([](FigureRuns& all) { all["wet"].run.scene.dampers.push_back({}); },
           "wet.json: must be of a single damper");
  rejected([](FigureRuns& all) { all["heavy"].run.scene.damper().mass_ratio = 0.1; },
           "heavy.json: must have the ratios of none.json");
  rejected([](FigureRuns& all) { all["heavy"].run.scene.damping_ratio = 0.1; },
           "heavy.json: must have the ratios of none.json");
  rejected([](FigureRuns& all) { all["heavy"].run.half_cycles.reset(); }, "heavy.json: holds no half_cycles");
}
