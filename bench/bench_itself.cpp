// What the bench's figures rest on besides the clock: counts, references, errors, spreads. What it concludes
// from its measurements: errors of chaotic decays, times at an error, orders, results. And what the peers are
// built on.
#include <doctest/doctest.h>

#include <cmath>

#include "counted.hpp"
#include "findings.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/simulate.hpp"
#include "peers/hybrid_system.hpp"
#include "peers/several_dampers.hpp"
#include "reference.hpp"
#include "rows.hpp"
#include "timing.hpp"

using namespace impact_damper;
using namespace impact_damper::bench;
using doctest::Approx;

namespace {

const Scene tiny{.x0 = 4.5, .until_time = 20};
// Half a free oscillation, the secondary mass far from both walls.
const Scene free_flight{.x0 = 0.1, .until_time = 4, .dampers = {{.y0 = 0.5}}};

std::vector<double> amplitudes(const Scene& scene, const Engine& engine) {
  return simulate(scene, engine, {.half_cycles = true}).half_cycles->amplitude;
}

// A curve of made-up points: setting, error, reference operations.
struct Made {
  double setting;
  std::optional<double> error;
  double time;
};
Curve curve_of(const std::string& scene, const std::string& contender, const std::vector<Made>& points) {
  Curve curve{.scene = scene, .contender = contender};
  for (const Made& made : points) {
    Point point{.setting = made.setting, .impacts = 100, .error = made.error};
    point.timing.reference_operations = {made.time, made.time, made.time};
    curve.points.push_back(point);
  }
  return curve;
}

const Result& find(const std::vector<Result>& results, const std::string& what) {
  for (const Result& result : results) {
    if (result.what.find(what) != std::string::npos) return result;
  }
  FAIL("no result " << what);
  return results[0];
}

}  // namespace

TEST_CASE("a counted run is, bit for bit, the run in double") {
  CHECK(count(tiny, Exact{}).amplitude == amplitudes(tiny, Exact{}));
  CHECK(count(tiny, Restitution{}).amplitude == amplitudes(tiny, Restitution{}));
}

TEST_CASE("counts are one run's own") {
  const CountedRun first = count(tiny, Exact{});
  count(free_flight, Restitution{});
  const CountedRun second = count(tiny, Exact{});
  CHECK(first.counts.evaluations == second.counts.evaluations);
  CHECK(first.counts.sincos == second.counts.sincos);
  CHECK(first.counts.divisions == second.counts.divisions);
}

TEST_CASE("without damping flights cost sines and cosines, exponentials are the wall's damper's") {
  const CountedRun rigid = count(tiny, Restitution{}), compliant = count(tiny, Exact{});
  CHECK(rigid.counts.sincos > 0);
  CHECK(rigid.counts.exponentials == 0);
  CHECK(compliant.counts.exponentials > 0);
}

TEST_CASE("each flight begins with a prediction, and few need a search") {
  const CountedRun run = count(tiny, Exact{});
  const auto contacts = simulate(tiny, Exact{}, {.impacts = true});
  CHECK(run.impacts == std::int64_t(contacts.impacts->time.size()));
  CHECK(run.impacts > 0);
  CHECK(run.counts.predictions >= run.impacts);
  CHECK(run.counts.predictions < 2 * run.impacts);
  CHECK(run.counts.evaluations > 0);
  CHECK(run.counts.searches < run.impacts / 2);
  // Each flight and each contact ends in one way, but for the run's last.
  const auto& [series, correction, search, map, slow_mode, contact_search] = run.counts.found;
  CHECK(series + correction + search >= run.impacts);
  CHECK(series + correction + search <= run.impacts + 1);
  CHECK(map + slow_mode + contact_search == run.impacts);
}

TEST_CASE(
    "a flight that meets no wall is one search for walls, and a closed form for each zero and each turn") {
  // cos(t) to t = 4: a zero at pi/2, a turn at pi. Before the zero no turn is found, after it one. Two angles
  // more are each oscillator's own, once a scene.
  const CountedRun run = count(free_flight, Restitution{});
  CHECK(run.impacts == 0);
  CHECK(run.amplitude == std::vector<double>{0.1});
  CHECK(run.counts.searches == 1);
  CHECK(run.counts.steps > 0);
  CHECK(run.counts.arctangents == 3 + 2);
}

