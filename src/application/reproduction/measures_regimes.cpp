// Measures on the sequence of impacts: bounce-down, regular windows, impact failure, phases.
#include <algorithm>
#include <cmath>

#include "application/reproduction/measures.hpp"
#include "application/reproduction/measures_parts.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

const Impacts& impacts_of(const Run& run) {
  if (!run.impacts) throw std::invalid_argument("impacts: the run did not record them");
  return *run.impacts;
}

// The first row below `amplitude` and `count` rows from there on, [first, last); empty if there are fewer.
struct Rows {
  std::size_t first = 0, last = 0;
};
Rows rows_below(const Run& run, const MeasureCall& call) {
  const auto first = first_row_below(half_cycles_of(run), number(call, "amplitude"));
  const std::size_t count = static_cast<std::size_t>(number(call, "half_cycles"));
  if (!first || *first + count > run.half_cycles->amplitude.size()) return {};
  return {*first, *first + count};
}

std::vector<std::size_t> rows_between(const Run& run, double from, double to) {
  std::vector<std::size_t> rows;
  const auto& amplitude = half_cycles_of(run).amplitude;
  for (std::size_t row = 1; row < amplitude.size(); ++row)
    if (amplitude[row] >= from && amplitude[row] <= to) rows.push_back(row);
  return rows;
}

std::size_t row_of(const Run& run, double time) {
  const auto& crossing = half_cycles_of(run).zero_crossing;
  return static_cast<std::size_t>(std::upper_bound(crossing.begin(), crossing.end(), time) -
                                  crossing.begin());
}

double mean_impacts(const Run& run, const Rows& rows) {
  double sum = 0;
  for (std::size_t row = rows.first; row < rows.last; ++row)
    sum += static_cast<double>(run.half_cycles->impacts[row]);
  return sum / static_cast<double>(rows.last - rows.first);
}

std::vector<bool> sticks(const Run& run, const RegimeOptions& regimes) {
  std::vector<bool> rows(half_cycles_of(run).amplitude.size(), false);
  const Contacts stuck = stuck_contacts(run, regimes);
  for (std::size_t i = 0; i < stuck.begin.size(); ++i)
    for (std::size_t row = row_of(run, stuck.begin[i]); row < rows.size(); ++row) {
      if (row > 0 && run.half_cycles->zero_crossing[row - 1] >= stuck.end[i]) break;
      rows[row] = true;
    }
  return rows;
}

Spread bounce_down_end(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    if (const auto end = end_of_bounce_down(run, runs.analysis().regimes)) return end->amplitude;
    // No series of stuck half cycles has come to an end: either one still goes on or there was none.
    return sticks(run, runs.analysis().regimes).back() ? run.half_cycles->amplitude.back()
                                                       : run.half_cycles->amplitude.front();
  });
}

double amplitude_or_nan(const std::optional<HalfCycleRow>& half_cycle) {
  return half_cycle ? half_cycle->amplitude : std::nan("");
}

Spread first_missed(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    return amplitude_or_nan(impact_failure(run, runs.analysis().regimes).first_missed);
  });
}

Spread failure_for_good(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    return amplitude_or_nan(impact_failure(run, runs.analysis().regimes).for_good);
  });
}

Spread first_missed_ratio(Runs& runs, const MeasureCall& call) {
  return over_groups(runs, call, [&](const std::vector<const Run*>& group) {
    return amplitude_or_nan(impact_failure(*group[0], runs.analysis().regimes).first_missed) /
           amplitude_or_nan(impact_failure(*group[1], runs.analysis().regimes).first_missed);
  });
}

// Applies `find` to the regular window of a given number of impacts that lies nearest to an amplitude.
// Infinite if there is none: unlike NaN, that keeps the median over the other members.
template <class Find>
Spread of_nearest_window(Runs& runs, const MeasureCall& call, Find find) {
  const double amplitude = number(call, "amplitude");
  return over_members(runs, call, [&](const Run& run) {
    double least = infinity, found = infinity;
    for (const RegularWindow& window : regular_windows(run, runs.analysis().regimes)) {
      if (static_cast<double>(window.impacts) != number(call, "impacts")) continue;
      const double distance = std::max({0.0, amplitude - window.upper, window.lower - amplitude});
      if (!(distance < least)) continue;
      least = distance;
      found = find(window);
    }
    return found;
  });
}
Spread window_nearest(Runs& runs, const MeasureCall& call) {
  const double amplitude = number(call, "amplitude");
  return of_nearest_window(runs, call, [amplitude](const RegularWindow& window) {
    return std::min(window.upper, std::max(window.lower, amplitude));
  });
}
Spread window_upper(Runs& runs, const MeasureCall& call) {
  return of_nearest_window(runs, call, [](const RegularWindow& window) { return window.upper; });
}
Spread window_lower(Runs& runs, const MeasureCall& call) {
  return of_nearest_window(runs, call, [](const RegularWindow& window) { return window.lower; });
}

