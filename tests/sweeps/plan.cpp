#include "application/sweeps/plan.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "impact_damper/base/errors.hpp"

using namespace impact_damper;

namespace {

std::string text_of_plan(const std::string& inner) {
  return R"({"schema": "impact-damper/plan/1", "quantities": ["impacts"], )" + inner + "}";
}
const std::string decay = R"("scene": {"until_amplitude": 5}, )";
const std::string mast =
    R"("scene": {"mass": 40, "stiffness": 16000, "secondary_mass": 1.6, "clearance": 10, "initial_displacement": 60, )"
    R"("restitution": 0.6, "until_millimetres": 50}, )";

Plan plan_of(const std::string& inner) { return parse_plan("plan.json", text_of_plan(inner)); }

std::string problem_of(const std::string& inner) {
  try {
    plan_of(inner);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("the last axis of a grid varies fastest, and both ends are exact") {
  const Plan plan =
      plan_of(decay + R"("grid": [{"number": "mass_ratio", "from": 0.01, "to": 0.09, "count": 3},
      {"number": "restitution", "values": [0.4, 0.6]}])");
  REQUIRE(runs_of(plan) == 6);
  const std::vector<std::vector<double>> expected{{0.01, 0.4}, {0.01, 0.6}, {0.05, 0.4},
                                                  {0.05, 0.6}, {0.09, 0.4}, {0.09, 0.6}};
  for (std::int64_t i = 0; i < 6; ++i) {
    const PlannedRun run = run_of(plan, i);
    CHECK(run.values[0] == doctest::Approx(expected[std::size_t(i)][0]).epsilon(1e-15));
    CHECK(run.values[1] == expected[std::size_t(i)][1]);
    CHECK(run.scene.damper().mass_ratio == run.values[0]);
    CHECK(run.scene.damper().restitution == run.values[1]);
  }
  CHECK(run_of(plan, 4).values[0] == 0.09);
  CHECK(header_of(plan) == "run,mass_ratio,restitution,impacts,end,problem");
}

TEST_CASE("a logarithmic axis has equal ratios") {
  const Plan plan = plan_of(
      decay +
      R"("grid": [{"number": "wall_stiffness", "from": 10, "to": 1e5, "count": 5, "scale": "logarithmic"}])");
  for (std::int64_t i = 0; i < 5; ++i)
    CHECK(run_of(plan, i).values[0] == doctest::Approx(std::pow(10, double(i + 1))).epsilon(1e-15));
  CHECK(run_of(plan, 4).values[0] == 1e5);
}

TEST_CASE("every point of the grid is given the same deviations") {
  const Plan plan = plan_of(decay + R"("grid": [{"number": "restitution", "values": [0.4, 0.6]}],
      "samples": {"count": 50, "seed": 3, "numbers": [{"number": "restitution", "half_width": 0.1},
        {"number": "mass_ratio", "standard_deviation": 0.1, "relative": true},
        {"number": "wall_stiffness", "from": 100, "to": 1e6, "scale": "logarithmic"}]})");
  REQUIRE(runs_of(plan) == 100);
  CHECK(header_of(plan) ==
        "run,restitution,restitution_sampled,mass_ratio,wall_stiffness,impacts,end,problem");
  double square = 0, low = 1, high = 0, logarithms = 0;
  for (std::int64_t i = 0; i < 50; ++i) {
    const PlannedRun a = run_of(plan, i), b = run_of(plan, i + 50);
    CHECK(a.values[1] - 0.4 == doctest::Approx(b.values[1] - 0.6).epsilon(1e-12));
    CHECK(a.values[2] == b.values[2]);
    CHECK(a.scene.damper().restitution == a.values[1]);
    low = std::min(low, a.values[1]);
    high = std::max(high, a.values[1]);
    square += std::pow(a.values[2] / 0.02 - 1, 2) / 50;
    logarithms += std::log10(a.values[3]) / 50;
  }
  CHECK((low >= 0.3 && low < 0.33));
  CHECK((high > 0.47 && high <= 0.5));
  CHECK(std::sqrt(square) == doctest::Approx(0.1).epsilon(0.3));  // three standard errors of 50 draws
  CHECK(std::abs(logarithms - 4) < 3 * 4 / std::sqrt(12.0 * 50));
}

TEST_CASE("a Latin hypercube has one run in each of its intervals of each number") {
  const Plan plan = plan_of(decay + R"("samples": {"count": 40, "method": "latin_hypercube", "numbers": [
      {"number": "x0", "from": 2, "to": 6}, {"number": "restitution", "from": 0.2, "to": 0.6}]})");
  std::set<int> x0, restitution;
  bool same_order = true;
  for (std::int64_t i = 0; i < 40; ++i) {
    const PlannedRun run = run_of(plan, i);
    x0.insert(int((run.values[0] - 2) * 10));
    restitution.insert(int((run.values[1] - 0.2) * 100));
    same_order = same_order && int((run.values[0] - 2) * 10) == int((run.values[1] - 0.2) * 100);
  }
  CHECK(x0.size() == 40);
  CHECK(restitution.size() == 40);
  CHECK_FALSE(same_order);
}

