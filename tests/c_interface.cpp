// The interface for C against the run file of the same run: every number of it, by its name there.
#include "impact_damper/c_interface.h"

#include <doctest/doctest.h>

#include <bit>
#include <cfenv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace {

const char* const forced = R"({"mass_ratio": 0.05, "restitution": 0.5, "damping_ratio": 0.01, "x0": 3,
                               "force_amplitude": 0.05, "force_frequency": 0.97, "until_time": 60})";

const char* const in_units = R"({"mass": 40, "stiffness": 16000, "secondary_mass": 2, "clearance": 10,
                                 "initial_displacement": 30, "until_seconds": 20})";

// All but the second damper chatter.
const char* const several = R"({"damping_ratio": 0.01, "x0": 3, "force_amplitude": 0.05, "until_time": 60,
                                "dampers": [{"mass_ratio": 0.05, "restitution": 0.5},
                                            {"restitution": 0.9, "clearance": 2.5, "y0": 1, "w0": 0.1},
                                            {"mass_ratio": 0.01, "clearance": 0.2}]})";

// Objects in an array by their numbers, from 1.
nlohmann::ordered_json numbered(nlohmann::ordered_json value) {
  if (value.is_array() && !value.empty() && value[0].is_object()) {
    nlohmann::ordered_json object;
    for (std::size_t i = 0; i < value.size(); ++i) object[std::to_string(i + 1)] = value[i];
    return object;
  }
  if (value.is_object())
    for (auto& each : value) each = numbered(each);
  return value;
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

// How many numbers of `value`, at `name` in a run file, the run has with the same bits; each one must be
// there.
std::size_t same_numbers(const impact_damper_run* run, const std::string& name,
                         const nlohmann::ordered_json& value) {
  std::size_t count = 0;
  if (value.is_object()) {
    for (const auto& item : value.items())
      count += same_numbers(run, name.empty() ? item.key() : name + "/" + item.key(), item.value());
    return count;
  }
  const nlohmann::ordered_json column = value.is_array() ? value : nlohmann::ordered_json::array({value});
  CAPTURE(name);
  std::size_t rows = 0;
  const double* numbers = impact_damper_column(run, name.c_str(), &rows);
  REQUIRE(numbers != nullptr);
  REQUIRE(rows == column.size());
  for (std::size_t i = 0; i < rows; ++i) {
    CAPTURE(i);
    if (column[i].is_null()) {
      CHECK(std::isnan(numbers[i]));
    } else {
      CHECK(bits(numbers[i]) == bits(column[i].get<double>()));
    }
  }
  return rows;
}

// The names of all numbers and columns of a run file; behind that of a number that stands alone a '.'.
std::vector<std::string> names_in(const nlohmann::ordered_json& object, const std::string& above) {
  std::vector<std::string> names;
  for (const auto& item : object.items()) {
    const std::string name = above + item.key();
    if (item.value().is_object()) {
      for (std::string& each : names_in(item.value(), name + "/")) names.push_back(std::move(each));
    } else {
      names.push_back(item.value().is_array() ? name : name + ".");
    }
  }
  return names;
}

std::vector<std::string> names_of(const impact_damper_run* run) {
  std::vector<std::string> names;
  int stands_alone = -1;
  while (const char* name = impact_damper_column_name(run, names.size(), &stands_alone))
    names.push_back(std::string(name) + (stands_alone == 1 ? "." : ""));
  return names;
}

// A run that goes away with its owner.
struct Freed {
  void operator()(impact_damper_run* run) const { impact_damper_free(run); }
};
using Owned = std::unique_ptr<impact_damper_run, Freed>;
Owned run_of(const char* scene, const char* engine = "exact", const impact_damper_window* history = nullptr) {
  impact_damper_run* run = nullptr;
  REQUIRE(impact_damper_simulate(scene, engine, history, &run, nullptr, 0) == IMPACT_DAMPER_DONE);
  return Owned(run);
}
std::string text_of(const impact_damper_run* run) {
  char* const text = impact_damper_run_text(run);
  REQUIRE(text != nullptr);
  const std::string copy = text;
  std::free(text);
  return copy;
}

std::string error_of(const char* scene, const char* engine, const impact_damper_window* history = nullptr,
                     std::size_t size = 500) {
  std::string text(size, '#');
  impact_damper_run* run = nullptr;
  CHECK(impact_damper_simulate(scene, engine, history, &run, text.data(), size) == IMPACT_DAMPER_INVALID);
  CHECK(run == nullptr);
  return text.substr(0, text.find('\0'));
}

}  // namespace