Spread windows_in_order(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const std::vector<RegularWindow> windows = regular_windows(run, runs.analysis().regimes);
    double found = 0, below = infinity;
    for (std::int64_t count = static_cast<std::int64_t>(number(call, "most")); count >= 1; --count) {
      const auto window = longest_window(windows, count);
      if (!window || !(window->upper < below)) break;
      below = window->lower;
      ++found;
    }
    return found;
  });
}

Spread mixed_gaps(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const std::vector<RegularWindow> windows = regular_windows(run, runs.analysis().regimes);
    double gaps = 0;
    for (std::int64_t count = static_cast<std::int64_t>(number(call, "most")); count >= 2; --count) {
      const auto above = longest_window(windows, count), below = longest_window(windows, count - 1);
      // Between two adjoining windows one half cycle may belong to neither.
      if (above && below && below->first > above->last + 2) ++gaps;
    }
    return gaps;
  });
}

Spread impacts_per_half_cycle(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) { return mean_impacts(run, rows_below(run, call)); });
}

Spread rows_with_impacts(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const Rows rows = rows_below(run, call);
    double share = 0;
    for (std::size_t row = rows.first; row < rows.last; ++row)
      share += static_cast<double>(run.half_cycles->impacts[row]) == number(call, "impacts");
    return share / static_cast<double>(rows.last - rows.first);
  });
}

// Returns how the number of impacts in a half cycle that ends stuck grows as e approaches 1: the exponent of
// 1/(1 - e) by least squares over e = 0.4, 0.6, 0.8 and 0.9. Each is released at 1.1 times the amplitude
// above which its bounces end; at a fixed amplitude no half cycle would end stuck beyond some e. NaN if a
// scene, as one with a heavy secondary mass, has too few half cycles in that time.
Spread stuck_impacts_growth(Runs& runs, const MeasureCall& call) {
  const Run& base = runs.file(call.scenes.front());
  constexpr double above = 1.1;
  constexpr std::size_t half_cycles = 5;
  Curve growth;
  for (const double e : {0.4, 0.6, 0.8, 0.9}) {
    Scene scene = base.scene;
    scene.damper().restitution = e;
    scene.x0 = above * impact_damper::bounce_down_end(e);
    scene.until_amplitude.reset();
    scene.until_time = double(half_cycles + 1) * half_turn<double>();
    const Run run = runs.simulated(scene, base.engine, Record{});
    if (half_cycles_of(run).amplitude.size() <= half_cycles) return once(std::nan(""));
    growth.x.push_back(1 / (1 - e));
    growth.y.push_back(mean_impacts(run, {1, 1 + half_cycles}));
  }
  return once(log_slope(growth));
}

Spread bounce_down_closed_form(Runs&, const MeasureCall& call) {
  const double e = number(call, "restitution");
  return once(e <= 0.95 ? impact_damper::bounce_down_end(e) : std::nan(""));
}

Spread stuck_share(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const std::vector<bool> stuck = sticks(run, runs.analysis().regimes);
    double count = 0;
    const std::vector<std::size_t> rows = rows_between(run, number(call, "from"), number(call, "to"));
    for (const std::size_t row : rows) count += stuck[row];
    return count / static_cast<double>(rows.size());
  });
}

Spread longest_stuck_series(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    double longest = 0, series = 0;
    for (const bool stuck : sticks(run, runs.analysis().regimes)) {
      series = stuck ? series + 1 : 0;
      longest = std::max(longest, series);
    }
    return longest;
  });
}

Spread alternation(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const auto& impacts = half_cycles_of(run).impacts;
    double pairs = 0, alternating = 0;
    for (const std::size_t row : rows_between(run, number(call, "from"), number(call, "to"))) {
      if (row == 0) continue;
      ++pairs;
      alternating += std::min(impacts[row - 1], impacts[row]) == 1 && impacts[row - 1] + impacts[row] == 3;
    }
    return alternating / pairs;
  });
}