TEST_CASE("the reference and long double agree where double is seen to differ") {
  // Impacts amplify rounding errors. Two of the last bits of an amplitude of 4.5, 2^-50, are the recorder's.
  const std::vector<double> reference = reference_amplitudes(tiny, Exact{});
  const double last_bits = 0x1p-49;
  if (reference_scalar() != "long double") {
    CHECK(*amplitude_error(long_double_amplitudes(tiny, Exact{}), reference) <= last_bits);
  }
  Scene longer = tiny;  // a few impacts may leave no error at all
  longer.until_time = 100;
  const double error = *amplitude_error(amplitudes(longer, Exact{}), reference_amplitudes(longer, Exact{}));
  CHECK(error > 0);
  CHECK(error < 1e-11);
  CHECK(*amplitude_error(amplitudes(tiny, Restitution{}), reference_amplitudes(tiny, Restitution{})) < 1e-11);
}

TEST_CASE("several dampers have their reference, too") {
  Scene several = tiny;
  several.dampers = {{.mass_ratio = 0.01}, {.mass_ratio = 0.01, .clearance = 1.5, .y0 = 0.5}};
  CHECK(*amplitude_error(amplitudes(several, Exact{}), reference_amplitudes(several, Exact{})) < 1e-11);
  CHECK(*amplitude_error(amplitudes(several, Restitution{}), reference_amplitudes(several, Restitution{})) <
        1e-11);
  CHECK(*amplitude_error(amplitudes(several, Exact{}), reference_amplitudes(tiny, Exact{})) > 1e-6);
}

TEST_CASE("the error is the largest difference of a row, and one row more or less is none") {
  CHECK(*amplitude_error({3, 2, 1}, {3, 2.25, 1.125}) == 0.25);
  CHECK(*amplitude_error({3, 2}, {3, 2, 1}) == 0);
  CHECK(*amplitude_error({3, 2, 1}, {3, 2}) == 0);
  CHECK(!amplitude_error({3}, {3, 2, 1}));
  CHECK(!amplitude_error({}, {}));
  CHECK(!amplitude_error({}, {3}));
  CHECK(!amplitude_error({3, NAN, 1}, {3, 2, 1}));
}

TEST_CASE("a spread is the median and the quartiles of a sample in any order") {
  const bench::Spread spread = bench::spread_of({9, 1, 8, 2, 7, 3, 6, 4, 5});
  CHECK(spread.lower == 3);
  CHECK(spread.median == 5);
  CHECK(spread.upper == 7);
}

TEST_CASE("a time is by as many repeats as asked for, each of as many runs as it says") {
  int runs = 0;
  const Timing timing = measure([&] { ++runs; }, 5, 1.0);
  CHECK(timing.repeats == 5);
  CHECK(timing.runs == 1);
  CHECK(runs == 5);
  CHECK(timing.undisturbed >= 0);
  CHECK(timing.undisturbed <= 5);
  CHECK(timing.seconds.lower <= timing.seconds.median);
  CHECK(timing.seconds.median <= timing.seconds.upper);
}

TEST_CASE("the time for an error lies on the straight line between two settings, in both logarithms") {
  const Curve curve = curve_of("S1", "peer", {{1, 1e-4, 100}, {0.1, std::nullopt, 1}, {0.01, 1e-8, 1e4}});
  CHECK(*time_at(curve, 1e-6) == Approx(1000));
  CHECK(*time_at(curve, 1e-5) == Approx(100 * std::sqrt(10)));
  CHECK(*time_at(curve, 1e-8) == Approx(1e4));
}

TEST_CASE("nothing is extrapolated: not below the smallest error, not before the coarsest setting") {
  const Curve curve = curve_of("S1", "peer", {{1, 1e-4, 100}, {0.1, 1e-8, 1e4}});
  CHECK(!time_at(curve, 1e-9));
  CHECK(*time_at(curve, 1e-2) == 100);
  CHECK(!time_at(curve_of("S1", "peer", {{1, std::nullopt, 5}}), 1));
}

