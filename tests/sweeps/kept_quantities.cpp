#include "application/sweeps/kept_quantities.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "impact_damper/analysis/design.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/orbits/lyapunov.hpp"
#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace {

std::vector<KeptQuantity> read_all(const std::vector<std::string>& texts) {
  std::vector<KeptQuantity> kept;
  for (const std::string& text : texts) {
    const QuantityReading reading = read_quantity(text);
    REQUIRE(reading.kept);
    kept.push_back(*reading.kept);
  }
  return kept;
}
KeptNumbers kept(const Scene& scene, const std::vector<std::string>& texts, const Engine& engine = Exact{},
                 const std::optional<Scales>& scales = {}, const ForcedRules& rules = {}) {
  return kept_of(scene, scales, engine, read_all(texts), rules);
}
double only(const KeptNumbers& numbers) {
  REQUIRE(numbers.numbers.size() == 1);
  REQUIRE(numbers.numbers[0]);
  return *numbers.numbers[0];
}

// Viscous damping and next to nothing else: x = 6 exp(-zeta t) (cos omega t + ...).
Scene viscous_decay(double zeta) {
  return {.damping_ratio = zeta, .until_amplitude = 0.5, .dampers = {{.mass_ratio = 1e-9}}};
}

const Scene paper_decay{.until_amplitude = 0.03};
const std::array<Engine, 2> both{Exact{}, Restitution{}};

}  // namespace

TEST_CASE("without viscous damping the best damping is what it is with next to none") {
  Scene scene{.x0 = 2, .until_amplitude = 0.02, .dampers = {{.mass_ratio = 0.3, .restitution = 0.2}}};
  const Exact engine{.budget = {.max_time = 3000}};
  const std::vector<std::string> best{"largest_loss_factor", "amplitude_of_largest_loss_factor"};
  scene.damping_ratio = 0;
  const KeptNumbers none = kept(scene, best, engine);
  scene.damping_ratio = 1e-12;
  const KeptNumbers next_to_none = kept(scene, best, engine);
  // Damping of 1e-12 changes an amplitude by 3e-9 in 3000 units of time.
  for (const std::size_t i : {0u, 1u})
    CHECK(*none.numbers[i] == doctest::Approx(*next_to_none.numbers[i]).epsilon(1e-7));
  CHECK(*none.numbers[0] == doctest::Approx(0.5315).epsilon(1e-4));
}

TEST_CASE("time to an amplitude and loss factor of viscous damping are those of the closed form") {
  for (const double zeta : {0.004, 0.02}) {
    const Scene scene = viscous_decay(zeta);
    const double omega = std::sqrt(1 - zeta * zeta);
    // Peaks of |x| at k pi / omega; the first below 2.
    const double half = std::numbers::pi / omega;
    const double k = std::ceil(std::log(6.0 / 2) / (zeta * half));
    CHECK(only(kept(scene, {"time_to_amplitude=2"})) == doctest::Approx(k * half).epsilon(1e-7));
    for (const char* name : {"loss_factor_at=2", "loss_factor_at=3.3"})
      CHECK(only(kept(scene, {name})) == doctest::Approx(2 * zeta).epsilon(1e-6));
    CHECK(only(kept(scene, {"largest_loss_factor"})) == doctest::Approx(2 * zeta).epsilon(1e-6));
  }
}

// When x, released from rest at 1 without impacts, is last as large as `level`, by the closed form.
double last_time_of_viscous(double zeta, double level) {
  const auto x = [&](double t) {
    if (zeta == 1) return std::exp(-t) * (1 + t);
    if (zeta < 1) {
      const double omega = std::sqrt(1 - zeta * zeta);
      return std::exp(-zeta * t) * (std::cos(omega * t) + zeta / omega * std::sin(omega * t));
    }
    const double root = std::sqrt(zeta * zeta - 1), slow = root - zeta, fast = -root - zeta;
    return (slow * std::exp(fast * t) - fast * std::exp(slow * t)) / (slow - fast);
  };
  double after = 100;
  while (!(std::abs(x(after)) < level && std::abs(x(0.999 * after)) >= level) && after > 0.01) after *= 0.999;
  double before = 0.999 * after;
  for (int i = 0; i < 100; ++i)
    (std::abs(x((before + after) / 2)) < level ? after : before) = (before + after) / 2;
  return after;
}

