// Sensitivity: how a perturbation grows along the decays that the figures are made from.
//
// The motion is looked at where x crosses zero: its state there is (v, y, w), and a half cycle maps it onto
// the next. Each half cycle of a decay is run again from its own state and from one that is off by 1e-9, and
// the logarithm of what the distance has grown by is that half cycle's exponent; the perturbation's direction
// is handed on, its length set back to 1e-9 (Benettin's way: a length that neither rounding nor curvature can
// turn by much). Two perturbations are followed:
//
//   in full               v, y and w. Its sum is what becomes of a last bit: the amplitude, which nothing
//                         brings back, never forgets, so regular motion has an exponent of about zero.
//   at equal amplitude    y and w alone, v set right after each half cycle: does the secondary mass forget
//                         how it came to this amplitude? Below zero, a curve over A can be trusted point by
//                         point; above, only on average. Where the mass sticks it forgets to the last bit.
//
// Held against: free flight (no growth); one impact per half cycle with nu -> 0, in closed form; area in the
// plane of y and w, which every impact shrinks by e^2; and two whole runs side by side.
//
// One impact per half cycle. Leaving one wall at t0 with the absolute speed V, the mass meets the other,
// which is 1 + x(t1) - x(t0) away, at t1 = t0 + pi, and leaves it with (1 + e) v(t1) - e V = -V. Varied:
//     (V - v1) dt1 = (V - v0) dt0 - pi dV,   dV1 = (1 + e) x''(t1) dt1 - e dV,
// with v1 = -v0 = -b V; so dt1 = e dt0 - g dV, g = pi (1 + e) / (2 V), and, mirrored, dV1 = (1 + e) A
// cos(theta) dt1 + e dV. Hence determinant e^2 and trace 2 e - (1 + e) A cos(theta) g, in any coordinates.
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "engines/observed.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "stress.hpp"

namespace stress {

using namespace impact_damper;

namespace {

using Section = std::array<double, 3>;  // v, y, w where x crosses zero

struct HalfCycle {
  double end = 0, amplitude = 0;
  Section state{};  // at its end
};

// An observer that reads off the state at every zero crossing.
class Crossings : public TestObserver<double> {
 public:
  bool wants_half_cycles() const override { return true; }
  void half_cycle(double, double end, double, double amplitude) override {
    rows.push_back({end, amplitude, {}});
  }
  // Several crossings may lie in one motion, all told of before the first sample is asked for.
  double next_sample() const override {
    return sampled_ < rows.size() ? rows[sampled_].end : std::numeric_limits<double>::infinity();
  }
  void sample(double, double, double v, double y, double w) override { rows[sampled_++].state = {v, y, w}; }

  std::vector<HalfCycle> rows;