TEST_CASE("a finer setting that is worse by chance does not undo a coarser one") {
  const Curve curve = curve_of("S1", "peer", {{1, 1e-2, 1}, {0.1, 1e-6, 10}, {0.01, 1e-5, 100}});
  CHECK(*time_at(curve, 1e-6) == Approx(10));
}

TEST_CASE("a time for good is from where on the error stays below, whatever a coarse setting met by chance") {
  const Curve curve =
      curve_of("S3", "peer", {{1, 1e-2, 1}, {0.1, 1e-4, 10}, {0.01, 1e-2, 100}, {1e-3, 1e-4, 1e4}});
  CHECK(*time_at(curve, 1e-3) == Approx(std::sqrt(10)));
  CHECK(*time_for_good(curve, 1e-3) == Approx(1000));
  CHECK(*time_for_good(curve, 1e-2) == 1);
  CHECK(!time_for_good(curve, 1e-5));
  CHECK(!time_for_good(curve_of("S3", "peer", {{1, 1e-4, 1}, {0.1, 1e-2, 10}}), 1e-3));
}

TEST_CASE("the observed order of a power law is its exponent, errors above the bound left out") {
  std::vector<Made> points{{1, 0.5, 1}};
  for (double h = 0.5; h > 0.05; h /= 2) points.push_back({h, 3e-3 * h * h, 1});
  const Curve curve = curve_of("S3", "cem", points);
  CHECK(observed_order(curve, 1e-3)->slope == Approx(2));
  CHECK(observed_order(curve, 1e-3)->uncertainty == Approx(0));
  CHECK(observed_order(curve, 1e-3)->points == 4);
  CHECK(observed_order(curve, 1)->slope > 2.5);
  CHECK(observed_order(curve, 1)->uncertainty > 0.1);
  CHECK(!observed_order(curve, 5e-4));  // three are left
}

TEST_CASE("the loss curve of a viscous decay is twice the damping ratio everywhere") {
  // Peaks a half period apart; the parabola's bias is 89/30 (zeta p)^2 (loss_factor.hpp).
  const double zeta = 0.01, p = 3.14159265358979, bias = 1 + 89.0 / 30 * (zeta * p) * (zeta * p);
  std::vector<double> time, amplitude;
  for (int i = 0; i < 300; ++i) {
    time.push_back(i * p);
    amplitude.push_back(6 * std::exp(-zeta * time.back()));
  }
  const auto curve = loss_curve(time, amplitude);
  REQUIRE(curve);
  for (const double eta : *curve) CHECK(eta == Approx(2 * zeta * bias).epsilon(1e-5));
  // Rows end five peaks before the last: at 0.089 with 140 peaks, at 0.12 with 130.
  const auto ends_after = [&](std::size_t peaks) {
    return loss_curve({time.begin(), time.begin() + std::ptrdiff_t(peaks)},
                      {amplitude.begin(), amplitude.begin() + std::ptrdiff_t(peaks)});
  };
  CHECK(ends_after(140));
  CHECK(!ends_after(130));
}

TEST_CASE("the error of a loss curve is its relative distance from the mean") {
  const EnsembleCurve ensemble{.mean = {1, 2, 4}};
  CHECK(curve_error(ensemble, {1, 2, 4}) == 0);
  CHECK(curve_error(ensemble, {1.01, 2.02, 4.04}) == Approx(0.01));
  CHECK(curve_error(ensemble, {1.03, 2, 4}) == Approx(0.03 / std::sqrt(3)));
}

