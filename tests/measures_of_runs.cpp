// The measures that read run files, on runs made by hand: a decay in half cycles of length pi with whatever
// amplitudes, impacts and contacts a test wants; and those that read responses, on such a decay and responses
// made by hand; so that each number can be worked out on paper.
#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "application/reproduction/measures.hpp"
#include "application/reproduction/measures_parts.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace {

constexpr double pi = std::numbers::pi;

// n half cycles, row i with amplitude(i), its peak at i pi and a zero crossing half of pi later.
Run decay(int n, const std::function<double(int)>& amplitude) {
  const Scene scene{.until_time = 0.1};
  const Record record{.impacts = true, .contacts = true};
  Run run = simulate(scene, Exact{}, record);
  run.scene.until_time = run.end_time = n * pi;
  HalfCycles& rows = run.half_cycles.emplace();
  for (int i = 0; i < n; ++i) {
    rows.zero_crossing.push_back((i + 0.5) * pi);
    rows.peak_time.push_back(i * pi);
    rows.amplitude.push_back(amplitude(i));
    rows.impacts.push_back(0);
  }
  return run;
}
Run linear_decay(int n, double from, double by) {
  return decay(n, [=](int i) { return from - by * i; });
}

// In a row, at so many degrees of its half cycle.
void add_impact(Run& run, std::size_t row, double phase, double velocity = -1) {
  Impacts& impacts = *run.impacts;
  impacts.time.push_back(run.half_cycles->zero_crossing[row - 1] + phase / 180 * pi);
  impacts.wall.push_back(velocity < 0 ? Wall::left : Wall::right);
  impacts.relative_velocity.push_back(velocity);
  impacts.phase_deg.push_back(phase);
  impacts.amplitude.push_back(run.half_cycles->amplitude[row]);
  impacts.displacement.push_back(0);
  ++run.half_cycles->impacts[row];
}
void add_stuck(Run& run, std::size_t row, double from, double to) {
  const double begin = run.half_cycles->zero_crossing[row - 1];
  run.contacts->begin.push_back(begin + from / 180 * pi);
  run.contacts->end.push_back(begin + to / 180 * pi);
  run.contacts->wall.push_back(Wall::left);
}

// Of one release there is no spread.
double median_of(const Spread& spread) {
  CHECK((spread.low == spread.median || std::isnan(spread.median)));
  CHECK((spread.high == spread.median || std::isnan(spread.median)));
  return spread.median;
}
Spread spread_measured(const std::string& name, std::map<std::string, double> numbers,
                       const std::vector<Run>& scenes) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() /
                                       ("impact-damper-measures-of-runs-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  MeasureCall call{name, {}, std::move(numbers)};
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    call.scenes.push_back("scene" + std::to_string(i));
    write_file(folder / (call.scenes.back() + ".json"), run_text(scenes[i]));
  }
  Runs runs(folder, {.members = 1});
  const Spread spread = measure(runs, call);
  std::filesystem::remove_all(folder);
  return spread;
}
double measured(const std::string& name, std::map<std::string, double> numbers,
                const std::vector<Run>& scenes) {
  return median_of(spread_measured(name, std::move(numbers), scenes));
}

}  // namespace

TEST_CASE("measures of the loss factor are what they are for amplitudes that fall evenly") {
  // A = 6 - 0.05 i at t = i pi: eta = -2 A'/A = (0.1/pi) / A exactly, at A = 5.75, 5.70, ..., 0.3.
  const Run even = linear_decay(120, 6, 0.05);
  const double c = 0.1 / pi, nu = even.scene.damper().mass_ratio;
  const auto of = [&](const std::string& name, const std::map<std::string, double>& numbers) {
    return measured(name, numbers, {even});
  };
  CHECK(of("product_mid_range", {{"from", 1}, {"to", 5}}) == doctest::Approx(c / nu));
  CHECK(of("product_half_range_percent", {{"from", 1}, {"to", 5}}) < 1e-9);
  CHECK(of("product_mean", {{"from", 1}, {"to", 5}}) == doctest::Approx(c / nu));
  // With eta as 1/A^2 the product is as 1/A: the first averaged peak is the sixth, the next the seventh.
  const Run faster = decay(120, [](int i) { return std::sqrt(36 - 0.25 * i); });
  for (const char* first : {"", "_with_first"}) {
    const double largest = std::sqrt(36 - 0.25 * (*first ? 5 : 6)),
                 product = 0.25 / pi / faster.scene.damper().mass_ratio;
    const auto fast = [&](const std::string& name) {
      return measured(name, {{"from", 2.99}, {"to", 6}}, {faster});
    };
    const double least = product / largest, most = product / 3.0;
    CHECK(fast(std::string("product_mid_range") + first) ==
          doctest::Approx((least + most) / 2).epsilon(1e-3));
    CHECK(
        fast(std::string("product_half_range") + first + "_percent") ==
        doctest::Approx(100 * (most - least) / (most + least)).epsilon(3e-3));  // the fit errs by 0.2 percent
  }
  CHECK(of("loss_slope", {{"from", 1}, {"to", 5}}) == doctest::Approx(-1));
  CHECK(of("largest_loss", {}) == doctest::Approx(c / 0.3));
  CHECK(of("largest_loss_amplitude", {}) == doctest::Approx(0.3));
  CHECK(of("largest_smoother_loss", {}) == doctest::Approx(c / 0.5));
  CHECK(of("largest_smoother_loss_amplitude", {}) == doctest::Approx(0.5));
  // The median of the last three is that at 0.35. Averaged over 18 half cycles the last is that at 0.5.
  CHECK(of("tail_loss_ratio", {{"last", 3}}) == doctest::Approx(0.3 / 0.35));
  CHECK(of("smoothing_ratio", {}) == doctest::Approx(0.3 / 0.5));
  // Within a factor of 1.51 of eta at A = 3: from 1.9868 to 4.53.
  CHECK(of("loss_near_span", {{"eta", c / 3}, {"factor", 1.51}, {"from", 0.5}, {"to", 5.5}}) ==
        doctest::Approx(4.5 / 2));
  CHECK(of("loss_near_span", {{"eta", c / 3}, {"factor", 1.51}, {"from", 2.48}, {"to", 4.02}}) ==
        doctest::Approx(4 / 2.5));
  // A eta_s in proportion to nu^1/2.
  Run heavy = linear_decay(60, 6, 0.1);
  heavy.scene.damper().mass_ratio = 4 * nu;
  CHECK(measured("mass_ratio_exponent", {{"from", 1}, {"to", 5}}, {even, heavy}) == doctest::Approx(0.5));
  CHECK(measured("product_ratio", {{"from", 1}, {"to", 5}}, {even, heavy}) == doctest::Approx(2));
  // A eta is twice as much: the power 1/2 of 4, whatever mass ratio the scene names.
  CHECK(measured("loss_ratio_exponent", {{"factor", 4}, {"from", 1}, {"to", 5}}, {heavy, even}) ==
        doctest::Approx(0.5));
  // What it has more is c, in each of twelve bins; 2 zeta A in them is that at the mean of its amplitudes.
  const double from = 0.97, to = 5.03, zeta = 0.004;
  double amplitudes = 0;
  for (int bin = 0; bin < 12; ++bin) {
    double sum = 0, points = 0;
    for (int i = 6; i <= 54; ++i) {
      const double a = 6 - 0.1 * i, place = 12 * std::log(a / from) / std::log(to / from);
      if (place >= bin && place < bin + 1) sum += a, ++points;
    }
    amplitudes += sum / points;
  }
  CHECK(measured("added_loss_error", {{"damping_ratio", zeta}, {"from", from}, {"to", to}}, {heavy, even}) ==
        doctest::Approx(12 * c / (2 * zeta * amplitudes) - 1));
}

