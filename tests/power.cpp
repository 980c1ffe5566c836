// The recorded table of the claims' discriminating power (paper/power.json): complete, and right where it is
// tried. `impact-damper verify --power` makes all of it, in minutes.
#include "application/reproduction/power.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "rejection.hpp"

using namespace impact_damper;

namespace {

const std::filesystem::path source = SOURCE_FOLDER;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  REQUIRE(stream);
  return {std::istreambuf_iterator<char>(stream), {}};
}

const nlohmann::json& recorded() {
  static const nlohmann::json table = nlohmann::json::parse(text_of(source / "paper/power.json"));
  return table;
}

// Of every scene of the catalogue, with or without a claim on it.
const Power& power() {
  static const Power power = [] {
    PowerInput input;
    const Catalogue catalogue = read_catalogue(source / "figures/catalogue.json");
    input.claims = claims_on_scenes_of(catalogue, read_claims(source / "data/claims.json").claims);
    input.further = catalogue.runs;
    input.asked = catalogue.responses;
    const Record record{.impacts = true, .contacts = true};
    for (const CatalogueScene& scene : catalogue.scenes)
      input.runs[scene.name] =
          simulate(read_scene(source / "data/scenes" / (scene.name + ".json")), Exact{}, record);
    // Those of the fixture. Where no figures were made, as by mutation/mutate.py, they are searched for, in
    // seconds.
    for (const CatalogueResponse& response : catalogue.responses)
      if (const auto file = RUNS_FOLDER "/" + response.name + ".json"; std::filesystem::exists(file))
        input.responses[response.name] = read_response(file);
    input.left_out = recorded()["unsettled"].get<std::vector<std::string>>();
    return Power(std::move(input));
  }();
  return power;
}

// Those that stand before the one that is recorded, and it.
std::vector<double> last_two(const Trials& trials, double value) {
  const auto found = std::ranges::find(trials.all, value, &Trial::value);
  REQUIRE(found != trials.all.end());
  if (found == trials.all.begin()) return {value};
  return {std::prev(found)->value, value};
}

}  // namespace

TEST_CASE("the smallest change is found between the first that turns a verdict and the one tried before it") {
  Trials trials;
  for (int i = 0; i < 100; ++i) trials.all.push_back({i / 100.0, double(i)});
  trials.first = {0, 10, 20, 50, 99};
  for (int smallest = 0; smallest < 100; ++smallest) {
    const auto found = smallest_turn(trials, [&](double value) { return value >= smallest; });
    REQUIRE(found);
    CHECK(found->value == smallest);
    CHECK(found->change == smallest / 100.0);
  }
  CHECK_FALSE(smallest_turn(trials, [](double) { return false; }));
  // Not monotonic: of two intervals that turn it, the first that a trial of the first round lies in.
  const auto twice = [](double value) { return (value >= 12 && value < 14) || value >= 33; };
  CHECK(smallest_turn(trials, twice)->value == 33);
}

TEST_CASE("the recorded table has every number of every scene, of the analysis and of what runs record") {
  const nlohmann::json& rows = recorded()["numbers"];
  CHECK(recorded()["claims"] == claims_on_scenes_of(read_catalogue(source / "figures/catalogue.json"),
                                                    read_claims(source / "data/claims.json").claims)
                                    .size());
  CHECK(recorded()["members"] == EnsembleOptions{}.members);
  CHECK(recorded()["engine"] == "exact");
  const std::vector<PowerNumber>& numbers = power().numbers();
  REQUIRE(rows.size() == numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    INFO("of ", numbers[i].of, ", name ", numbers[i].name);
    CHECK(rows[i]["of"] == numbers[i].of);
    CHECK(rows[i]["name"] == numbers[i].name);
    CHECK(rows[i]["value"] == numbers[i].value);
    CHECK(rows[i].contains("up") == numbers[i].up.has_value());
    CHECK(rows[i].contains("down") == numbers[i].down.has_value());
    if (numbers[i].up) CHECK(rows[i]["up"]["searched_to"] == numbers[i].up->all.back().value);
    if (numbers[i].down) CHECK(rows[i]["down"]["searched_to"] == numbers[i].down->all.back().value);
    CHECK(rows[i]["noticed_by"] == numbers[i].noticed_by);
  }
}