TEST_CASE("another restitution shows in the loss curve far beyond the scatter, other releases do not") {
  const Scene decay{.x0 = 6, .until_amplitude = 0.03};
  const EnsembleCurve ensemble = ensemble_curve(decay, Exact{});
  CHECK(ensemble.scatter.lower > 0);
  CHECK(ensemble.scatter_limit() < 0.003);
  const auto error_of = [&](double e) {
    Scene other = decay;
    other.damper().restitution = e;
    std::vector<std::vector<double>> curves;
    for (const Scene& release : ensemble_of(other, {.members = releases, .seed = 3})) {
      const Run run = simulate(release, Exact{}, {.half_cycles = true});
      curves.push_back(*loss_curve(run.half_cycles->peak_time, run.half_cycles->amplitude));
    }
    return curve_error(ensemble, mean_curve(curves));
  };
  CHECK(error_of(0.6) < ensemble.scatter_limit());
  CHECK(error_of(0.595) > 2 * ensemble.scatter_limit());
}

TEST_CASE("rows are kept as the recorder keeps them") {
  RowBook book(2, 0.5);
  book.peak(0.1, 1.5);  // lower than the release
  CHECK(!book.zero_crossing(1));
  book.peak(2, -1);
  book.peak(2.5, -1.25);
  CHECK(!book.zero_crossing(3));
  book.impact();
  book.peak(4, 0.4);
  CHECK(book.zero_crossing(5));
  const Rows rows = book.finish();
  CHECK(rows.zero_crossing == std::vector<double>{1, 3, 5});
  CHECK(rows.peak_time == std::vector<double>{0, 2.5, 4});
  CHECK(rows.amplitude == std::vector<double>{2, 1.25, 0.4});
  CHECK(rows.impacts == 1);
}

TEST_CASE("the peers' rigid wall keeps momentum and restores e") {
  const Scene scene{.dampers = {{.mass_ratio = 0.3, .restitution = 0.7}}};
  HybridSystem<double> system(scene, Walls::rigid);
  HybridSystem<double>::State u{0.5, -0.25, -1e-12, -2};
  const double momentum = 1.3 * u[1] + 0.3 * u[3];
  CHECK(system.pass(0, u, 0));
  CHECK(u[3] == Approx(1.4));
  CHECK(1.3 * u[1] + 0.3 * u[3] == Approx(momentum));
  CHECK(u[2] == 0);
  CHECK(system.regime() == Regime::free);
}

