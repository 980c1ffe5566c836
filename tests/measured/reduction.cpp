// Against records of the viscous oscillator x = A exp(-zeta t) cos(w t), whose peaks and loss factor are
// known.
#include "application/measured/reduction.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace {

constexpr double hertz = 4, omega = 2 * std::numbers::pi * hertz, zeta = 0.01, largest = 20, rate = 203;

struct Made {
  double noise = 0, duration = 15;
  MeasuredQuantity quantity = MeasuredQuantity::displacement;
  double time_factor = 1;
  double samples_per_second = rate;
  std::function<double(double, double)> changed = [](double, double x) { return x; };  // of t, x
  std::function<bool(double)> missing = [](double) { return false; };
};
// x = A exp(-zeta omega t) cos(omega t - 1): the record begins anywhere in a cycle.
double displacement(double t) { return largest * std::exp(-zeta * omega * t) * std::cos(omega * t - 1); }
MeasuredRecord made(const Made& m) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  MeasuredRecord record;
  record.quantity = m.quantity;
  for (int i = 0; i < int(m.duration * m.samples_per_second); ++i) {
    const double t = i / m.samples_per_second;
    // Each derivative is one times i omega - zeta omega; of it the real part.
    const double phase = omega * t - 1, decay = largest * std::exp(-zeta * omega * t);
    const double x =
        m.quantity == MeasuredQuantity::displacement ? displacement(t)
        : m.quantity == MeasuredQuantity::velocity
            ? -decay * omega * (std::sin(phase) + zeta * std::cos(phase))
            : decay * omega * omega * ((zeta * zeta - 1) * std::cos(phase) + 2 * zeta * std::sin(phase));
    const double value = m.changed(t, x + m.noise * normal(random));
    if (m.missing(t)) continue;
    record.time.push_back(t * m.time_factor);
    record.value.push_back(value);
  }
  return record;
}
Reduction reduction_of(const MeasuredRecord& record, double frequency = hertz) {
  return reduced("r", record, frequency);
}
// cos(omega t - 1) exp(...) has its peaks where tan(omega t - 1) = -zeta: atan(zeta) before those of the
// cosine.
double peak_time(std::int64_t n) { return (1 - std::atan(zeta) + double(n) * std::numbers::pi) / omega; }
double peak(double t) { return largest * std::exp(-zeta * omega * t) / std::sqrt(1 + zeta * zeta); }
std::int64_t nearest_peak(double t) { return std::lround((t * omega - 1) / std::numbers::pi); }
double nearest_height(double t) { return peak(peak_time(nearest_peak(t))); }

// Of the loss factor (M12.1), per radian of the record's own frequency: the largest relative error.
double loss_error(const Reduction& r) {
  HalfCycles rows;
  for (const double each : r.time) rows.peak_time.push_back(each * 2 * std::numbers::pi * r.frequency);
  rows.amplitude = r.amplitude;
  const LossFactor loss = local_loss_factor(rows, 0, r.time.size());
  double worst = 0;
  for (const double each : loss.eta) worst = std::max(worst, std::abs(each / (2 * zeta) - 1));
  return worst;
}

}  // namespace

TEST_CASE("times and heights of peaks, frequency and loss factor are those of the oscillator") {
  const Reduction r = reduction_of(made({}));
  CHECK(r.frequency == doctest::Approx(hertz).epsilon(1e-5));
  CHECK(r.clipped + r.unclear == 0);
  REQUIRE(r.time.size() > 100);
  for (std::size_t i = 0; i < r.time.size(); ++i) {
    const double t = peak_time(nearest_peak(r.time[i]));
    // A shift of all peaks by one sample is 5e-3 s. The fit's sinusoid does not decay: of the order of
    // zeta^2.
    CHECK(std::abs(r.time[i] - t) < 2e-4);
    CHECK(std::abs(r.amplitude[i] / peak(t) - 1) < 1e-3);
  }
  CHECK(loss_error(r) < 1e-2);
}