Spread phase_difference(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const Rows rows = rows_below(run, call);
    const Impacts& impacts = impacts_of(run);
    std::vector<double> phase;
    for (std::size_t i = 0; i < impacts.time.size(); ++i) {
      const std::size_t row = row_of(run, impacts.time[i]);
      if (row >= rows.first && row < rows.last && impacts.phase_deg[i])
        phase.push_back(*impacts.phase_deg[i]);
    }
    if (phase.size() != rows.last - rows.first || phase.size() < 2) return std::nan("");
    double sum = 0;
    for (std::size_t i = 1; i < phase.size(); ++i) sum += std::abs(phase[i] - phase[i - 1]);
    return sum / static_cast<double>(phase.size() - 1);
  });
}

// Returns the slope against amplitude by least squares: degrees of the half cycle per unit of amplitude.
double slope(const Curve& curve) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const double x = curve.x[i], y = curve.y[i];
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

Spread stuck_degrees_slope(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const StuckPhases stuck = stuck_phases(run, runs.analysis().regimes);
    Curve curve;
    for (std::size_t i = 0; i < stuck.amplitude.size(); ++i) {
      const bool within =
          stuck.amplitude[i] >= number(call, "from") && stuck.amplitude[i] <= number(call, "to");
      // The mass is released slightly after the zero crossing: the remnant at the start belongs to the half
      // cycle before.
      if (!within || stuck.begin_deg[i] <= 0) continue;
      curve.x.push_back(stuck.amplitude[i]);
      curve.y.push_back(stuck.end_deg[i] - stuck.begin_deg[i]);
    }
    return slope(curve);
  });
}

Spread bounce_down_degrees_slope(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const Impacts& impacts = impacts_of(run);
    Curve curve;
    for (const std::size_t row : rows_between(run, number(call, "from"), number(call, "to"))) {
      std::optional<double> first, last;
      for (std::size_t i = 0; i < impacts.time.size(); ++i) {
        if (row_of(run, impacts.time[i]) != row || !impacts.phase_deg[i]) continue;
        if (!first) first = impacts.phase_deg[i];
        last = impacts.phase_deg[i];
      }
      if (!first) continue;
      curve.x.push_back(run.half_cycles->amplitude[row]);
      curve.y.push_back(*last - *first);
    }
    return slope(curve);
  });
}

double farthest_from(double centre, const std::vector<double>& values) {
  return *std::ranges::max_element(values, [centre](double one, double other) {
    return std::abs(one - centre) < std::abs(other - centre);
  });
}

// Applies `find` to each scene and returns the number that is farthest from `centre`.
template <class Find>
Spread farthest_over_scenes(Runs& runs, const MeasureCall& call, double centre, Find find) {
  return over_groups(runs, call, [&](const std::vector<const Run*>& group) {
    std::vector<double> found;
    for (const Run* run : group) {
      found.push_back(find(*run));
      if (std::isnan(found.back())) return found.back();
    }
    return farthest_from(centre, found);
  });
}

Spread first_amplitude(Runs& runs, const MeasureCall& call) {
  return farthest_over_scenes(runs, call, number(call, "amplitude"), [](const Run& run) {
    const std::vector<double>& amplitude = half_cycles_of(run).amplitude;
    return amplitude.empty() ? std::nan("") : amplitude.front();
  });
}

Spread first_impact_place(Runs& runs, const MeasureCall& call) {
  return farthest_over_scenes(runs, call, number(call, "amplitude"), [](const Run& run) {
    const Impacts& impacts = impacts_of(run);
    if (impacts.time.empty()) return std::nan("");
    return impacts.displacement.front() + (impacts.wall.front() == Wall::right ? 1 : 0);
  });
}

// An impact at the relative speed w dissipates nu (1 - e^2) w^2 / (2 (1 + nu)); without viscous damping
// nothing else is lost between the first amplitude and the last.
Spread impact_loss_error(Runs& runs, const MeasureCall& call) {
  return farthest_over_scenes(runs, call, 0, [](const Run& run) {
    const double nu = run.scene.damper().mass_ratio, e = run.scene.damper().restitution;
    double squares = 0;
    for (const double w : impacts_of(run).relative_velocity) squares += w * w;
    const double lost = nu * (1 - e * e) / (2 * (1 + nu)) * squares;
    const std::vector<double>& amplitude = half_cycles_of(run).amplitude;
    const double first = amplitude.front(), last = amplitude.back();
    return lost / ((first * first - last * last) / 2) - 1;
  });
}