TEST_CASE(
    "the half range is half the range by the middle, for amplitudes that fall evenly in the logarithm") {
  // eta is constant, so A eta_s / nu is as A; the fit makes the same error everywhere. From 1.0 to 4.0:
  // exp(-0.02 i), 5 <= i, i = 21 (3.94) to 89 (1.01).
  const Run run = decay(150, [](int i) { return 6 * std::exp(-0.02 * i); });
  const double ratio = std::exp(0.02 * (89 - 21));
  CHECK(measured("product_half_range_percent", {{"from", 1}, {"to", 4}}, {run}) ==
        doctest::Approx(100 * (ratio - 1) / (ratio + 1)));
}

TEST_CASE("measures of the release are what they are, of the scene that is farthest from what is expected") {
  const Run six = linear_decay(20, 6, 0.1), less = linear_decay(20, 5.9, 0.1),
            more = linear_decay(20, 6.2, 0.1);
  CHECK(measured("first_amplitude", {{"amplitude", 6}}, {six, less}) == 5.9);
  CHECK(measured("first_amplitude", {{"amplitude", 6}}, {less, more, six}) == 6.2);
  // From x = 5 the right wall is at 6, the left one at 5.
  Run right = six, left = six;
  add_impact(right, 1, 30, 3);
  add_impact(left, 1, 30, -3);
  add_impact(right, 2, 30, -3);
  right.impacts->displacement.front() = left.impacts->displacement.front() = 5;
  CHECK(measured("first_impact_place", {{"amplitude", 6}}, {right}) == 6);
  CHECK(measured("first_impact_place", {{"amplitude", 6}}, {right, left}) == 5);
  CHECK(std::isnan(measured("first_impact_place", {{"amplitude", 6}}, {right, six})));
}

TEST_CASE("what the impacts take out is compared with what the amplitudes lose") {
  Run run = linear_decay(21, 6, 0.25);  // from 6 to 1: (36 - 1) / 2
  run.scene.damper().mass_ratio = 0.25;
  run.scene.damper().restitution = 0.5;
  add_impact(run, 1, 30, 3);
  add_impact(run, 2, 30, -4);
  const double lost = 0.25 * 0.75 / 2.5 * 25;
  CHECK(measured("impact_loss_error", {}, {run}) == doctest::Approx(lost / 17.5 - 1));
}

TEST_CASE("measures of the windows are what they are for impacts made by hand") {
  // Two impacts in rows 10 to 29, one in rows 40 to 69, both in turn between them; none from row 80 on.
  Run run = linear_decay(100, 6, 0.05);
  for (std::size_t row = 10; row < 70; ++row) {
    const bool two = row < 30 || (row < 40 && row % 2 == 0);
    // One impact alternates between 87 and 134 degrees.
    add_impact(run, row, row % 2 ? 87 : 134);
    if (two) add_impact(run, row, 170);
  }
  for (std::size_t row = 71; row < 80; row += 2) add_impact(run, row, 90);
  const auto of = [&](const std::string& name, const std::map<std::string, double>& numbers) {
    return measured(name, numbers, {run});
  };
  const auto amplitude = [](double row) { return 6 - 0.05 * row; };
  // One impact: from amplitude(39), as the row before row 40 has one too, down to amplitude(69).
  const double upper = amplitude(39), lower = amplitude(69);
  CHECK(of("window_nearest", {{"impacts", 1}, {"amplitude", upper + 0.5}}) == doctest::Approx(upper));
  CHECK(of("window_nearest", {{"impacts", 1}, {"amplitude", lower - 0.25}}) == doctest::Approx(lower));
  CHECK(of("window_nearest", {{"impacts", 1}, {"amplitude", (upper + lower) / 2}}) == (upper + lower) / 2);
  CHECK(std::isinf(of("window_nearest", {{"impacts", 7}, {"amplitude", upper}})));
  CHECK(of("window_upper", {{"impacts", 1}, {"amplitude", upper + 0.5}}) == doctest::Approx(upper));
  CHECK(of("window_lower", {{"impacts", 1}, {"amplitude", upper + 0.5}}) == doctest::Approx(lower));
  CHECK(of("windows_in_order", {{"most", 2}}) == 2);
  CHECK(of("mixed_gaps", {{"most", 2}}) == 1);
  CHECK(of("impacts_per_half_cycle", {{"amplitude", amplitude(29.5)}, {"half_cycles", 10}}) ==
        doctest::Approx(1.5));
  CHECK(of("rows_with_impacts", {{"amplitude", amplitude(29.5)}, {"half_cycles", 10}, {"impacts", 2}}) ==
        doctest::Approx(0.5));
  // Of rows 28 to 41 those with one and two in turn with the row before: 31 to 39.
  CHECK(of("alternation", {{"from", amplitude(41.5)}, {"to", amplitude(27.5)}}) == doctest::Approx(9.0 / 14));
  CHECK(of("phase_difference", {{"amplitude", amplitude(49.5)}, {"half_cycles", 6}}) == doctest::Approx(47));
  CHECK(std::isnan(of("phase_difference", {{"amplitude", amplitude(19.5)}, {"half_cycles", 6}})));
  // From row 70 on every other half cycle is without, and three in a row have two at most.
  CHECK(of("first_missed", {}) == doctest::Approx(amplitude(70)));
}