TEST_CASE("in units what scales the scene may vary, too") {
  const Plan plan = plan_of(
      mast +
      R"("grid": [{"number": "clearance", "values": [10, 20]}, {"number": "mass", "values": [40, 80]}])");
  const PlannedRun last = run_of(plan, 3);
  CHECK(last.scene.x0 == 3);
  CHECK(last.scene.damper().mass_ratio == 0.02);
  CHECK(last.scales == Scales{80, 16000, 20});
  const auto columns = columns_of(plan);
  CHECK(columns[1].unit == "mm");
  CHECK(columns[2].unit == "kg");
}

TEST_CASE("each of several dampers has numbers of its own that may vary") {
  const Plan plan = plan_of(
      R"("scene": {"until_amplitude": 5, "dampers": [{}, {"mass_ratio": 0.01, "clearance": 3}]},
         "grid": [{"number": "clearance_2", "values": [2, 4]}, {"number": "restitution_1", "values": [0.5]},
                  {"number": "x0", "values": [5, 7]}])");
  CHECK(varied_names(plan) == std::vector<std::string>{"clearance_2", "restitution_1", "x0"});
  Scene scene = plan.scene.scene;
  scene.dampers[1].clearance = 4, scene.dampers[0].restitution = 0.5, scene.x0 = 5;
  CHECK(run_of(plan, 2).scene == scene);
  CHECK(plan_text(parse_plan("plan.json", plan_text(plan))) == plan_text(plan));
  CHECK(problem_of(R"("scene": {"until_amplitude": 5, "dampers": [{}, {}]},
                      "grid": [{"number": "mass_ratio", "values": [0.1]}])")
            .find("did you mean \"mass_ratio_1\"?") != std::string::npos);

  const Plan boxes = plan_of(
      R"("scene": {"mass": 40, "stiffness": 16000, "initial_displacement": 60, "until_millimetres": 50,
                   "dampers": [{"secondary_mass": 1.6, "clearance": 10}, {"secondary_mass": 0.8, "clearance": 20}]},
         "grid": [{"number": "secondary_mass_2", "values": [0.4, 0.8]}, {"number": "clearance_1", "values": [5]}])");
  const PlannedRun run = run_of(boxes, 0);
  CHECK(run.scene.dampers[1].mass_ratio == 0.01);
  CHECK(run.scene.dampers[1].clearance == 4);
  CHECK(run.scales->length == 5);
  CHECK(run.scene.x0 == 12);
}

TEST_CASE("a scene that is not valid has its row, with the reason") {
  const Plan plan = plan_of(
      decay + R"("samples": {"count": 40, "numbers": [{"number": "restitution", "half_width": 1.5}]})");
  int wrong = 0;
  for (std::int64_t i = 0; i < 40; ++i) {
    const double restitution = run_of(plan, i).values[0];
    const std::string row = row_of(plan, i);
    if (restitution >= 0 && restitution <= 1) {
      CHECK(row.ends_with(",done,"));
    } else {
      ++wrong;
      CHECK(row.find(",not_valid,") != std::string::npos);
      CHECK(row.find("restitution: must be ") != std::string::npos);
    }
  }
  CHECK(wrong > 0);
}

TEST_CASE("the parts of a plan are its rows, each once") {
  const Plan plan = plan_of(decay + R"("grid": [{"number": "x0", "from": 1, "to": 2, "count": 10}])");
  for (const std::int64_t parts : {1, 3, 7, 10, 13}) {
    std::int64_t next = 0;
    for (std::int64_t part = 1; part <= parts; ++part) {
      const RowRange range = rows_of_part(plan, part, parts);
      CHECK(range.begin == next);
      CHECK(range.size() <= 10 / parts + 1);
      next = range.end;
    }
    CHECK(next == 10);
  }
}

