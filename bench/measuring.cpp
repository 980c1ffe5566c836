// What the bench's figures rest on besides the clock: counts, references, errors, spreads.
#include <doctest/doctest.h>

#include <cmath>

#include "counted.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "timing.hpp"

using namespace impact_damper;
using namespace impact_damper::bench;

namespace {

const Scene tiny{.x0 = 4.5, .until_time = 20};
// Half a free oscillation, the secondary mass far from both walls.
const Scene free_flight{.x0 = 0.1, .until_time = 4, .dampers = {{.y0 = 0.5}}};

std::vector<double> amplitudes(const Scene& scene, const Engine& engine) {
  return simulate(scene, engine, {.half_cycles = true}).half_cycles->amplitude;
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