TEST_CASE("of a motion that creeps the time to an amplitude is the last at which x is as large") {
  Scene scene{.x0 = 3, .until_time = 200, .dampers = {{.mass_ratio = 1e-9}}};
  for (const Engine& engine : both)
    for (const double zeta : {0.7, 0.9, 0.99, 1.0, 1.1, 2.0}) {
      CAPTURE(zeta);
      scene.damping_ratio = zeta;
      CHECK(only(kept(scene, {"time_to_amplitude=0.3"}, engine)) ==
            doctest::Approx(last_time_of_viscous(zeta, 0.1)).epsilon(1e-7));
    }
  CHECK(std::abs(last_time_of_viscous(0.9, 0.1) - 3.41) < 0.005);
  CHECK(std::abs(last_time_of_viscous(2, 0.1) - 8.87) < 0.005);
}

TEST_CASE("with impacts a motion that creeps stays below the amplitude from that time on") {
  Scene scene{.x0 = 3, .until_time = 40, .dampers = {{.mass_ratio = 0.1}}}, of_two = scene;
  of_two.dampers = {{.mass_ratio = 0.05}, {.clearance = 0.7}};
  for (Scene* const each : {&scene, &of_two})
    for (const double zeta : {0.8, 1.0, 1.5}) {
      each->damping_ratio = zeta;
      const double time = only(kept(*each, {"time_to_amplitude=0.3"}));
      const History history =
          *simulate(*each, Exact{}, {.half_cycles = false, .history = {{0, time, 2}, {time, 40, 40'001}}})
               .history;
      CAPTURE(zeta);
      CHECK(std::abs(history.x[1]) == doctest::Approx(0.3).epsilon(1e-12));
      double largest = 0;  // after that time, which is in both windows
      for (std::size_t i = 3; i < history.x.size(); ++i) largest = std::max(largest, std::abs(history.x[i]));
      CHECK(largest < 0.3);
      // The end of the run must show that this was the last time.
      each->until_time = time + 1e-3;
      const KeptNumbers sooner = kept(*each, {"time_to_amplitude=0.3"});
      CHECK((!sooner.numbers[0] || *sooner.numbers[0] == doctest::Approx(time).epsilon(1e-12)));
      each->until_time = time - 1e-3;
      CHECK_FALSE(kept(*each, {"time_to_amplitude=0.3"}).numbers[0]);
      each->until_time = 40;
    }
}

TEST_CASE("what is not reached is absent") {
  const KeptNumbers numbers =
      kept(paper_decay, {"time_to_amplitude=0.01", "loss_factor_at=0.01", "loss_factor_at=7",
                         "lowest_amplitude_above_loss=1", "highest_amplitude_above_loss=1"});
  for (const auto& number : numbers.numbers) CHECK_FALSE(number);
  CHECK(numbers.end == "done");
}

TEST_CASE("with one impact in each half cycle the loss factor is that of the closed form") {
  const Scene& scene = paper_decay;
  for (const double amplitude : {0.15, 0.2, 0.25}) {
    const double loss =
        scene.damper().mass_ratio * single_impact(scene.damper().restitution, amplitude)->loss;
    const auto at = "loss_factor_at=" + std::to_string(amplitude);
    CHECK(only(kept(scene, {at})) == doctest::Approx(loss).epsilon(0.02));
    // Where the bound is that loss, the amplitudes above it end there, on the side of the large ones.
    const auto above = "highest_amplitude_above_loss=" + std::to_string(loss);
    CHECK(only(kept(scene, {above})) == doctest::Approx(amplitude).epsilon(0.03));
  }
  // The curve rises as the amplitude falls, up to impact failure: at the fold of the closed form, or a little
  // below.
  const double lowest = only(kept(scene, {"lowest_amplitude_above_loss=0.06"}));
  const double best = only(kept(scene, {"amplitude_of_largest_loss_factor"}));
  CHECK(lowest <= best);
  CHECK(best == doctest::Approx(fold_amplitude(scene.damper().restitution)).epsilon(0.25));
  CHECK(only(kept(scene, {"largest_loss_factor"})) > only(kept(scene, {"loss_factor_at=0.15"})));
}

TEST_CASE("between two peaks the loss factor lies on the straight line through theirs") {
  const Scene& scene = paper_decay;
  const LossFactor loss = loss_before_failure(simulate(scene, Exact{}, {}));
  std::size_t i = 1;
  while (!(loss.amplitude[i] < 0.2)) ++i;
  REQUIRE(loss.amplitude[i - 1] >= 0.2);
  REQUIRE(loss.eta[i] != loss.eta[i - 1]);
  const double eta = only(kept(scene, {"loss_factor_at=0.2"}));
  CHECK((0.2 - loss.amplitude[i]) * (loss.eta[i - 1] - loss.eta[i]) ==
        doctest::Approx((eta - loss.eta[i]) * (loss.amplitude[i - 1] - loss.amplitude[i]))
            .epsilon(1e-9)
            .scale(1e-12));
  CHECK(std::abs(eta - loss.eta[i]) > 1e-9);
}

TEST_CASE("the share of impacts is what viscous damping leaves") {
  Scene scene = paper_decay;
  scene.damping_ratio = 0.004;
  const Run run = simulate(scene, Exact{}, {});
  // A half cycle of amplitude A loses zeta pi A^2 by viscous damping; all that was there at first is lost.
  double viscous = 0;
  for (const double amplitude : run.half_cycles->amplitude)
    viscous += scene.damping_ratio * std::numbers::pi * amplitude * amplitude;
  CHECK(only(kept(scene, {"impact_energy_share"})) == doctest::Approx(1 - viscous / 18).epsilon(0.02));
  scene.damping_ratio = 0;
  CHECK(only(kept(scene, {"impact_energy_share"})) == 1);
}

TEST_CASE("impacts, their speed and the wall's force are those of the recorded run") {
  const Scene& scene = paper_decay;
  const Run run = simulate(scene, Exact{}, {.impacts = true});
  double speed = 0;
  for (const double velocity : run.impacts->relative_velocity) speed = std::max(speed, std::abs(velocity));
  CHECK(only(kept(scene, {"impacts"})) == double(run.impacts->time.size()));
  CHECK(only(kept(scene, {"largest_impact_speed"})) == speed);
  CHECK(only(kept(scene, {"largest_wall_force"})) ==
        short_contact(scene.damper(), Calibration::fixed_wall, speed).force);
  // The release alone: the secondary mass presses the wall together by 0.01 and never comes back as fast.
  const Scene pressed{.x0 = 0.01, .until_time = 0.01, .dampers = {{.y0 = -0.01}}};
  CHECK(only(kept(pressed, {"largest_wall_force"})) == doctest::Approx(1e4 * 0.01));
  CHECK_FALSE(kept(scene, {"largest_wall_force"}, Restitution{}).numbers[0]);
  Scene soft = scene;
  soft.damper().wall_stiffness = 1;
  CHECK_FALSE(kept(soft, {"largest_wall_force"}).numbers[0]);
}

TEST_CASE("steady motions of a light secondary mass are those of the oscillator alone") {
  const Scene scene{.damping_ratio = 0.05,
                    .force_amplitude = 0.3,
                    .force_frequency = 0.8,
                    .until_time = 1,
                    .dampers = {{.mass_ratio = 1e-8}}};
  ForcedRules rules;
  rules.frequencies = FrequencyRange{0.9, 1.1, 201};
  rules.steady.max_periods = 200;
  rules.steady.mean_periods = 20;
  const KeptNumbers numbers =
      kept(scene, {"steady_amplitude", "impacts_per_period", "worst_steady_amplitude", "worst_frequency"},
           Exact{}, {}, rules);
  const WorstResponse worst = worst_linear_response(0.3, 1, 0.05);
  CHECK(*numbers.numbers[0] == doctest::Approx(linear_response(0.3, 1, 0.05, 0.8)).epsilon(1e-6));
  CHECK(*numbers.numbers[1] > 0);
  CHECK(*numbers.numbers[2] == doctest::Approx(worst.amplitude).epsilon(1e-4));
  CHECK(std::abs(*numbers.numbers[3] - worst.frequency) < 0.0011);
}

TEST_CASE(
    "a periodic motion has its period, and its impacts in it; exponents are those of lyapunov_exponents") {
  const Scene scene{.damping_ratio = 0.1,
                    .x0 = 0,
                    .force_amplitude = 0.01,
                    .force_frequency = 0.5,
                    .until_time = 1,
                    .dampers = {{.mass_ratio = 0.1, .y0 = 0.5}}};
  ForcedRules rules;
  rules.lyapunov_periods = 20;
  rules.lyapunov_discard = 3;
  const Scales scales{4, 100, 10};  // 0.2 s
  const KeptNumbers numbers =
      kept(scene, {"steady_period", "impacts_per_period", "lyapunov_exponent", "steady_amplitude"}, Exact{},
           scales, rules);
  CHECK(*numbers.numbers[0] == 1);
  CHECK(*numbers.numbers[1] == 0);  // the amplitude is far below the clearance
  const double exponent = lyapunov_exponents(scene, Exact{}, 20, 3).exponents[0];
  CHECK(*numbers.numbers[2] == doctest::Approx(exponent / 0.2).epsilon(1e-12));
  CHECK(*numbers.numbers[3] == doctest::Approx(10 * linear_response(0.01, 1, 0.1, 0.5)).epsilon(1e-6));

  const Scene chaotic{.damping_ratio = 0.01,
                      .x0 = 0,
                      .force_amplitude = 0.02,
                      .force_frequency = 1,
                      .until_time = 1,
                      .dampers = {{.mass_ratio = 0.005}}};
  const KeptNumbers chaos = kept(chaotic, {"steady_amplitude", "steady_period", "transient_periods"});
  CHECK(chaos.numbers[0]);
  CHECK_FALSE(chaos.numbers[1]);
  CHECK_FALSE(chaos.numbers[2]);

  Scene list = scene;
  list.force_amplitude = 0.2;
  list.dampers = {{}, {.clearance = 0.7}};
  CHECK(*kept(list, {"lyapunov_exponent"}, Exact{}, scales, rules).numbers[0] ==
        doctest::Approx(lyapunov_exponents(list, Exact{}, 20, 3).exponents[0] / 0.2).epsilon(1e-12));
}

TEST_CASE("a motion that still grows has no steady amplitude, alone or among others, and says so") {
  // At resonance, with next to no secondary mass: after 20 periods at an eighth of its amplitude.
  const Scene scene{.damping_ratio = 0.001,
                    .x0 = 0,
                    .force_amplitude = 0.01,
                    .force_frequency = 1,
                    .until_time = 1,
                    .dampers = {{.mass_ratio = 1e-6}}};
  ForcedRules rules;
  rules.steady.max_periods = 20;
  rules.steady.mean_periods = 10;
  rules.frequencies = FrequencyRange{0.5, 1, 2};
  for (const char* name :
       {"steady_amplitude", "impacts_per_period", "worst_steady_amplitude", "worst_frequency"}) {
    const KeptNumbers growing = kept(scene, {name}, Exact{}, {}, rules);
    CHECK(growing.end == "not_steady");
    CHECK_FALSE(growing.numbers[0]);
  }
  rules.steady.max_periods = 5000;
  // exp(-2 pi zeta n) of the distance at first is left after n periods, (M14.2) in units of the amplitude;
  // the largest of four differences is that of three periods before.
  rules.steady.tolerance = 1e-6;
  const double periods = std::log(1 / rules.steady.tolerance) / (2 * std::numbers::pi * 0.001);
  CHECK(only(kept(scene, {"transient_periods"}, Exact{}, {}, rules)) ==
        doctest::Approx(periods + 3).epsilon(1e-3));
  CHECK(only(kept(scene, {"steady_amplitude"}, Exact{}, {}, rules)) ==
        doctest::Approx(linear_response(0.01, 1, 0.001, 1)).epsilon(1e-3));
}

TEST_CASE("of several dampers the largest wall force is that of the one that has it") {
  const Scene scene{.until_time = 5};
  Scene list = scene;
  list.dampers = {{}};
  const std::vector<std::string> names{"impacts", "largest_impact_speed", "largest_wall_force"};
  CHECK(kept(list, names).numbers == kept(scene, names).numbers);
  list.dampers.push_back({.mass_ratio = 0.01, .clearance = 3, .wall_stiffness = 1e5});
  const Run run = simulate(list, Exact{}, Record{.impacts = true});
  double largest = 0;
  for (std::size_t i = 0; i < run.impacts->time.size(); ++i)
    largest = std::max(largest, short_contact(list.dampers[std::size_t(run.impacts->damper[i])],
                                              Calibration::fixed_wall, run.impacts->relative_velocity[i])
                                    .force);
  CHECK(only(kept(list, {"largest_wall_force"})) == largest);
  // One that begins beyond the right wall.
  list.dampers.push_back({.clearance = 2, .wall_stiffness = 1e6, .y0 = 2.5});
  list.until_time = 1e-6;
  CHECK(only(kept(list, {"largest_wall_force"})) == doctest::Approx(0.5e6));
}

TEST_CASE("without losses there is no loss factor") {
  Scene scene{.until_time = 100, .dampers = {{.restitution = 1}}};
  for (const Engine& engine : both) CHECK_FALSE(kept(scene, {"largest_loss_factor"}, engine).numbers[0]);
  Scene list = scene;
  list.dampers.assign(2, {.mass_ratio = 0.01, .restitution = 1});
  CHECK_FALSE(kept(list, {"largest_loss_factor"}).numbers[0]);
  scene.damping_ratio = 0.01;
  CHECK(kept(scene, {"largest_loss_factor"}).numbers[0]);
}

TEST_CASE("in units, numbers are asked for and given in seconds, millimetres, newtons") {
  const Scene& scene = paper_decay;
  const Scales scales{40, 16000, 10};  // 0.05 s, 10 mm, 160 N
  std::vector<std::string> names{"time_to_amplitude=6", "largest_impact_speed", "largest_wall_force",
                                 "highest_amplitude_above_loss=0.05", "impacts"},
      plain = names;
  plain[0] = "time_to_amplitude=0.6";
  const KeptNumbers in_units = kept(scene, names, Exact{}, scales), without = kept(scene, plain);
  const double units[] = {0.05, 200, 160, 10, 1};
  for (std::size_t i = 0; i < names.size(); ++i)
    CHECK(*in_units.numbers[i] == doctest::Approx(units[i] * *without.numbers[i]).epsilon(1e-13));
}

TEST_CASE("a run that ends early or fails says so") {
  const KeptNumbers early =
      kept(paper_decay, {"impacts", "time_to_amplitude=0.1"}, Exact{.budget = {.max_impacts = 10}});
  CHECK(early.end == "impact_budget");
  CHECK(*early.numbers[0] == 1);  // of the first half cycle; nine more are in the second, which is cut
  CHECK_FALSE(early.numbers[1]);

  const KeptNumbers unforced = kept(paper_decay, {"impacts", "steady_amplitude"});
  CHECK(unforced.end == "not_valid");
  CHECK(unforced.problem == "force_amplitude: must not be 0: without a force there is no steady motion");
  CHECK_FALSE(unforced.numbers[1]);
}

TEST_CASE("a quantity is named with what it needs and nothing else") {
  CHECK(read_quantity("time_to_amplitude=0.6").kept->column() == "time_to_amplitude_0.6");
  CHECK(read_quantity("impacts").kept->text() == "impacts");
  CHECK(read_quantity("impact").problem ==
        "must name a quantity (sweep --list-quantities), got \"impact\", did you mean impacts?");
  CHECK(read_quantity("impacts=3").problem == "must be impacts without a number, got \"impacts=3\"");
  for (const char* text : {"loss_factor_at", "loss_factor_at=", "loss_factor_at=0", "loss_factor_at=nan"})
    CHECK(read_quantity(text).problem.starts_with("must be loss_factor_at=A with a number > 0, got"));
}