TEST_CASE("a recorded change turns the recorded claims, and the next smaller one turns none") {
  struct Tried {
    const char *of, *name, *way;
  };
  for (const Tried& tried :
       {Tried{"nu4-e06", "mass_ratio", "up"}, Tried{"nu2-e06-zeta08", "damping_ratio", "up"},
        Tried{"nu1-e06", "restitution", "down"}, Tried{"nu2-e04", "x0", "down"},
        Tried{"columns", "impacts.relative_velocity", "up"}}) {
    INFO("of ", tried.of, ", name ", tried.name);
    const auto row = std::ranges::find_if(recorded()["numbers"], [&](const nlohmann::json& each) {
      return each["of"] == tried.of && each["name"] == tried.name;
    });
    const auto number = std::ranges::find_if(power().numbers(), [&](const PowerNumber& each) {
      return each.of == tried.of && each.name == tried.name;
    });
    REQUIRE(row != recorded()["numbers"].end());
    REQUIRE(number != power().numbers().end());
    const nlohmann::json& way = (*row)[tried.way];
    REQUIRE(way.contains("value"));
    const Trials& trials = *(std::string(tried.way) == "up" ? number->up : number->down);
    const std::vector<double> values = last_two(trials, way["value"]);
    CHECK(power().turned(*number, values.back()) == way["claims"].get<std::vector<std::string>>());
    if (values.size() == 2) CHECK(power().turned(*number, values.front()).empty());
  }
}

TEST_CASE("a number that turns no verdict as it is turns none") {
  for (const PowerNumber& number : power().numbers()) {
    INFO("of ", number.of, ", name ", number.name);
    const bool is_quick = number.of != "nu2-e06";  // its steady motions would be searched again, for seconds
    if (number.name == "bins" || (number.name == "mass_ratio" && is_quick))
      CHECK(power().turned(number, number.value).empty());
  }
}

TEST_CASE("a changed scene changes its further runs, each with its own numbers in place of the scene's") {
  const Scene scene{.until_amplitude = 4};
  PowerInput input;
  input.runs["small"] = simulate(scene, Exact{}, Record{});
  input.further = {{"small.later", "small", {{"x0", 7}}, {}, Record{}}};
  input.ensemble.members = 2;
  Claim claim;
  claim.id = "loss";
  claim.measure = {"largest_loss", {"small.later"}, {}};
  Runs runs(std::nullopt, input.ensemble, input.further);
  runs.put("small", input.runs["small"]);
  const double loss = measure(runs, claim.measure).median;
  claim.allowed.printed = {loss, loss};
  input.claims = {claim};
  const Power power(std::move(input));
  const auto turned = [&](std::string_view name, double value) {
    const auto number = std::ranges::find(power.numbers(), name, &PowerNumber::name);
    REQUIRE(number != power.numbers().end());
    return power.turned(*number, value).size();
  };
  CHECK(turned("mass_ratio", 0.02) == 0);
  CHECK(turned("mass_ratio", 0.03) == 1);
  CHECK(turned("x0", 6.5) == 0);
}

// Those of the recorded table, which are the program's as another case says.
TEST_CASE("the tests that the table names exist") {
  const std::string commands = text_of(source / "tests/commands.cmake");
  for (const nlohmann::json& number : recorded()["numbers"]) {
    const std::string name = number["noticed_by"];
    CAPTURE(name);
    if (commands.find("refreshed_test(\"" + name + "\"") != std::string::npos) continue;
    const std::size_t colon = name.find(": ");
    REQUIRE(colon != std::string::npos);
    const std::string cases = text_of(source / "tests" / (name.substr(0, colon) + ".cpp"));
    CHECK(contains(cases, "TEST_CASE(\"" + name.substr(colon + 2) + "\")"));
  }
}