TEST_CASE("the peers' compliant wall gives back e of the speed to a mass that moves no other") {
  for (const double e : {0.0, 0.3, 0.6, 1.0}) {
    // Runge and Kutta's fourth order through one contact, 1000 steps: h^4 is far below the tolerance.
    const Scene scene{.dampers = {{.mass_ratio = 1e-12, .restitution = e, .wall_stiffness = 1e-2}}};
    HybridSystem<double> system(scene, Walls::compliant);
    HybridSystem<double>::State u{0, 0, 0, -1};
    system.pass(0, u, 0);
    const double h = system.contact_time() / 1000;
    const auto moved = [](auto from, const auto& by, double t) {
      for (std::size_t i = 0; i < from.size(); ++i) from[i] += t * by[i];
      return from;
    };
    double last = 0;
    for (int step = 0; step < 20'000 && u[2] <= 0; ++step) {
      HybridSystem<double>::State a{}, b{}, c{}, d{};
      system.derivative(u, a, 0);
      system.derivative(moved(u, a, h / 2), b, 0);
      system.derivative(moved(u, b, h / 2), c, 0);
      system.derivative(moved(u, c, h), d, 0);
      u = moved(moved(moved(moved(u, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
      last = u[3];
    }
    // Within a step of its release the speed changes by c w h at most, c h = 2 zeta_m pi / 1000.
    CHECK(last == Approx(e).epsilon(0.01));
    CHECK((u[2] > 0) == (e > 0));
  }
}

TEST_CASE("a list of one damper is, for the peers, the one damper") {
  const Scene one{.damping_ratio = 0.1, .dampers = {{.mass_ratio = 0.3, .restitution = 0.7, .y0 = 0.5}}};
  Scene list = one;
  list.dampers = {{.mass_ratio = 0.3, .restitution = 0.7, .y0 = 0.5}};
  for (const Walls walls : {Walls::compliant, Walls::rigid}) {
    for (const std::size_t guard : {0, 1}) {
      HybridSystem<double> system(one, walls);
      SeveralDampers<double, 1> same(list, walls);
      CHECK(same.state == system.state);
      const auto check_rates = [&](const std::array<double, 4>& u) {
        std::array<double, 4> du{}, same_du{};
        system.derivative(u, du, 0);
        same.derivative(u, same_du, 0);
        for (std::size_t i = 0; i < 4; ++i) CHECK(same_du[i] == Approx(du[i]));
        for (std::size_t i = 0; i < 4; ++i) {
          CHECK(same.event(i, u, 0) == system.event(i, u, 0));
          if (system.flies(0) || i != 1)
            CHECK(same.event_rate(i, u, 0) == Approx(system.event_rate(i, u, 0)));
        }
      };
      std::array<double, 4> u{0.5, -0.25, double(guard), guard == 0 ? -2.0 : 2.0}, same_u = u;
      check_rates(u);
      CHECK(system.pass(guard, u, 0));
      CHECK(same.pass(guard, same_u, 0));
      for (std::size_t i = 0; i < 4; ++i) CHECK(same_u[i] == Approx(u[i]));
      check_rates({0.5, -0.25, guard == 0 ? -1e-3 : 1.001, -0.1});
    }
  }
}

TEST_CASE("one of the peers' several dampers impinges without moving the others") {
  const Scene scene{.dampers = {{.mass_ratio = 0.1, .restitution = 0.7, .y0 = 0.5},
                                {.mass_ratio = 0.2, .restitution = 0.4, .clearance = 2, .y0 = 0.5}}};
  SeveralDampers<double, 2> system(scene, Walls::rigid);
  std::array<double, 6> u{0.5, -0.25, 0.3, 1, 2, 3}, before = u;
  CHECK(system.pass(3, u, 0));
  CHECK(u[5] == Approx(-0.4 * 3));
  CHECK(1.3 * u[1] + 0.1 * u[3] + 0.2 * u[5] == Approx(1.3 * before[1] + 0.1 * before[3] + 0.2 * before[5]));
  CHECK(u[1] + u[3] == Approx(before[1] + before[3]));
  CHECK(u[2] == before[2]);
}

TEST_CASE("on S9 no mass comes to rest on a wall, and few contacts overlap") {
  int lists = 0;
  for (const BenchScene& scene : bench_scenes()) {
    if (has_one_damper(scene.scene)) continue;
    ++lists;
    CHECK(scene.dampers == int(scene.scene.dampers.size()));
    if (scene.walls == Walls::rigid) {
      CHECK(simulate(scene.scene, Restitution{}, {.contacts = true}).contacts->begin.empty());
      continue;
    }
    const Contacts contacts = *simulate(scene.scene, Exact{}, {.contacts = true}).contacts;
    std::vector<double> begin = contacts.begin, end = contacts.end;
    for (std::size_t i = 0; i < begin.size(); ++i) CHECK(end[i] - begin[i] < 1e-4);
    std::ranges::sort(begin);
    std::ranges::sort(end);
    std::size_t overlap = 0;
    for (std::size_t i = 1; i < begin.size(); ++i) overlap += begin[i] < end[i - 1];
    CHECK(100 * overlap < begin.size());
  }
  CHECK(lists == 8);
}

TEST_CASE("S9 is run by those who take lists, and without a list by our engines") {
  const Contender peer{.name = "peer", .several = true}, other{.name = "other"};
  for (const BenchScene& scene : bench_scenes()) {
    if (scene.dampers == 0 || scene.walls == Walls::rigid) continue;
    CHECK(takes_part(peer, false, scene) == !has_one_damper(scene.scene));
    CHECK(takes_part(peer, true, scene));
    CHECK(!takes_part(other, false, scene));
    CHECK(!takes_part(other, true, scene));
  }
}

TEST_CASE("plain central differences come nearer to the exact engine with the first power of their step") {
  const Contender plain = central_differences_peers()[0];
  const std::vector<double> reference = reference_amplitudes(tiny, Exact{});
  const auto error_at = [&](double step) {
    return *amplitude_error(plain.run(tiny, step).amplitude, reference);
  };
  CHECK(error_at(2e-5) < 1e-3);
  CHECK(error_at(2e-6) < error_at(1e-4) / 5);
  Scene other = tiny;
  other.damper().restitution = 0.55;
  CHECK(*amplitude_error(plain.run(other, 2e-6).amplitude, reference) > 10 * error_at(2e-6));
}

TEST_CASE("all engines run a scene to within their settings' errors of the reference") {
  for (const Contender& engine : engines()) {
    const auto reference = engine.walls == Walls::rigid ? reference_amplitudes(tiny, Restitution{})
                                                        : reference_amplitudes(tiny, Exact{});
    const std::vector<double> settings = engine.settings(tiny);
    const double setting = settings[settings.size() / 2];
    const double error = *amplitude_error(engine.run(tiny, setting).amplitude, reference);
    CAPTURE(engine.name);
    CHECK(error < (engine.setting.empty() ? 1e-11 : 1e-2));
  }
}

TEST_CASE("amplitudes are compared up to the scene's time and no further") {
  BenchScene scene{.name = "S7", .scene = tiny, .compared_until = 10};
  const auto rows_of = [](double shift_before, double shift_after) {
    return [=](const Scene& part, double) {
      Rows rows;
      const Run run = simulate(part, Exact{}, {.half_cycles = true});
      for (std::size_t i = 0; i < run.half_cycles->amplitude.size(); ++i) {
        const bool before = run.half_cycles->peak_time[i] < 5;
        rows.amplitude.push_back(run.half_cycles->amplitude[i] + (before ? shift_before : shift_after));
      }
      return rows;
    };
  };
  const auto error_of = [&](double shift_before, double shift_after) {
    const Contender contender{.name = "shifted",
                              .settings = [](const Scene&) { return std::vector<double>{0}; },
                              .run = rows_of(shift_before, shift_after)};
    const Reference reference = reference_of(scene, Walls::compliant);
    const Told silent{[](const std::string&) {}, [](const Curve&, const Point&) {}};
    return *measure_curve(scene, contender, true, reference, Limits{.repeats = 1}, silent).points.at(0).error;
  };
  CHECK(error_of(0.5, 0) == Approx(0.5));
  CHECK(error_of(0, 0.5) == Approx(0.5));
  scene.compared_until = 4;  // the first half cycle only
  CHECK(error_of(0, 0.5) < 1e-12);
}

TEST_CASE("all figures of the catalogue that need no more than runs are made") {
  const FigureSet set = measure_figure_set(IMPACT_DAMPER_SOURCE, 1);
  CHECK(set.scenes == 8);
  CHECK(set.tables == 15);  // of the paper's figures
  CHECK(set.bytes > 100000);
  CHECK(set.timing.seconds.median > 0);
}

TEST_CASE("a very fast force is held against a slow one by its periods") {
  Findings found;
  for (const BenchScene& scene : bench_scenes()) {
    if (!scene.name.starts_with("S8")) continue;
    found.scenes.push_back(scene);
    found.curves.push_back(curve_of(scene.name, "exact", {{0, 1e-13, 3000}}));
  }
  REQUIRE(found.scenes.size() == 3);
  // 100 impacts each: 30 operations an impact. At 50 t / 2 pi = 159.2 periods: 18.85 operations each.
  const Scene& fast = found.scenes.back().scene;
  REQUIRE(*fast.until_time * fast.force_frequency == 1000);
  CHECK(*find(results_of(found), "time per impact, at 50").measured ==
        Approx(30 / (3000 * 2 * std::acos(-1.0) / 1000)));
}

TEST_CASE("a peer that does not reach the error has no ratio, and how far it came is said") {
  Findings found;
  found.curves.push_back(curve_of("S1", "exact", {{0, 1e-13, 10}}));
  found.curves.push_back(curve_of("S1", "CVODE", {{1, 1e-3, 100}, {0.1, 7e-5, 1000}}));
  const std::vector<Result> results = results_of(found);
  const Result& cvode = find(results, "against CVODE");
  CHECK(!cvode.measured);
  CHECK(!cvode.within());
  CHECK(cvode.note.find("never below 7e-05") != std::string::npos);
  CHECK(find(results, "error on S1").within());
  CHECK(!find(results, "error on S3").within());
}

TEST_CASE("an impact with several dampers may cost 20 ns more for each further one") {
  Findings found{.scenes = bench_scenes()};
  found.reference_operation = {2e-8, 2e-8, 2e-8};
  found.curves.push_back(curve_of("S9 5", "exact", {{0, 1e-13, 1500}}));
  CHECK(damper_costs(found, "exact").empty());
  found.curves.push_back(curve_of("S9 20", "exact", {{0, 1e-13, 1500}}));
  found.curves.push_back(curve_of("S9 one", "exact", {{0, 1e-13, 1000}}));  // 100 impacts: 200 ns each
  const std::vector<Result> results = results_of(found);
  const Result& five = find(results, "exact: time per impact on S9, list of 5");
  CHECK(five.bound == Approx(200 + 4 * 20));
  CHECK(*five.measured == Approx(300));
  CHECK(!five.within());
  CHECK(find(results, "exact: time per impact on S9, list of 20").within());
}

TEST_CASE("what a component costs is held against its bound") {
  Findings found;
  found.components = {{"exact", "friction", 1.5, {1.3, 1.4, 1.6}, {2.6, 2.8, 3.2}},
                      {"exact", "drag", 3, {3, 3.2, 3.3}, {3, 3.2, 3.3}}};
  const std::vector<Result> results = results_of(found);
  const Result& friction = find(results, "exact: time per event with friction");
  CHECK(*friction.measured == 1.4);
  CHECK(friction.note == "quartiles 1.3 to 1.6; per impact 2.8");
  CHECK(friction.within());
  CHECK(!find(results, "exact: time per event with drag").within());
}

TEST_CASE("the best of two peers is what an engine is held against") {
  Findings found;
  found.curves.push_back(curve_of("S1", "exact", {{0, 1e-13, 10}}));
  found.curves.push_back(curve_of("S1", "odeint fehlberg78", {{1, 1e-8, 100}, {0.1, 1e-10, 1000}}));
  found.curves.push_back(curve_of("S1", "odeint dopri5", {{1, 1e-9, 150}}));
  const std::vector<Result> results = results_of(found);
  const Result& odeint = find(results, "odeint at 1e-9, S1");
  CHECK(*odeint.measured == Approx(15));
  CHECK(odeint.note == "odeint dopri5");
  CHECK(odeint.within());
}

TEST_CASE(
    "two rates are held against the paper's fixed step at the smallest error above the sampling scatter") {
  Findings found;
  found.references.push_back(
      {.scene = "S5", .loss_curve = EnsembleCurve{.scatter = {.upper = 1e-3}}});  // scatter: 2e-3
  found.curves.push_back(curve_of("S5", "cem", {{1, 1e-2, 100}, {0.1, 1e-3, 1000}}));
  found.curves.push_back(curve_of("S5", "cem located", {{1, 1e-3, 300}}));
  found.curves.push_back(curve_of("S5", "cem two rates", {{1, 1e-2, 1}, {0.1, 2e-3, 40}}));
  found.curves.push_back(curve_of("S5", "cem located two rates", {{1, 1e-3, 20}}));
  const std::vector<Result> results = results_of(found);
  const Result& rates = find(results, "two rates");
  // log(1e-2 / 2e-3) / log(1e-2 / 1e-3) of the way from 100 to 1000: 500.
  CHECK(*rates.measured == Approx(500.0 / 20));
  CHECK(rates.note.find("located two rates, at an error of 0.002") != std::string::npos);
  CHECK(rates.note.find("cem located 15.0 x") != std::string::npos);
}

TEST_CASE("a decay that records nothing asks for no memory, one that records does") {
  for (const Allocations& counted : count_allocations()) {
    CHECK(counted.impacts > 1000);
    CHECK(counted.quiet == 0);
    CHECK(counted.recorded > 0);
  }
}