TEST_CASE("measures of speeds and of stuck phases are what they are for contacts made by hand") {
  // The fastest impact of a half cycle goes with A^2, after slower ones; the mass sticks for 20 A degrees.
  Run run = linear_decay(60, 6, 0.05);
  const auto& amplitude = run.half_cycles->amplitude;
  for (std::size_t row = 1; row < 50; ++row) {
    const double a = amplitude[row];
    add_impact(run, row, 30, -0.1 * a);
    add_impact(run, row, 30 + 10 * a, 0.5 * a * a);
    if (row < 30) add_stuck(run, row, 40, 40 + 20 * a);
  }
  const std::map<std::string, double> range{{"from", 4.6}, {"to", 5.8}};
  CHECK(measured("stuck_degrees_slope", range, {run}) == doctest::Approx(20));
  CHECK(measured("bounce_down_degrees_slope", range, {run}) == doctest::Approx(10));
  CHECK(measured("impact_speed_slope", {{"from", 4.6}, {"to", 5.8}, {"power", 0.5}}, {run}) ==
        doctest::Approx(1.5));
  CHECK(measured("stuck_share", {{"from", amplitude[39] - 0.01}, {"to", amplitude[20] + 0.01}}, {run}) ==
        doctest::Approx(0.5));
  CHECK(measured("bounce_down_end", {}, {run}) == doctest::Approx(amplitude[29]));
  CHECK(measured("longest_stuck_series", {}, {run}) == 29);
  add_stuck(run, 35, 40, 60);  // one of its own
  CHECK(measured("longest_stuck_series", {}, {run}) == 29);
}

TEST_CASE("a wall gives way as a damped spring struck at the fastest impact does") {
  // Either wall, met first and once. Struck at speed w the wall of two free masses gives way at most by
  // (w / omega) exp(-z arccos(z) / sqrt(1 - z^2)), omega^2 = (1 + nu) k / nu, z = zeta_m sqrt(1 + nu).
  for (const double w0 : {-2.0, 3.0}) {
    const Scene scene{.x0 = 0, .until_time = 0.4, .dampers = {{.y0 = 0.5, .w0 = w0}}};
    const Record record{.impacts = true};
    const Run run = simulate(scene, Exact{}, record);
    const double nu = scene.damper().mass_ratio, decrement = -std::log(scene.damper().restitution);
    const double z = decrement / std::hypot(pi, decrement) * std::sqrt(1 + nu);
    const double omega = std::sqrt((1 + nu) * scene.damper().wall_stiffness / nu);
    // The samples, two hundred in a contact, miss the deepest point by less than 1e-4 of it.
    CHECK(measured("wall_overlap", {}, {run}) ==
          doctest::Approx(std::abs(w0) / omega * std::exp(-z * std::acos(z) / std::sqrt(1 - z * z)))
              .epsilon(2e-4));
  }
}

TEST_CASE("rigid walls give way by nothing, and a run mixes as much as itself") {
  const Scene scene{.until_amplitude = 3};
  const Record record{.impacts = true};
  const Run run = simulate(scene, Restitution{}, record);
  CHECK(measured("wall_overlap", {}, {run}) < 1e-12);
  CHECK(measured("mixed_share_ratio", {{"from", 3}, {"to", 5}}, {run, run}) == 1);
}

TEST_CASE("the share of mixed half cycles is that outside the windows, divided by the second run's") {
  const Scene scene{.until_amplitude = 3};
  const Run second = simulate(scene, Restitution{}, Record{});
  Run run = second;
  const auto share = [](const Run& of) {
    double mixed = 0, rows = 0;
    for (std::size_t row = 1; row < of.half_cycles->amplitude.size(); ++row) {
      if (of.half_cycles->amplitude[row] < 3 || of.half_cycles->amplitude[row] > 4.6) continue;
      ++rows;
      bool regular = false;
      for (const RegularWindow& window : regular_windows(of))
        regular = regular || (row >= window.first && row <= window.last);
      mixed += !regular;
    }
    return mixed / rows;
  };
  // Every second row is given a count of its own, so that no window is left from there on.
  for (std::size_t row = 0; row < run.half_cycles->impacts.size(); row += 2)
    run.half_cycles->impacts[row] += 20;
  CHECK(share(run) == 1);
  CHECK(measured("mixed_share_ratio", {{"from", 3}, {"to", 4.6}}, {run, second}) ==
        doctest::Approx(1 / share(second)));
}

TEST_CASE("a peak is as wide as the amplitudes around it down to half its height") {
  // eta is as 1/A at A = 6.01 - 0.05 i. Averaged over 10 half cycles the last point is that at 0.31, and half
  // of its eta is exceeded up to 0.61; over 18 those are 0.51 and 1.01.
  CHECK(measured("smoothing_width_ratio", {}, {linear_decay(120, 6.01, 0.05)}) ==
        doctest::Approx(std::log(1.01 / 0.51) / std::log(0.61 / 0.31)));
}