// Returns the slope of ln (speed of the half cycle's fastest impact divided by A^power) against ln A.
Spread impact_speed_slope(Runs& runs, const MeasureCall& call) {
  return over_members(runs, call, [&](const Run& run) {
    const Impacts& impacts = impacts_of(run);
    const auto& amplitude = half_cycles_of(run).amplitude;
    std::vector<double> fastest(amplitude.size(), 0);
    for (std::size_t i = 0; i < impacts.time.size(); ++i) {
      const std::size_t row = row_of(run, impacts.time[i]);
      if (row < fastest.size()) fastest[row] = std::max(fastest[row], std::abs(impacts.relative_velocity[i]));
    }
    Curve curve;
    for (const std::size_t row : rows_between(run, number(call, "from"), number(call, "to"))) {
      if (!(fastest[row] > 0)) continue;
      curve.x.push_back(amplitude[row]);
      curve.y.push_back(fastest[row] * exponential(-number(call, "power") * logarithm(amplitude[row])));
    }
    return log_slope(curve);
  });
}

}  // namespace

std::vector<Measure> regime_measures() {
  return {
      {"bounce_down_end", bounce_down_end,
       "amplitude at the end of bounce-down; the release's if nothing ever sticks"},
      {"first_missed", first_missed, "amplitude at the first missed impact"},
      {"first_missed_ratio", first_missed_ratio, "that of the first scene, divided by the second's",
       numbers(), scenes(2, 2)},
      {"failure_for_good", failure_for_good, "amplitude from which on impacts are missed for good"},
      {"window_nearest", window_nearest,
       "amplitude of a regular window of so many impacts that is nearest to the given one, which it is "
       "inside a window; infinite if there is none",
       numbers("impacts", "amplitude")},
      {"window_upper", window_upper, "amplitude at which that window begins",
       numbers("impacts", "amplitude")},
      {"window_lower", window_lower, "amplitude at which it ends", numbers("impacts", "amplitude")},
      {"windows_in_order", windows_in_order,
       "how many regular windows, of most, most - 1, ... 1 impacts, follow each other down in amplitude",
       numbers("most")},
      {"mixed_gaps", mixed_gaps, "how many pairs of neighbours among them leave a gap of mixed counts",
       numbers("most")},
      {"impacts_per_half_cycle", impacts_per_half_cycle,
       "mean number of impacts in so many half cycles from the first below an amplitude on",
       numbers("amplitude", "half_cycles")},
      {"rows_with_impacts", rows_with_impacts, "share of these half cycles with just so many impacts",
       numbers("amplitude", "half_cycles", "impacts")},
      {"stuck_impacts_growth", stuck_impacts_growth,
       "power of 1/(1 - e) as which the impacts in a half cycle that ends stuck become more"},
      {"bounce_down_closed_form", bounce_down_closed_form,
       "amplitude at the end of bounce-down, closed form for nu -> 0 and e <= 0.95", numbers("restitution"),
       scenes(0, 0)},
      {"longest_stuck_series", longest_stuck_series,
       "most half cycles in succession in which the mass sticks to a wall"},
      {"stuck_share", stuck_share, "share of the half cycles in which the mass sticks",
       numbers("from", "to")},
      {"alternation", alternation,
       "share of the half cycles that, with the one before, have one and two impacts in turn, amplitude in "
       "[from, to]",
       numbers("from", "to")},
      {"phase_difference", phase_difference,
       "mean difference in phase between successive impacts, degrees, if each half cycle has one",
       numbers("amplitude", "half_cycles")},
      {"stuck_degrees_slope", stuck_degrees_slope,
       "growth of the stuck part of a half cycle with amplitude, degrees", numbers("from", "to")},
      {"bounce_down_degrees_slope", bounce_down_degrees_slope,
       "growth of the part between first and last impact of a half cycle with amplitude, degrees",
       numbers("from", "to")},
      {"first_amplitude", first_amplitude,
       "amplitude of the first half cycle, of the scene in which it is farthest from the given one",
       numbers("amplitude"), scenes(1, 8)},
      {"first_impact_place", first_impact_place,
       "place of the secondary mass at its first impact, of the scene in which it is farthest from the given "
       "one",
       numbers("amplitude"), scenes(1, 8)},
      {"impact_loss_error", impact_loss_error,
       "energy that the impacts' speeds take out, divided by that which the amplitudes lose, less 1; of the "
       "scene in which it is farthest from 0",
       numbers(), scenes(1, 8)},
      {"impact_speed_slope", impact_speed_slope,
       "d ln (w / A^power) / d ln A, w the fastest impact of a half cycle", numbers("from", "to", "power")},
  };
}

}  // namespace impact_damper