TEST_CASE("a number too small for a double is zero in C as on the command line, one too large is rejected") {
  const Owned tiny = run_of(R"({"x0": 1e-400, "v0": 1, "until_time": 8})"),
              zero = run_of(R"({"x0": 0, "v0": 1, "until_time": 8})");
  std::size_t rows = 0, wanted = 0;
  const double *of_tiny = impact_damper_column(tiny.get(), "impacts/time", &rows),
               *of_zero = impact_damper_column(zero.get(), "impacts/time", &wanted);
  CHECK(wanted > 0);
  CHECK(std::vector(of_tiny, of_tiny + rows) == std::vector(of_zero, of_zero + wanted));
  CHECK(error_of(R"({"x0": 1e400, "until_time": 8})", "exact").starts_with("scene: line 1, column 12: "));
  CHECK(error_of(R"({"x0": 1, "until_time": 8})", R"({"name": "cem", "time_step": 1e-400})") ==
        error_of(R"({"x0": 1, "until_time": 8})", R"({"name": "cem", "time_step": 0.0})"));
}

TEST_CASE("C is told the averaged loss factor and where bounce-down ended") {
  const Owned decay = run_of(R"({"mass_ratio": 0.1, "restitution": 0.4, "x0": 6, "until_amplitude": 0.5})");
  const Run wanted =
      simulate({.x0 = 6, .until_amplitude = 0.5, .dampers = {{.mass_ratio = 0.1, .restitution = 0.4}}},
               Exact{}, {.contacts = true});
  const LossFactor loss = averaged_loss_factor(*wanted.half_cycles);
  std::vector<double> amplitude(wanted.half_cycles->amplitude.size()), time = amplitude, eta = amplitude;
  const std::size_t rows = impact_damper_loss_factor(decay.get(), amplitude.data(), time.data(), eta.data());
  REQUIRE(rows > 10);
  for (std::vector<double>* column : {&amplitude, &time, &eta}) column->resize(rows);
  CHECK(amplitude == loss.amplitude);
  CHECK(time == loss.time);
  CHECK(eta == loss.eta);
  std::size_t rows_of_it = 0;
  CHECK(impact_damper_bounce_down_end(decay.get()) == end_of_bounce_down(wanted).value().amplitude);

  // What is not recorded is not there.
  impact_damper_run* run = nullptr;
  REQUIRE(impact_damper_simulate_recording(R"({"x0": 6, "until_time": 30})", "exact", IMPACT_DAMPER_IMPACTS,
                                           nullptr, &run, nullptr, 0) == IMPACT_DAMPER_DONE);
  CHECK(impact_damper_column(run, "impacts/time", &rows_of_it) != nullptr);
  CHECK(impact_damper_column(run, "contacts/begin", &rows_of_it) == nullptr);
  CHECK(impact_damper_column(run, "energy/residual", &rows_of_it) == nullptr);
  CHECK(std::isnan(impact_damper_bounce_down_end(run)));
  impact_damper_free(run);

  const Owned low = run_of(R"({"x0": 0.1, "until_time": 8})"), list = run_of(R"({"dampers": [
      {"mass_ratio": 0.1, "restitution": 0.4}, {"clearance": 2}], "x0": 6, "until_amplitude": 0.5})");
  CHECK(impact_damper_loss_factor(low.get(), amplitude.data(), time.data(), eta.data()) == 0);
  CHECK(std::isnan(impact_damper_bounce_down_end(low.get())));
  CHECK(std::isnan(impact_damper_bounce_down_end(list.get())));
}

TEST_CASE("every number of a run file is a column for C, with the same bits") {
  const impact_damper_window window = {0, 50, 101};
  const auto check = [&](const char* scene, const char* name, const Engine& engine) {
    INFO("scene ", scene, ", name ", name);
    const Owned run = run_of(scene, name, &window);
    const Record record{.impacts = true, .contacts = true, .energy = true, .history = {{0, 50, 101}}};
    const SceneFile read = parse_scene_file("scene", scene);
    const std::string wanted = run_text(simulate(read.scene, engine, record), read.scales);
    CHECK(text_of(run.get()) == wanted);

    auto file = numbered(nlohmann::ordered_json::parse(wanted));
    CHECK(file["stop_reason"] == impact_damper_stop_reason(run.get()));
    for (const char* key : {"schema", "scene", "engine", "stop_reason", "provenance"}) file.erase(key);
    CHECK(same_numbers(run.get(), "", file) > 700);
    CHECK(names_of(run.get()) == names_in(file, ""));
  };
  check(forced, "exact", Exact{});
  check(forced, "restitution", Restitution{});
  check(forced, "cem", Cem{});
  check(in_units, "exact", Exact{});
  check(several, "restitution", Restitution{});
  check(several, "cem", Cem{});
}