TEST_CASE("offset and drift are taken out, and the noise is estimated") {
  constexpr double noise = 0.1;
  const auto level = [](double t) { return 7 + 3 * std::sin(2 * std::numbers::pi * t / 15); };
  const Reduction r =
      reduction_of(made({.noise = noise, .changed = [&](double t, double x) { return x + level(t); }}));
  double mean = 0;
  for (const double t : r.time) mean += level(t) / double(r.time.size());
  CHECK(r.noise == doctest::Approx(noise).epsilon(0.1));
  CHECK(std::abs(r.offset - mean) < 0.05);
  CHECK(r.drift == doctest::Approx(6).epsilon(0.1));
  REQUIRE(r.time.size() > 60);
  double squares = 0;
  for (std::size_t i = 0; i < r.time.size(); ++i) {
    const double deviation = (r.amplitude[i] - nearest_height(r.time[i])) / r.error[i];
    squares += deviation * deviation / double(r.time.size());
  }
  // Deviations in units of the error that is stated; five standard errors of the mean of 60 squares are 0.9.
  CHECK(squares > 0.4);
  CHECK(squares < 1.9);
  CHECK(r.ends_in_noise);
}

TEST_CASE("half cycles that the instrument clipped are left out, sharply or softly clipped") {
  const auto clip = [](double, double x) { return std::min(15.0, std::max(-1000.0, x)); };
  const Reduction sharp = reduction_of(made({.noise = 0.02, .changed = clip}));
  // Maxima above 15: peaks 0, 2, ... while 20 exp(-zeta omega t) > 15, t < 1.145 s, n < 8.8: 0, 2, 4, 6, 8.
  CHECK(sharp.clipped >= 5);
  CHECK(sharp.clipped <= 6);  // the maximum just below may go with them
  // Two maxima, 19.8 and 18.6, cut off so little that they are not flat.
  CHECK(reduction_of(made({.noise = 0.02, .changed = [](double, double x) { return std::min(18.2, x); }}))
            .clipped == 2);
  std::mt19937 random(9);
  std::normal_distribution<double> normal(0, 0.02);
  const Reduction soft =
      reduction_of(made({.changed = [&](double t, double x) { return clip(t, x) + normal(random); }}));
  // Those just below the limit go with them.
  CHECK(soft.clipped >= 5);
  CHECK(soft.clipped <= 8);
  for (const Reduction* r : {&sharp, &soft})
    for (std::size_t i = 0; i < r->time.size(); ++i)
      CHECK(std::abs(r->amplitude[i] / nearest_height(r->time[i]) - 1) <
            0.04 + 5 * r->error[i] / r->amplitude[i]);
}

TEST_CASE("missing samples cost their half cycles alone, and half cycles are counted across a gap") {
  const Reduction whole = reduction_of(made({.noise = 0.02}));
  const Reduction gap =
      reduction_of(made({.noise = 0.02, .missing = [](double t) { return t > 2 && t < 4; }}));
  // 16 half cycles lie in the gap, and the windows at its ends reach into it.
  CHECK(whole.time.size() - gap.time.size() >= 16);
  CHECK(whole.time.size() - gap.time.size() <= 18);
  CHECK(gap.in_gaps - whole.in_gaps == std::int64_t(whole.time.size() - gap.time.size()));
  for (const Reduction* r : {&whole, &gap})
    for (std::size_t i = 0; i < r->time.size(); ++i) {
      CHECK(r->half_cycle[i] - r->half_cycle[0] == nearest_peak(r->time[i]) - nearest_peak(r->time[0]));
      CHECK(std::abs(r->amplitude[i] / nearest_height(r->time[i]) - 1) <
            6 * r->error[i] / r->amplitude[i] + 1e-3);
    }
  CHECK(gap.frequency == doctest::Approx(hertz).epsilon(3e-4));  // of the last peak, 0.03 rad of 112 pi
  int n = 0;
  const Reduction scattered =
      reduction_of(made({.noise = 0.02, .missing = [&](double) { return ++n % 11 == 0; }}));
  CHECK(scattered.time.size() + 2 >= whole.time.size());
}

TEST_CASE("a long gap in which the amplitude falls to a tenth does not end the search") {
  const Reduction r = reduction_of(made({.missing = [](double t) { return t > 1 && t < 10; }}));
  CHECK(r.time.back() > 14);
}

TEST_CASE("a wrong sampling rate is a wrong frequency, and changes no loss factor") {
  const Reduction r = reduction_of(made({.time_factor = 0.8}));
  CHECK(r.frequency == doctest::Approx(hertz / 0.8).epsilon(1e-5));
  CHECK(loss_error(r) < 1e-2);
}