namespace {

// The same amplitudes in `factor` times the time.
Run slower(Run run, double factor) {
  for (auto* column : {&run.half_cycles->zero_crossing, &run.half_cycles->peak_time})
    for (double& time : *column) time *= factor;
  run.scene.until_time = run.end_time *= factor;
  return run;
}

// Largest less least, in percent of the mean.
double percent_apart(double a, double b) { return 100 * std::abs(a - b) / ((a + b) / 2); }

}  // namespace

TEST_CASE("two runs take time in proportion, or save it, by when they are below an amplitude") {
  // The first peak below 4.02 is number 40 of one, and 20 of the other, which takes 1.5 times as long for
  // each.
  const Run one = linear_decay(120, 6, 0.05), other = slower(linear_decay(60, 6, 0.1), 1.5);
  CHECK(measured("time_ratio", {{"amplitude", 4.02}}, {one, other}) == doctest::Approx(40 / 30.0));
  CHECK(measured("time_saved_percent", {{"amplitude", 4.02}}, {one, other}) ==
        doctest::Approx(100 * (1 - 40 / 30.0)));
}

TEST_CASE("curves collapse as far as their ordinates agree") {
  // One point each, at A = 3, where eta = 0.1/pi / 3; the second decay takes 1.25 times as long.
  Run one = linear_decay(120, 6, 0.05), other = slower(one, 1.25);
  one.scene.damping_ratio = 0.001;
  other.scene.damping_ratio = 0.002;
  other.scene.damper().mass_ratio = 0.03;
  other.scene.damper().restitution = 0.5;
  const double eta = 0.1 / pi / 3, its = eta / 1.25;
  const auto of = [&](const std::string& name) {
    return measured(name, {{"from", 2.99}, {"to", 3.01}}, {one, other});
  };
  CHECK(of("collapse_specific_percent") == doctest::Approx(percent_apart(eta / 0.02, its / 0.03)));
  const double left = (eta - 0.002) / 0.02, its_left = (its - 0.004) / 0.03;
  CHECK(of("collapse_secondary_percent") == doctest::Approx(percent_apart(left, its_left)));
  CHECK(of("collapse_restitution_percent") == doctest::Approx(percent_apart(left / 0.4, its_left / 0.5)));
  CHECK(of("collapse_product_percent") == doctest::Approx(percent_apart(left, its_left)));
  const double carried = (eta - 0.002 / 1.02) / 0.02, its_carried = (its - 0.004 / 1.03) / 0.03;
  CHECK(of("collapse_carried_percent") == doctest::Approx(percent_apart(carried, its_carried)));
  // There is but one bin.
  for (const std::string which : {"specific", "secondary", "restitution", "product", "carried"})
    CHECK(of("collapse_" + which + "_worst_percent") == of("collapse_" + which + "_percent"));
}

TEST_CASE("the amplitude of the largest product is that of the steepest envelope among the averaged peaks") {
  // A A' falls throughout, and a parabola meets the envelope exactly: the last peak that has a point.
  const auto amplitude = [](int i) { return 6 - 0.01 * i - 0.0004 * i * i; };
  const Run run = decay(100, amplitude);
  const auto of = [&](double from, double averaged_over) {
    return measured("product_peak_amplitude", {{"from", from}, {"to", 5}, {"averaged_over", averaged_over}},
                    {run});
  };
  CHECK(of(0, 10) == doctest::Approx(amplitude(94)));
  CHECK(of(0, 18) == doctest::Approx(amplitude(90)));
  CHECK(of(amplitude(80) - 1e-6, 10) == doctest::Approx(amplitude(80)));
}

TEST_CASE("single impacts are better by the largest loss in and below their window") {
  Run run = linear_decay(120, 6, 0.05);
  for (std::size_t row = 1; row < 120; ++row) run.half_cycles->impacts[row] = row < 60 ? 2 : 1;
  // eta is as 1/A: 0.3 is the last amplitude that has a point. That of row 60, where the window begins, may
  // by rounding be counted with those above or not.
  const double advantage = measured("single_impact_advantage", {}, {run});
  CHECK((std::abs(advantage - 3 / 0.3) < 1e-9 || std::abs(advantage - 3.05 / 0.3) < 1e-9));
}

TEST_CASE("a first missed impact is put in proportion to another scene's") {
  Run sooner = linear_decay(120, 6, 0.05), later = sooner;
  for (std::size_t row = 1; row < 80; ++row) {
    sooner.half_cycles->impacts[row] = row < 50;
    later.half_cycles->impacts[row] = 1;
  }
  CHECK(measured("first_missed_ratio", {}, {sooner, later}) == doctest::Approx(3.5 / 2));
}