TEST_CASE("exponents are for at most a hundred dampers") {
  const auto read_with = [](int dampers) {
    std::string list = "{}";
    for (int i = 1; i < dampers; ++i) list += ", {}";
    parse_plan("plan.json", R"({"schema": "impact-damper/plan/1", "quantities": ["lyapunov_exponent"],
      "grid": [{"number": "x0", "values": [1, 2]}], "scene": {"until_amplitude": 5, "force_amplitude": 0.1, "dampers": [)" +
                                list + "]}}");
  };
  read_with(100);
  CHECK_THROWS_WITH_AS(
      read_with(101),
      "plan.json: /quantities: must not be of exponents with more than 100 dampers, as the scene has 101",
      InputError);
}

TEST_CASE("a plan that is written reads back as the same plan") {
  for (
      const std::string& text :
      {decay +
           R"("description": "d", "engine": {"name": "cem"}, "grid": [{"number": "mass_ratio", "from": 0.01, "to": 0.09,
        "count": 3, "scale": "logarithmic"}, {"number": "x0", "values": [1, 2]}])",
       mast +
           R"("engine": {"name": "restitution", "max_impacts": 7}, "samples": {"count": 9, "seed": 4, "method": "latin_hypercube",
        "numbers": [{"number": "clearance", "half_width": 0.1, "relative": true}, {"number": "restitution", "standard_deviation": 0.01},
        {"number": "mass", "from": 1, "to": 2}]}, "frequencies": {"from": 1, "to": 2, "count": 5}, "lyapunov": {"periods": 10},
        "steady": {"max_periods": 77})"}) {
    const std::string once = plan_text(plan_of(text));
    CHECK(plan_text(parse_plan("again", once)) == once);
  }
}

TEST_CASE("what is wrong with a plan is told, all at once") {
  const auto told = [](const std::string& inner, const std::string& part) {
    const std::string problem = problem_of(inner);
    CHECK_MESSAGE(problem.find(part) != std::string::npos, problem);
  };
  const auto only = [](const std::string& inner, const std::string& problem) {
    CHECK(problem_of(inner) == "plan.json: " + problem);
  };
  only(decay + R"("grid": [])",
       "/grid: a number that varies must be given, in grid or in the numbers of samples");
  only(decay + R"("grid": [{"number": "x0", "from": -1, "to": 1, "count": 3, "scale": "logarithmic"}])",
       "/grid/0/from: must be > 0 for a logarithmic scale, got -1");
  only(decay + R"("grid": [{"number": "x0", "values": [1]}, {"number": "x0", "values": [1]}])",
       "/grid: must name each number once, got \"x0\" twice");
  only(mast + R"("samples": {"count": 2, "numbers": [{"number": "damping", "half_width": 1}]})",
       "/samples: \"damping\" has no value in the scene to vary about");
  told(decay + R"("grid": [{"number": "mass_rato", "values": [1]}])", "did you mean \"mass_ratio\"?");
  CHECK(problem_of(decay + R"("grid": [{"number": "restitution", "values": [0.5, 1.5]}])")
            .starts_with("plan.json: /grid/0/values/1: must be "));
  told(decay + R"("grid": [{"number": "x0", "values": [1]}],
     "samples": {"count": 2, "numbers": [{"number": "x0", "from": 1, "to": 2}]})",
       "it may vary about its value there");
  told(R"("scene_file": "x.json", "scene": {"until_time": 1}, "grid": [])", "either it or scene_file");
  const std::string several =
      problem_of(decay + R"("grid": [{"number": "x0", "from": 2, "to": 1, "count": 1}],
     "samples": {"count": 0, "seed": -1, "numbers": [{"number": "w0", "half_width": 0}]}, "frequencies": {"from": 0, "to": 1, "count": 1})");
  for (const char* pointer :
       {"/grid/0/to: ", "/grid/0/count: ", "/samples/count: ", "/samples/seed: ",
        "/samples/numbers/0/half_width: ", "/frequencies/from: ", "/frequencies/count: "})
    CHECK_MESSAGE(several.find(pointer) != std::string::npos, several);
  // Given on the command line, without a file that limits them: before anything is simulated.
  Plan large = plan_of(decay + R"("grid": [{"number": "x0", "values": [1]}])");
  large.grid[0].values.resize(std::size_t(most_listed_values) + 1);
  large.grid.resize(17, large.grid[0]);
  large.quantities.resize(65, large.quantities[0]);
  std::string said;
  for (const Problem& problem : problems_of(large)) said += problem.field + ' ' + problem.message + '\n';
  for (const char* part :
       {"grid must be at most 16 numbers, got 17", "grid must list at most 10000 values of x0, got 10001",
        "quantities must be at most 64, got 65"})
    CHECK_MESSAGE(said.find(part) != std::string::npos, said);
  const std::string worst =
      R"({"schema": "impact-damper/plan/1", "quantities": ["worst_frequency", "steady_amplitude"],
    "scene": {"until_time": 1}, "engine": {"name": "cem"}, "grid": [{"number": "x0", "values": [1]}]})";
  CHECK_THROWS_WITH(
      parse_plan("p", worst),
      "p: /frequencies: missing, the range must be given in which the worst one is looked for\n"
      "p: /engine: must be exact or restitution for quantities of motions under a force, got cem");
}