TEST_CASE(
    "of a record with more in it than one decay the largest fall is used, and what is left out is said") {
  const auto said = [](const Reduction& r) {
    std::string text;
    for (const std::string& each : r.outside) text += each + "\n";
    return text;
  };
  const auto is_the_decay = [&](const Reduction& r, double from, double to, double since) {
    CHECK(r.time.front() >= from);
    CHECK(r.time.front() < from + 1.5 / hertz);
    CHECK(r.time.back() > to - 1.5 / hertz);
    CHECK(r.time.back() <= to);
    for (std::size_t i = 0; i < r.time.size(); ++i)
      CHECK(std::abs(r.amplitude[i] / peak(r.time[i] - since) - 1) < 0.01);
    CHECK(loss_error(r) < 0.02);
  };
  // Rocked up for 4 s and let go.
  const auto up = [](double t, double x) {
    return t < 4 ? x / std::exp(-zeta * omega * t) * t / 4 : x / std::exp(-zeta * omega * 4);
  };
  const Reduction rocked = reduction_of(made({.changed = up}));
  CHECK(said(rocked).find(" s the amplitude rises, by a factor of ") != std::string::npos);
  is_the_decay(rocked, 4 - 0.5 / hertz, 15, 4);
  CHECK(rocked.other_time.size() > 10);
  CHECK(rocked.other_time.back() < rocked.time.front());
  // Silence for 3 s, with noise.
  const Reduction late = reduction_of(
      made({.noise = 1e-4, .changed = [](double t, double x) { return t < 3 ? x - displacement(t) : x; }}));
  CHECK(said(late) == "");
  is_the_decay(late, 3, 15, 0);
  // Struck again at 5 s.
  const auto twice = [](double t, double x) { return t < 5 ? x : x / std::exp(-zeta * omega * 5); };
  const Reduction second = reduction_of(made({.changed = twice}));
  CHECK(said(second).find("Before 4.91 s there is another decay, by a factor of 3.") == 0);
  is_the_decay(second, 5, 15, 5);
  // The same, the first fall the larger one.
  const auto weakly = [](double t, double x) { return t < 11 ? x : 3 * x; };
  const Reduction first = reduction_of(made({.changed = weakly}));
  CHECK(said(first).find("Behind 1") == 0);
  CHECK(said(first).find("the amplitude rises again, by a factor of 3.") != std::string::npos);
  is_the_decay(first, 0, 11, 0);
  CHECK(first.other_time.front() > first.time.back());
  // What the secondary mass gives back to a primary one that hardly moves is no other hit.
  for (int i = 0; i < 20; ++i) {
    const Scene scene{.damping_ratio = 0.0033,
                      .x0 = 4.7,
                      .until_time = 600,
                      .dampers = {{.mass_ratio = 0.08, .restitution = 0.75, .y0 = 0.05 * i}}};
    const Run run = simulate(scene, Restitution{}, {.history = {{0, 600, 6001}}});
    const MeasuredRecord record{.time = run.history->time, .value = run.history->x};
    CHECK(said(reduction_of(record)) == "");
  }
  // Growing all the time.
  CHECK_THROWS_WITH_AS(
      reduction_of(made({.changed = [](double t, double x) { return x * std::exp(2 * zeta * omega * t); }})),
      doctest::Contains("r: must hold a free decay of at least 12 half cycles"), InputError);
  // A whole decay is used from its first half cycle to its last.
  CHECK(reduction_of(made({})).outside.empty());
  CHECK(reduction_of(made({})).other_time.empty());
}

TEST_CASE("zeros in place of samples are missing samples") {
  const Reduction r =
      reduction_of(made({.changed = [](double t, double x) { return t > 3 && t < 3.7 ? 0 : x; }}));
  REQUIRE(r.outside.size() == 1);
  CHECK(r.outside[0].find("142 samples have the value of the one before them") == 0);
  CHECK(r.in_gaps > 4);
  CHECK(loss_error(r) < 1e-2);
  // A value that an instrument cannot exceed is no missing sample.
  const Reduction clipped =
      reduction_of(made({.changed = [](double, double x) { return std::min(5.0, std::max(-1000.0, x)); }}));
  CHECK(clipped.outside.empty());
}