TEST_CASE("an engine's options are those of a run file, each with its default") {
  const auto text_of_run = [](const char* engine) { return text_of(run_of(forced, engine).get()); };
  const auto wanted = [](const Engine& engine) {
    return run_text(
        simulate(parse_scene("scene", forced), engine, {.impacts = true, .contacts = true, .energy = true}));
  };
  CHECK(text_of_run(R"({"name": "exact"})") == wanted(Exact{}));
  CHECK(text_of_run(R"({"name": "cem"})") == wanted(Cem{}));
  const Exact exact{.calibration = Calibration::two_body,
                    .budget = {.max_impacts = 70, .max_half_cycles = 11, .max_time = 40},
                    .max_steps = 9000};
  CHECK(text_of_run(R"({"name": "exact", "calibration": "two-body", "max_steps": 9000, "max_impacts": 70,
                        "max_half_cycles": 11, "max_time": 40})") == wanted(exact));
  Restitution restitution{.accumulation_tolerance = 1e-5};
  CHECK(text_of_run(R"({"name": "restitution", "accumulation_tolerance": 1e-5})") == wanted(restitution));
  Cem cem{
      .time_step = 1e-3, .damper = Damper::lagged, .locate = true, .large_step = 0.03, .stuck_speed = 0.02};
  cem.calibration = Calibration::two_body;
  cem.unstable = true;
  CHECK(text_of_run(
            R"({"name": "cem", "time_step": 1e-3, "damper": "lagged", "locate": true, "large_step": 0.03,
                        "stuck_speed": 0.02, "calibration": "two-body", "unstable": true})") == wanted(cem));

  CHECK(error_of(forced, "{}") == "engine: /name: missing, a value must be given");
  CHECK(error_of(forced, R"({"name": "exact", "time_step": 1})")
            .starts_with("engine: /time_step: unknown key"));
  CHECK(error_of(forced, R"({"name": "cem", "time_step": null})").starts_with("engine: /time_step: must be"));
}

TEST_CASE("what is not recorded is no column, and an empty column is one") {
  const Owned run = run_of(R"({"x0": 0.1, "y0": 0.5, "until_time": 1})");
  for (const auto& [name, is_there] : {std::pair{"history/x", false}, {"impacts/time", true}}) {
    std::size_t rows = 7;
    CHECK((impact_damper_column(run.get(), name, &rows) != nullptr) == is_there);
    CHECK(rows == 0);
  }
  impact_damper_free(nullptr);
}

TEST_CASE("a numerical failure is told from what is not valid") {
  // The only one that a caller can bring about: a rounding mode that breaks the promise of equal bits.
  std::fesetround(FE_UPWARD);
  impact_damper_run* run = nullptr;
  std::string text(500, '#');
  const impact_damper_status status =
      impact_damper_simulate(forced, "exact", nullptr, &run, text.data(), text.size());
  std::fesetround(FE_TONEAREST);
  CHECK(status == IMPACT_DAMPER_NUMERICAL_FAILURE);
  CHECK(run == nullptr);
  CHECK(text.starts_with("results would not have the promised bits: the rounding mode"));
}

TEST_CASE("what cannot be run is told in words, cut to the buffer") {
  CHECK(
      error_of(R"({"mass_ratio": -1, "until_time": 5})", "exact").starts_with("scene: /mass_ratio: must be"));
  CHECK(error_of("{", "exact").starts_with("scene: "));
  CHECK(error_of(forced, "exakt") == "engine: must be exact, restitution or cem, got exakt");
  CHECK(error_of(nullptr, "exact") == "scene, engine: must not be NULL");
  CHECK(error_of(forced, "exakt", nullptr, 8) == "engine:");
  CHECK(error_of(forced, "exakt", nullptr, 1).empty());
  impact_damper_run* run = nullptr;
  CHECK(impact_damper_simulate(forced, "exakt", nullptr, &run, nullptr, 0) == IMPACT_DAMPER_INVALID);
  const impact_damper_window backwards = {5, 1, 10}, endless = {0, 1, SIZE_MAX};
  CHECK(error_of(forced, "exact", &backwards).starts_with("history: "));
  CHECK(error_of(forced, "exact", &endless).starts_with("history: must ask for at most 500000"));
}