TEST_CASE("the order of a step is the slope of its amplitudes' errors, summed") {
  const Scene scene{.until_time = 30, .dampers = {{.mass_ratio = 0.1, .wall_stiffness = 100}}};
  const Run exact = simulate(scene, Exact{}, Record{});
  const auto error = [&](double step, bool locate) {
    const Run run = simulate(scene, Cem{.time_step = step, .locate = locate}, Record{});
    double sum = 0;
    for (std::size_t row = 0; row < exact.half_cycles->amplitude.size(); ++row)
      sum += std::abs(run.half_cycles->amplitude.at(row) - exact.half_cycles->amplitude[row]);
    return sum;
  };
  const double contact = pi / std::sqrt(scene.damper().wall_stiffness * 1.1 / 0.1);
  for (const bool locate : {false, true}) {
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (int i = 0; i < 32; ++i) {
      const double step = contact / 20 * std::pow(5, -i / 31.0), x = std::log(step),
                   y = std::log(error(step, locate));
      sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    CHECK(measured(locate ? "step_order_located" : "step_order", {{"steps_per_contact", 20}, {"factor", 5}},
                   {simulate(scene, Exact{}, {true, true, true})}) ==
          doctest::Approx((32 * sxy - sx * sy) / (32 * sxx - sx * sx)).epsilon(1e-6));
  }
}

TEST_CASE("the impacts of half cycles that end stuck become more as a power of 1/(1 - e)") {
  Scene scene{.until_time = 1, .dampers = {{.mass_ratio = 0.02}}};
  const double grows = measured("stuck_impacts_growth", {}, {simulate(scene, Exact{}, {true, true, true})});
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const double e : {0.4, 0.6, 0.8, 0.9}) {
    Scene other = scene;
    other.damper().restitution = e;
    other.x0 = 1.1 * bounce_down_end(e);
    other.until_amplitude.reset();
    other.until_time = 20;
    const HalfCycles rows = *simulate(other, Exact{}, Record{}).half_cycles;
    double impacts = 0;
    for (std::size_t row = 1; row <= 5; ++row) impacts += static_cast<double>(rows.impacts.at(row)) / 5;
    const double x = -std::log(1 - e), y = std::log(impacts);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  CHECK(grows == doctest::Approx((4 * sxy - sx * sy) / (4 * sxx - sx * sx)).epsilon(1e-9));
  scene.damper().mass_ratio = 100;  // stuck, a half cycle takes ten times as long
  CHECK(std::isnan(measured("stuck_impacts_growth", {}, {simulate(scene, Exact{}, {true, true, true})})));
}

TEST_CASE("the paper's stuck regime saves the steps that a run to the same amplitude can do without") {
  const Scene scene{.until_amplitude = 1, .dampers = {{.mass_ratio = 0.05}}};
  const Run file = simulate(scene, Exact{}, {true, true, true});
  const double speed = 0.4;
  const auto ends = [&](std::optional<double> stuck_speed, std::int64_t steps) {
    Scene its = scene;
    its.until_amplitude = 5;
    const Cem engine{.locate = true, .large_step = 0.02, .stuck_speed = stuck_speed, .max_steps = steps};
    return simulate(its, engine, Record{}).stop_reason;
  };
  // The share of steps is right if with as many the run comes to its end, and with fewer it does not.
  const double share =
      measured("stuck_regime_steps_percent", {{"stuck_speed", speed}, {"amplitude", 5}}, {file});
  CHECK(share > 10);
  std::int64_t without = 1;
  while (ends({}, without) == StopReason::step_budget) without += without / 100 + 1;
  const auto with = static_cast<double>(without) * (1 - share / 100);
  CHECK(ends(speed, std::int64_t(1.001 * with)) == StopReason::amplitude);
  CHECK(ends(speed, std::int64_t(0.985 * with)) == StopReason::step_budget);
}

TEST_CASE("measures of several dampers are what they are for decays of known loss factors") {
  // eta = 0.02 above A = 1, 0.08 below it, from 6 down to 0.02.
  const auto two_slopes = [](int i) {
    const double above = std::log(6.0) / (0.02 * pi / 2);
    return i <= above ? 6 * std::exp(-0.02 * i * pi / 2) : std::exp(-0.08 * (i - above) * pi / 2);
  };
  const Run run = decay(88, two_slopes);
  const std::map<std::string, double> all{{"from", 0.1}, {"to", 5}};
  CHECK(measured("loss_ratio", all, {run}) == doctest::Approx(4));
  CHECK(measured("loss_variation_percent", all, {run}) == doctest::Approx(60));
  // Constant to a tenth: above 1 to 5 and from 1 down to 0.1, ten times, but for the bin in which 1 lies.
  CHECK(measured("alike_range", {{"from", 0.1}, {"to", 5}, {"within", 0.1}}, {run}) ==
        doctest::Approx(10).epsilon(0.25));
  CHECK(measured("alike_range", {{"from", 0.1}, {"to", 5}, {"within", 0.7}}, {run}) == doctest::Approx(50));

  // 0.03 together; alone eta = 0.01 with nu = 0.02, so that dampers of 0.02 and 0.02 should lose 0.02.
  Scene scene{.until_time = 0.1};
  scene.dampers = {{.mass_ratio = 0.02, .clearance = 1}, {.mass_ratio = 0.02, .clearance = 3}};
  Run set = simulate(scene, Restitution{}, Record{});
  set.half_cycles = decay(300, [](int i) { return 6 * std::exp(-0.03 * i * pi / 2); }).half_cycles;
  set.end_time = *(set.scene.until_time = 300 * pi);
  set.half_cycles->dampers = {{set.half_cycles->impacts}, {set.half_cycles->impacts}};
  Run alone = decay(800, [](int i) { return 7 * std::exp(-0.01 * i * pi / 2); });
  alone.scene.damper().mass_ratio = 0.02;
  alone.scene.until_amplitude = 0.01;
  // All bins alike.
  const Spread excess = spread_measured("from_sum", all, {set, alone});
  CHECK(excess.low == doctest::Approx(0.5));
  CHECK(excess.median == doctest::Approx(0.5));
  CHECK(excess.high == doctest::Approx(0.5));
  // One damper's measure is not taken of a list, nor this of one damper.
  CHECK_THROWS_AS(measured("largest_loss", {}, {set}), std::invalid_argument);
  CHECK_THROWS_AS(measured("from_sum", all, {alone, alone}), std::invalid_argument);
}

TEST_CASE(
    "friction and drag take what a run down to each of two amplitudes says, and lock as the closed form "
    "says") {
  const Scene scene{.x0 = 3, .until_time = 400, .dampers = {{.mass_ratio = 0.05, .friction = 0.3}}};
  const Run run = simulate(scene, Restitution{}, Record{});
  const auto lost = [&](double amplitude) {
    Scene until = scene;
    until.until_amplitude = amplitude;
    return *simulate(until, Restitution{}, {.energy = true}).energy;
  };
  const auto share = [&](double to, double from) {
    const EnergyBalance before = lost(to), after = lost(from);
    return (after.friction_loss - before.friction_loss) / (before.final.total() - after.final.total());
  };
  const auto of = [&](const std::string& name, double from, double to) {
    return measured(name, {{"from", from}, {"to", to}}, {run});
  };
  CHECK(share(2, 1) > 0.1);
  CHECK(of("component_share", 1, 2) == doctest::Approx(share(2, 1)).epsilon(1e-12));
  // Viscous damping is among what is lost; an amplitude that is not reached has no share.
  Run damped = run;
  damped.scene.damping_ratio = 0.02;
  CHECK(measured("component_share", {{"from", 1}, {"to", 2}}, {damped}) < 0.6 * share(2, 1));
  CHECK(std::isnan(of("component_share", 0.1, 2)));
  // A fluid that resists that much takes all.
  const Run wet = simulate({.x0 = 3, .until_time = 400, .dampers = {{.mass_ratio = 0.05, .drag = 5}}},
                           Cem{.locate = true}, Record{});
  CHECK(measured("component_share", {{"from", 2}, {"to", 2.6}}, {wet}) > 0.8);
  // The share is as phi / A: a twentieth at some 45 phi, here in the bin below 0.45.
  Run little = run;
  little.scene.dampers = {{.mass_ratio = 0.02, .friction = 0.01}};
  little.scene.until_time = 4000;
  const double lowest = measured("component_share_insignificant", {{"from", 0.1}, {"to", 3}}, {little});
  const double bin = std::pow(30, 1 / 18.0);
  CHECK(measured("component_share", {{"from", lowest}, {"to", lowest * bin}}, {little}) < 0.05);
  CHECK(measured("component_share", {{"from", lowest / bin}, {"to", lowest}}, {little}) >= 0.05);
  CHECK(std::isnan(of("component_share_insignificant", 0.5, 2)));

  CHECK(measured("locked_amplitude_ratio", {}, {run}) ==
        doctest::Approx(run.half_cycles->amplitude.back() / (0.3 * 1.05)).epsilon(1e-12));
  Run held = run;
  held.scene.damper().static_friction = 0.4;
  held.scene.weight = 0.2;
  CHECK(measured("locked_amplitude_ratio", {}, {held}) ==
        doctest::Approx(run.half_cycles->amplitude.back() / (0.6 * 1.05)).epsilon(1e-12));
}

// --- Measures that read responses --------------------------------------------------------------------------

namespace {

// A = a0 - a1 t + a2 t^2 at the peaks t = i pi, to which a parabola is fitted exactly. A eta = -2 A' falls
// with the amplitude: A'^2 = a1^2 - 4 a2 (a0 - A).
constexpr double a0 = 4, a1 = 0.009, a2 = 4e-6;
constexpr int rows = 160;
constexpr double nu = 0.2;
double amplitude_at(double i) { return a0 - a1 * i * pi + a2 * i * i * pi * pi; }
double needed_at(double i) { return std::sqrt(1 + nu) * 2 * (a1 - 2 * a2 * i * pi); }
double predicted(double force) {
  const double slope = force / (2 * std::sqrt(1 + nu));
  return a0 - (a1 * a1 - slope * slope) / (4 * a2);
}
Run parabola_decay(int n = rows, const std::function<double(int)>& amplitude = amplitude_at) {
  Run run = decay(n, amplitude);
  run.scene.damper().mass_ratio = nu;
  return run;
}
// Points of the loss curve are at i = 6 to rows - 6, row 5 being left out.
constexpr int first_point = 6, last_point = rows - 6;

SteadyState steady(double amplitude, double scatter = 0) {
  SteadyState state;
  state.means = SteadyMeans{.amplitude = amplitude};
  state.amplitude_scatter = scatter;
  return state;
}
std::vector<SteadyState> with_amplitudes(const std::vector<double>& amplitudes) {
  std::vector<SteadyState> states;
  for (const double amplitude : amplitudes) states.push_back(steady(amplitude));
  return states;
}
SweepResponse over_force(double from, double to, const std::vector<double>& up,
                         const std::vector<double>& down) {
  SweepResponse response;
  response.axis = {&Scene::force_amplitude, from, to, static_cast<std::int64_t>(up.size())};
  response.sweeps.push_back({.up = with_amplitudes(up), .down = with_amplitudes(down)});
  return response;
}

Spread spread(const std::string& name, const std::map<std::string, double>& numbers,
              const std::vector<Response>& responses, bool of_decay = true) {
  Runs runs(std::nullopt, {.members = 1});
  runs.put("decay", parabola_decay());
  MeasureCall call;
  call.name = name;
  if (of_decay) call.scenes = {"decay"};
  call.numbers = numbers;
  for (const Response& response : responses) {
    call.responses.push_back("response" + std::to_string(call.responses.size()));
    runs.put(call.responses.back(), response);
  }
  return measure(runs, call);
}
double measured(const std::string& name, const std::map<std::string, double>& numbers,
                const std::vector<Response>& responses, bool of_decay = true) {
  return median_of(spread(name, numbers, responses, of_decay));
}
double share(const std::string& name, const std::vector<Response>& responses) {
  return measured(name, {}, responses, false);
}

const std::map<std::string, double> everything{{"from", 0.1}, {"to", 10}};

// Linear between points whose second difference is 2 a2 pi^2: the amplitude is good to a quarter of that.
constexpr double between_points = a2 * pi * pi / 2;

}  // namespace

TEST_CASE("the largest steady amplitude is held against the one that the decay predicts") {
  // The middle three forces have a prediction; one is below all that the decay needs, one above.
  const double least = needed_at(last_point), most = needed_at(first_point);
  const double from = least - 0.002, to = most + 0.002, step = (to - from) / 4;
  const double f1 = from + step, f2 = from + 2 * step, f3 = from + 3 * step;
  REQUIRE(f1 > least);
  REQUIRE(f3 < most);
  const double p1 = predicted(f1), p2 = predicted(f2), p3 = predicted(f3);
  // The largest of both responses counts, whichever it is in.
  const SweepResponse one = over_force(from, to, {9, 0.8 * p1, 1.04 * p2, 0.1, 9},
                                       {9, 1.1 * p1, 0.2, 0.98 * p3, 9}),
                      other = over_force(from, to, {9, 0.7 * p1, 0.3, 0.9 * p3, 9},
                                         {9, 0.9 * p1, 1.06 * p2, 0.2, 9});
  const auto of = [&](const std::string& name) { return measured(name, everything, {one, other}); };
  const double error = 100 * between_points / p1;
  CHECK(std::abs(of("steady_amplitude_falling_percent") - (10 + 6 + 2) / 3.0) < error);
  CHECK(std::abs(of("steady_amplitude_falling_worst_percent") - 10) < error);
  CHECK(std::abs(of("steady_amplitude_rising_percent") - (20 + 4 + 10) / 3.0) < error);
  CHECK(std::abs(of("steady_amplitude_rising_worst_percent") - 20) < error);

  // Only predicted amplitudes within the range count.
  const double above_p1 = (p1 + p2) / 2, below_p3 = (p2 + p3) / 2;
  CHECK(
      std::abs(measured("steady_amplitude_falling_percent", {{"from", above_p1}, {"to", 10}}, {one, other}) -
               (6 + 2) / 2.0) < error);
  CHECK(
      std::abs(measured("steady_amplitude_rising_percent", {{"from", 0.1}, {"to", below_p3}}, {one, other}) -
               (20 + 4) / 2.0) < error);
}

TEST_CASE(
    "where the force that is needed has no single amplitude, the one nearest below its largest counts") {
  // A decay that loses twice as much at its end as before needs the same forces there once more.
  Runs runs(std::nullopt, {.members = 1});
  const double slope = a1 - 2 * a2 * rows * pi;
  runs.put("decay", parabola_decay(rows + 60, [=](int i) {
             return i < rows ? amplitude_at(i) : amplitude_at(rows) - 1.5 * slope * (i - rows) * pi;
           }));
  const double force = 1.2 * needed_at(last_point), p = predicted(force);
  REQUIRE(p > amplitude_at(rows));
  runs.put("response", Response(over_force(force, 2 * force, {p, 1}, {1.05 * p, 1})));
  REQUIRE(2 * force > needed_at(first_point));
  const MeasureCall call{"steady_amplitude_falling_worst_percent", {"decay"}, everything, {"response"}};
  CHECK(std::abs(measure(runs, call).median - 5) < 100 * between_points / p);
}

TEST_CASE("the force beyond the largest that the decay needs is found between two forces of a rising sweep") {
  const double top = amplitude_at(first_point), needed = needed_at(first_point);
  // 0.02 and 0.03: a third of the way from below to above.
  const SweepResponse rises = over_force(0.01, 0.04, {0.5, top - 0.1, top + 0.2, 9}, {9, 9, 9, 9});
  CHECK(measured("force_limit_ratio", everything, {rises}) == doctest::Approx((0.02 + 0.01 / 3) / needed));
  // The range moves the top: to row 50.
  const double middle = amplitude_at(50);
  const SweepResponse lower = over_force(0.01, 0.04, {0.5, middle - 0.1, middle + 0.1, 9}, {9, 9, 9, 9});
  CHECK(measured("force_limit_ratio", {{"from", 0.1}, {"to", middle + 1e-9}}, {lower}) ==
        doctest::Approx(0.025 / needed_at(50)));
  // Never exceeded, or already at the first force.
  CHECK(std::isnan(measured("force_limit_ratio", everything, {over_force(0.01, 0.02, {1, 2}, {9, 9})})));
  CHECK(std::isnan(measured("force_limit_ratio", everything, {over_force(0.01, 0.02, {8, 9}, {1, 1})})));
}

TEST_CASE("the jump is between the forces of a falling sweep where the amplitude falls below 0.5") {
  const double from = 0.5 * (amplitude_at(99) + amplitude_at(100)), least = needed_at(99);
  const std::map<std::string, double> range{{"from", from}, {"to", 10}};
  // Held at 0.04 and 0.05; not at 0.03; what is at 0.02 lies below the jump.
  const SweepResponse falls = over_force(0.01, 0.05, {0, 0, 0, 0, 0}, {0, 1, 0.45, 0.5, 3});
  CHECK(measured("force_jump_ratio", range, {falls}) == doctest::Approx(0.035 / least));
  CHECK(std::isnan(measured("force_jump_ratio", range, {over_force(0.01, 0.02, {0, 0}, {3, 3})})));
  CHECK(std::isnan(measured("force_jump_ratio", range, {over_force(0.01, 0.02, {3, 3}, {3, 0.1})})));
}

TEST_CASE(
    "a state that was not reached has no amplitude, and responses of other kinds or forces are rejected") {
  const double force = needed_at(80), p = predicted(force);
  SweepResponse sweep = over_force(force, 2 * force, {p, p}, {p, p});
  CHECK(measured("steady_amplitude_falling_percent", everything, {sweep}) < 1);
  SweepResponse ended = sweep;
  ended.sweeps[0].down[0].means.reset();
  CHECK(std::isnan(measured("steady_amplitude_falling_percent", everything, {ended, sweep})));
  CHECK(std::isnan(measured("steady_amplitude_falling_percent", everything, {sweep, ended})));
  CHECK(std::isnan(share("one_motion_share", {ended})));
  SweepResponse frequencies = sweep;
  frequencies.axis.number = &Scene::force_frequency;
  CHECK_THROWS_AS(measured("force_limit_ratio", everything, {frequencies}), std::invalid_argument);
  CHECK_THROWS_AS(
      measured("force_limit_ratio", everything, {sweep, over_force(force, 3 * force, {p, p}, {p, p})}),
      std::invalid_argument);
  CHECK_THROWS_AS(share("one_motion_share", {BasinResponse{}}), std::invalid_argument);
  CHECK_THROWS_AS(share("two_impact_share", {sweep}), std::invalid_argument);
}

TEST_CASE("sweeps from other starts are an ensemble, whose median counts") {
  const double force = needed_at(80), p = predicted(force), error = 100 * between_points / p;
  REQUIRE(2 * force > needed_at(first_point));  // without a prediction
  const auto sweeps = [&](const std::vector<double>& amplitudes) {
    SweepResponse all = over_force(force, 2 * force, {p, 9}, {p, 9});
    all.sweeps.clear();
    for (const double amplitude : amplitudes)
      all.sweeps.push_back(
          {.up = with_amplitudes({amplitude * p, 9}), .down = with_amplitudes({(amplitude + 0.1) * p, 9})});
    return all;
  };
  // Of both responses the larger counts, start by start: 1.3, 1.1, 1.2; force falling 1.4, 1.2, 1.3.
  const SweepResponse one = sweeps({1.3, 0.5, 1.2}), other = sweeps({0.4, 1.1, 0.3});
  const auto is = [&](const std::string& name, double low, double median, double high) {
    const Spread found = spread(name, everything, {one, other});
    CHECK(std::abs(found.low - low) < error);
    CHECK(std::abs(found.median - median) < error);
    CHECK(std::abs(found.high - high) < error);
  };
  is("steady_amplitude_rising_percent", 10, 20, 30);
  is("steady_amplitude_falling_worst_percent", 20, 30, 40);
  CHECK_THROWS_AS(spread("steady_amplitude_rising_percent", everything, {one, sweeps({1, 1})}),
                  std::invalid_argument);

  const SweepResponse same = over_force(1, 2, {1, 1}, {1, 1});
  SweepResponse both = same;
  both.sweeps.push_back({.up = with_amplitudes({1, 1}), .down = with_amplitudes({1, 2})});
  const Spread share_of_both = spread("one_motion_share", {}, {both, both}, false);
  CHECK(share_of_both.low == doctest::Approx(0.5));
  CHECK(share_of_both.median == doctest::Approx(0.75));
  CHECK(share_of_both.high == doctest::Approx(1));
  CHECK_THROWS_AS(spread("one_motion_share", {}, {both, same}, false), std::invalid_argument);
}

TEST_CASE("two ways arrive at one motion if they differ by 5 percent or three standard deviations at most") {
  SweepResponse sweep = over_force(1, 5, {1, 1, 1, 1, 1}, {1.04, 1.06, 0.94, 1.2, 1.2});
  CHECK(share("one_motion_share", {sweep}) == doctest::Approx(1 / 5.0));
  // 3 sqrt(0.03^2 + 0.06^2) = 0.2012
  sweep.sweeps[0].up[3].amplitude_scatter = sweep.sweeps[0].up[4].amplitude_scatter = 0.03;
  sweep.sweeps[0].down[3].amplitude_scatter = 0.06;
  sweep.sweeps[0].down[4].amplitude_scatter = 0.059;
  CHECK(share("one_motion_share", {sweep}) == doctest::Approx(2 / 5.0));
  CHECK(share("one_motion_share", {sweep, over_force(1, 2, {1, 1}, {1, 2})}) == doctest::Approx(3 / 7.0));
}

TEST_CASE("points of a map with one impact on each wall in a period are counted, equally spaced or not") {
  BasinResponse map;
  map.basin.attractors = {{.period = 1, .impacts = {1, 1}, .symmetric = true, .points = 5},
                          {.period = 1, .impacts = {1, 1}, .symmetric = false, .points = 2},
                          {.period = 1, .impacts = {2, 2}, .symmetric = true, .points = 1},
                          {.period = 3, .impacts = {1, 1}, .symmetric = true, .points = 1},
                          {.period = 1, .impacts = {1, 0}, .symmetric = false, .points = 1},
                          {.period = 1, .impacts = {1, 1}, .symmetric = true, .points = 3},
                          {.idle = true, .symmetric = true, .points = 4}};
  map.basin.attractor.assign(20, undecided);
  CHECK(share("two_impact_share", {map}) == doctest::Approx(8 / 20.0));
  CHECK(share("equally_spaced_share", {map}) == doctest::Approx(8 / 10.0));
}

TEST_CASE("two impacts in a period are held against the power of the closed form") {
  // Undamped, M13.18.
  SweepResponse sweep;
  sweep.scene.damper().mass_ratio = 0.1;
  sweep.scene.damper().restitution = 0.5;
  sweep.scene.force_amplitude = 0.08;
  sweep.axis = {&Scene::force_frequency, 0.9, 1, 3};
  const auto powers = [](double omega) {
    const double m = 0.1, e = 0.5, b = (1 - e) / (1 + e), c = 0.08 / (1 - omega * omega);
    const double a = pi / omega + 2 * m * std::tan(pi / (2 * omega)), q = b * (1 + m) / omega;
    const double square = a * a + 4 * q * q, root = std::sqrt(a * a - square * (1 - 4 * c * c));
    std::vector<double> found;
    for (const double v : {(a + root) / square, (a - root) / square}) {
      if (v < 0) continue;
      const double w = v * (1 + b) * (1 + m);
      found.push_back(omega / (2 * pi) * m / (1 + m) * (1 - e * e) * w * w);
    }
    return found;
  };
  const auto two_impacts = [](double power) {
    SteadyState state = steady(1);
    state.period = 1;
    state.impacts = {1, 1};
    state.symmetric = true;
    state.means->impact_power = power;
    return state;
  };
  SteadyState unequal = two_impacts(7), more = two_impacts(7), longer = two_impacts(7), open = two_impacts(7);
  unequal.symmetric = false;
  more.impacts = {2, 2};
  longer.period = 3;
  open.period.reset();
  REQUIRE(powers(0.9).size() == 2);
  const double at_090 = powers(0.9)[0], at_095 = powers(0.95)[0], slow_at_090 = powers(0.9)[1];
  // At 1 there is no closed form.
  sweep.sweeps = {{.up = {two_impacts(1.01 * at_090), two_impacts(0.96 * at_095), two_impacts(7)},
                   .down = {two_impacts(slow_at_090), unequal, two_impacts(7)}},
                  {.up = {more, longer, open}, .down = {open, open, open}}};
  CHECK(share("two_impact_error", {sweep}) == doctest::Approx(0.04));
  sweep.sweeps[0].down[0] = two_impacts(1.05 * slow_at_090);
  CHECK(share("two_impact_error", {sweep}) == doctest::Approx(0.05));
  sweep.sweeps.erase(sweep.sweeps.begin());
  CHECK(std::isnan(share("two_impact_error", {sweep})));
}