constexpr std::array derivatives{MeasuredQuantity::velocity, MeasuredQuantity::acceleration};
double amplitude_at(double t) { return largest * std::exp(-zeta * omega * t); }

TEST_CASE("velocities and accelerations are integrated, whatever frequency the scene has") {
  for (const MeasuredQuantity quantity : derivatives) {
    for (const double samples : {90.0, 203.0, 5e4}) {
      const MeasuredRecord record = made({.quantity = quantity, .samples_per_second = samples});
      for (const double factor : {0.3, 1.0, 3.0}) {
        const Reduction r = reduction_of(record, factor * hertz);
        CHECK(r.samples == std::int64_t(record.time.size()));
        CHECK(std::abs(r.sampling_rate / samples - 1) < 1e-9);
        CHECK(r.time.size() > 110);
        for (std::size_t i = 0; i < r.time.size(); ++i)
          CHECK(std::abs(r.amplitude[i] / amplitude_at(r.time[i]) - 1) < 2e-3);
      }
    }
  }
}

TEST_CASE("amplitudes of velocities and accelerations err by what their noise lets expect") {
  for (const MeasuredQuantity quantity : derivatives) {
    for (const double samples : {90.0, 2e3}) {
      const double noise = 0.002 * largest * omega * std::sqrt(samples / 90) *
                           (quantity == MeasuredQuantity::velocity ? 1 : omega);
      const Reduction r =
          reduction_of(made({.noise = noise, .quantity = quantity, .samples_per_second = samples}));
      REQUIRE(r.time.size() > 90);
      double squares = 0;
      for (std::size_t i = 0; i < r.time.size(); ++i) {
        const double off = (r.amplitude[i] - amplitude_at(r.time[i])) / r.error[i];
        squares += off * off / double(r.time.size());
      }
      CHECK(std::sqrt(squares) > 0.7);
      CHECK(std::sqrt(squares) < 1.1);
    }
  }
}

TEST_CASE("an accelerometer that rings at impacts, or has an offset, drifts and misses samples") {
  const auto rings = [](double t, double x) {
    // Three times as strong as the oscillation at its largest, for some hundredths of a second in each cycle.
    const double since = std::fmod(t, 1 / hertz);
    return x +
           3 * largest * omega * omega * std::exp(-since / 0.01) *
               std::sin(2 * std::numbers::pi * 700 * since) +
           1e4 * (1 + t / 15);
  };
  const Reduction r = reduction_of(made({.quantity = MeasuredQuantity::acceleration,
                                         .samples_per_second = 2e4,
                                         .changed = rings,
                                         .missing = [](double t) { return t > 3 && t < 3.1; }}));
  REQUIRE(r.time.size() > 80);
  CHECK(r.in_gaps > 3);
  for (std::size_t i = 0; i < r.time.size(); ++i)
    CHECK(std::abs(r.amplitude[i] - amplitude_at(r.time[i])) < 0.005 * largest);
}

TEST_CASE("spikes, of impacts or of the instrument, are neither peaks nor amplitudes") {
  int n = 0;
  const Reduction r = reduction_of(
      made({.noise = 0.02, .changed = [&](double, double x) { return ++n % 37 == 0 ? x + 30 : x; }}));
  REQUIRE(r.time.size() > 90);
  for (std::size_t i = 0; i < r.time.size(); ++i)
    CHECK(std::abs(r.amplitude[i] - nearest_height(r.time[i])) < 6 * r.error[i] + 0.03);
}

TEST_CASE("a record without a decay, or with too few samples in a cycle, is rejected") {
  CHECK_THROWS_WITH_AS(
      reduction_of(made({.duration = 1})),
      doctest::Contains("r: must hold a free decay of at least 12 half cycles above the noise, got"),
      InputError);
  CHECK_THROWS_WITH_AS(reduction_of(made({.noise = 30})), doctest::Contains("r: must hold a free decay"),
                       InputError);
  CHECK_THROWS_WITH_AS(reduction_of(made({.samples_per_second = 40})),
                       doctest::Contains("r: must have at least 20 samples in a cycle, got"), InputError);
  CHECK_THROWS_WITH_AS(reduction_of({}), "r: must have at least 64 samples, got 0", InputError);
}