 private:
  std::size_t sampled_ = 0;
};

std::vector<HalfCycle> half_cycles_of(const Scene& scene, const Exact& options = {}) {
  Crossings crossings;
  observed(scene, options, crossings);
  return crossings.rows;
}

// Where a half cycle takes a state.
Section next(Scene scene, const Section& from) {
  scene.x0 = 0, scene.v0 = from[0], scene.damper().y0 = from[1], scene.damper().w0 = from[2];
  scene.until_time = 1e3;
  scene.until_amplitude.reset();
  const std::vector<HalfCycle> rows = half_cycles_of(scene, {.budget = {.max_half_cycles = 1}});
  if (rows.empty()) throw std::runtime_error("sensitivity: a half cycle without end");
  return rows.front().state;
}

double length(const Section& d) { return std::hypot(d[0], d[1], d[2]); }
Section difference(const Section& a, const Section& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

constexpr double perturbation = 1e-12;  // of a release
constexpr double renormalised = 1e-9;   // of a half cycle

// One half cycle's exponent for the perturbation in `direction`, which is handed on.
double exponent(const Scene& scene, const Section& from, Section& direction, bool equal_amplitude) {
  if (equal_amplitude) direction[0] = 0;
  const double size = length(direction);
  Section beside = from;
  for (std::size_t i = 0; i < 3; ++i) beside[i] += renormalised * (size > 0 ? direction[i] / size : i == 1);
  const Section before = difference(beside, from);  // as rounded
  Section after = difference(next(scene, beside), next(scene, from));
  if (equal_amplitude) after[0] = 0;
  // Nothing left: forgotten to the last bit.
  const double rest = std::max(length(after), std::numeric_limits<double>::epsilon());
  if (length(after) > 0) direction = after;
  return std::log(rest / length(before));
}

struct Exponents {
  std::vector<double> amplitude, full, at_equal_amplitude;  // by half cycle, from the second on
};

Exponents exponents_of(const Scene& scene, const std::vector<HalfCycle>& rows, Section direction) {
  Exponents result;
  Section at_equal{0, 1, 0};
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    result.amplitude.push_back(rows[i + 1].amplitude);
    result.full.push_back(exponent(scene, rows[i].state, direction, false));
    result.at_equal_amplitude.push_back(exponent(scene, rows[i].state, at_equal, true));
  }
  return result;
}

Check about(const std::string& what, const std::string& allowed) {
  return {.subject = "sensitivity", .what = what, .measured = {}, .allowed = allowed};
}
void decide(Check& check, double error, double allowed, const std::string& which) {
  ++check.cases;
  if (!(error <= allowed)) check.miss(which + ": " + rounded(error, 4));
}

Check free_flight() {
  Check check =
      about("free flight: a perturbation neither grows nor shrinks, exponent per half cycle", "1e-3");
  const Scene scene{.x0 = 0.2, .until_time = 1000, .dampers = {{.y0 = 0.3}}};
  const std::vector<HalfCycle> rows = half_cycles_of(scene);
  Worst worst;
  for (const Section& direction : {Section{1, 0, -1}, Section{0, 1, 0}}) {  // those in which nothing drifts
    const std::vector<double> full = exponents_of(scene, rows, direction).full;
    const double mean = std::accumulate(full.begin(), full.end(), 0.0) / double(full.size());
    worst.take(std::abs(mean));
    decide(check, std::abs(mean), 1e-3, "direction " + rounded(direction[0]));
  }
  check.measured = rounded(worst);
  return check;
}

// Trace and determinant of the half cycle's map of (y, w), mirrored, by central differences.
std::array<double, 2> trace_and_determinant(const Scene& scene, const Section& at) {
  constexpr double h = 1e-6;
  std::array<std::array<double, 2>, 2> m{};
  for (std::size_t j = 0; j < 2; ++j) {
    Section up = at, down = at;
    up[j + 1] += h, down[j + 1] -= h;
    const Section change = difference(next(scene, up), next(scene, down));
    for (std::size_t i = 0; i < 2; ++i) m[i][j] = -change[i + 1] / (up[j + 1] - down[j + 1]);
  }
  return {m[0][0] + m[1][1], m[0][0] * m[1][1] - m[0][1] * m[1][0]};
}

std::vector<Check> one_impact() {
  Check trace =
      about("one impact per half cycle: trace of the half cycle's map, closed form at nu -> 0", "1e-3");
  Check area = about("the same: its determinant, e^2", "1e-3");
  Worst worst_trace, worst_area;
  for (const double e : {0.4, 0.6, 0.8}) {
    for (const double part : {0.3, 0.6, 0.9}) {  // of the way from the fold to where equal spacing is lost
      const double amplitude = fold_amplitude(e) + part * (equal_spacing_amplitude(e) - fold_amplitude(e));
      const auto motion = single_impact(e, amplitude);
      if (!motion) continue;
      // Left at the phase at which the closed form leaves the left wall, with its speed; then settled.
      const double b = (1 - e) / (1 + e), v = motion->speed;
      const double x = -(std::numbers::pi * v - 1) / 2;  // A cos(theta) of the other wall, mirrored
      const Scene scene{
          .x0 = x,
          .v0 = b * v,
          .until_time = 500,
          .dampers = {
              {.mass_ratio = 1e-9, .restitution = e, .wall_stiffness = 1e6, .y0 = 0, .w0 = v - b * v}}};
      const Section settled = half_cycles_of(scene).back().state;
      const auto [t, d] = trace_and_determinant(scene, settled);
      const double expected = 2 * e + (1 + e) * (1 + e) * std::numbers::pi * x / (2 * v);
      worst_trace.take(std::abs(t - expected));
      worst_area.take(std::abs(d - e * e));
      const std::string which = "e = " + rounded(e) + ", A = " + rounded(amplitude, 4);
      decide(trace, std::abs(t - expected), 1e-3, which);
      decide(area, std::abs(d - e * e), 1e-3, which);
    }
  }
  trace.measured = rounded(worst_trace);
  area.measured = rounded(worst_area);
  return {trace, area};
}

// Two whole runs, released 1e-12 apart, against the sum of the exponents: until either is 1e-6.
Check side_by_side(const Scene& scene, const std::string& name) {
  Check check =
      about(name + ": two runs released 1e-12 apart against the sum of exponents, in decades", "0.1");
  Scene shifted = scene;
  shifted.x0 *= 1 + perturbation;
  const std::vector<HalfCycle> one = half_cycles_of(scene), other = half_cycles_of(shifted);
  const Section first = difference(other[0].state, one[0].state);
  const Exponents exponents = exponents_of(scene, one, first);
  double sum = std::log(length(first));
  Worst worst;
  for (std::size_t i = 0; i + 1 < std::min(one.size(), other.size()); ++i) {
    sum += exponents.full[i];
    const double apart = length(difference(other[i + 1].state, one[i + 1].state));
    if (apart > 1e-6 || sum > std::log(1e-6)) break;
    const double error = std::abs(std::log(apart) - sum) / std::log(10.0);
    worst.take(error);
    decide(check, error, 0.1,
           "half cycle " + std::to_string(i + 1) + ", A = " + rounded(one[i + 1].amplitude, 4));
  }
  check.measured = rounded(worst);
  return check;
}

// Equal bins of the amplitude, finer below 0.6.
std::size_t bin_of(double amplitude) {
  return amplitude < 0.6 ? std::size_t(amplitude / 0.01) : 60 + std::size_t((amplitude - 0.6) / 0.05);
}
double middle_of(std::size_t bin) {
  return bin < 60 ? (double(bin) + 0.5) * 0.01 : 0.6 + (double(bin - 60) + 0.5) * 0.05;
}
constexpr std::size_t bins = 60 + 108;  // up to A = 6

struct Followed {
  std::string name;
  Scene scene;
  std::vector<Exponents> members;
};

// What a perturbation of 1e-12 at the release has grown to; for ever, once it is as large as the motion.
double lost_below(const Exponents& exponents, std::string* table = nullptr) {
  double decades = -12, lost = 0;
  for (std::size_t i = 0; i < exponents.full.size(); ++i) {
    decades = std::min(decades + exponents.full[i] / std::log(10.0), 0.0);
    if (table) *table += rounded(exponents.amplitude[i], 6) + " " + rounded(decades, 5) + "\n";
    if (decades > -3 && lost == 0) lost = exponents.amplitude[i];
    if (decades == 0) break;
  }
  return lost;
}

std::string table_of(const Followed& followed) {
  struct Bin {
    double full = 0, equal = 0;
    int count = 0;
  };
  std::vector<Bin> all(bins);
  for (const Exponents& member : followed.members) {
    for (std::size_t i = 0; i < member.amplitude.size(); ++i) {
      const std::size_t bin = bin_of(member.amplitude[i]);
      if (bin >= bins) continue;
      all[bin].full += member.full[i];
      all[bin].equal += member.at_equal_amplitude[i];
      ++all[bin].count;
    }
  }
  std::string text = "\n\n# exponents-" + followed.name + "\namplitude full equal_amplitude half_cycles\n";
  for (std::size_t b = 0; b < bins; ++b)
    if (all[b].count > 0)
      text += rounded(middle_of(b), 6) + " " + rounded(all[b].full / all[b].count, 5) + " " +
              rounded(all[b].equal / all[b].count, 5) + " " + std::to_string(all[b].count) + "\n";
  text += "\n\n# growth-" + followed.name + "\namplitude decades\n";
  lost_below(followed.members.front(), &text);
  text += "\n\n# windows-" + followed.name + "\nimpacts upper lower\n";
  const Run run = simulate(followed.scene, Exact{}, {.impacts = true, .contacts = true});
  const std::vector<RegularWindow> windows = regular_windows(run);
  for (std::int64_t impacts = 1; impacts <= 6; ++impacts)
    if (const auto window = longest_window(windows, impacts))
      text +=
          std::to_string(impacts) + " " + rounded(window->upper, 6) + " " + rounded(window->lower, 6) + "\n";
  text += "\n\n# impacts-" + followed.name + "\namplitude phase_deg\n";
  for (std::size_t i = 0; i < run.impacts->time.size(); ++i)
    if (run.impacts->phase_deg[i] && run.impacts->amplitude[i])
      text += rounded(*run.impacts->amplitude[i], 5) + " " + rounded(*run.impacts->phase_deg[i], 5) + "\n";
  return text;
}

std::string amplitude_text(double lost) { return lost > 0 ? rounded(lost, 3) : "never"; }

}  // namespace

std::vector<Check> sensitivity(const Options& options) {
  std::vector<Check> checks{free_flight()};
  for (const Check& check : one_impact()) checks.push_back(check);

  std::vector<std::string> names{"nu2-e06", "nu1-e06",        "nu4-e06",        "nu2-e04",
                                 "nu2-e08", "nu2-e06-zeta02", "nu2-e06-zeta04", "nu2-e06-zeta08"};
  if (options.brief) names.resize(1);
  const EnsembleOptions ensemble{.members = options.brief ? 1 : 16};
  std::vector<Followed> all;
  for (const std::string& name : names) {
    const Scene scene = read_scene(options.scene_folder / (name + ".json"));
    all.push_back({name, scene, std::vector<Exponents>(std::size_t(ensemble.members))});
  }
  Progress progress("sensitivity");
  std::atomic<std::int64_t> done{0};
  const std::int64_t runs = std::int64_t(all.size()) * ensemble.members;
  std::mutex mutex;
  for_each_index(runs, {}, [&](std::int64_t i) {
    Followed& followed = all[std::size_t(i / ensemble.members)];
    const std::size_t member = std::size_t(i % ensemble.members);
    const Scene scene = ensemble_of(followed.scene, ensemble)[member];
    followed.members[member] = exponents_of(scene, half_cycles_of(scene), {1, 0, 0});
    ++done;
    const std::lock_guard lock(mutex);
    progress.tell(done, runs);
  });

  std::string table =
      "# Growth of a perturbation per half cycle: means over bins of the amplitude, and one decay's sum.\n"
      "# Parameters: above: ν = 0.02, e = 0.6, ζ = 0, k = 10^4, means over " +
      std::to_string(ensemble.members) + " releases; below: all scenes of the figures\n";
  for (const Followed& followed : all) {
    checks.push_back(side_by_side(followed.scene, followed.name));
    table += table_of(followed);
    std::vector<double> lost;
    for (const Exponents& member : followed.members) lost.push_back(lost_below(member));
    const Spread spread = spread_of(lost);
    Check check =
        about(followed.name + ": 1e-12 has grown to 1e-3 at this amplitude (median, extremes)", "-");
    check.cases = std::int64_t(lost.size());
    check.measured = amplitude_text(spread.median) + " (" + amplitude_text(spread.low) + " to " +
                     amplitude_text(spread.high) + ")";
    checks.push_back(check);
  }
  write_file(options.folder / "sensitivity.dat", table);
  return checks;
}

}  // namespace stress
