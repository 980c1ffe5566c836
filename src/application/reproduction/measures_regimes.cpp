// Measures on the sequence of impacts: bounce-down, regular windows, impact failure, phases.
#include <algorithm>
#include <cmath>

#include "application/reproduction/measures_parts.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The first row below the asked amplitude and as many rows as are asked for from there on, [first, last);
// empty if there are fewer.
struct Rows {
  std::size_t first = 0, last = 0;
};
Rows rows_below(const Asked& asked, const Run& run) {
  const auto first = first_row_below(half_cycles_of(run), asked.number("amplitude"));
  const std::size_t count = static_cast<std::size_t>(asked.number("half_cycles"));
  if (!first || *first + count > run.half_cycles->amplitude.size()) return {};
  return {*first, *first + count};
}

std::vector<std::size_t> rows_between(const Asked& asked, const Run& run) {
  std::vector<std::size_t> rows;
  const auto& amplitude = half_cycles_of(run).amplitude;
  for (std::size_t row = 1; row < amplitude.size(); ++row)
    if (asked.is_between(amplitude[row])) rows.push_back(row);
  return rows;
}

std::size_t row_of(const Run& run, double time) {
  const auto& crossing = half_cycles_of(run).zero_crossing;
  return static_cast<std::size_t>(std::upper_bound(crossing.begin(), crossing.end(), time) -
                                  crossing.begin());
}

// Returns the indices of the impacts in each half cycle.
std::vector<std::vector<std::size_t>> impacts_by_row(const Run& run) {
  std::vector<std::vector<std::size_t>> rows(half_cycles_of(run).amplitude.size());
  const std::vector<double>& time = impacts_of(run).time;
  for (std::size_t i = 0; i < time.size(); ++i)
    if (const std::size_t row = row_of(run, time[i]); row < rows.size()) rows[row].push_back(i);
  return rows;
}

double mean_impacts(const Run& run, const Rows& rows) {
  double sum = 0;
  for (std::size_t row = rows.first; row < rows.last; ++row)
    sum += static_cast<double>(run.half_cycles->impacts[row]);
  return sum / static_cast<double>(rows.last - rows.first);
}

std::vector<bool> sticks(const Asked& asked, const Run& run) {
  std::vector<bool> rows(half_cycles_of(run).amplitude.size(), false);
  const Contacts stuck = stuck_contacts(run, asked.analysis().regimes);
  for (std::size_t i = 0; i < stuck.begin.size(); ++i)
    for (std::size_t row = row_of(run, stuck.begin[i]); row < rows.size(); ++row) {
      if (row > 0 && run.half_cycles->zero_crossing[row - 1] >= stuck.end[i]) break;
      rows[row] = true;
    }
  return rows;
}

double first_missed(const Asked& asked, const Run& run) {
  const auto missed = impact_failure(run, asked.analysis().regimes).first_missed;
  return missed ? missed->amplitude : std::nan("");
}

// Returns the regular window of the asked number of impacts that lies nearest to the asked amplitude.
// Its amplitudes are infinite if there is none: unlike NaN, that keeps the median over the other members.
RegularWindow nearest_window(const Asked& asked, const Run& run) {
  const double amplitude = asked.number("amplitude"), impacts = asked.number("impacts");
  double least = infinity;
  RegularWindow nearest{.upper = infinity, .lower = infinity};
  for (const RegularWindow& window : regular_windows(run, asked.analysis().regimes)) {
    if (static_cast<double>(window.impacts) != impacts) continue;
    const double distance = std::max({0.0, amplitude - window.upper, window.lower - amplitude});
    if (!(distance < least)) continue;
    least = distance;
    nearest = window;
  }
  return nearest;
}

// Returns the number that `find` finds in one of the runs: that which is farthest from `centre`; NaN if one
// is.
double farthest_from(double centre, const RunGroup& group, double (*find)(const Run&)) {
  std::vector<double> found;
  for (const Run* run : group) {
    found.push_back(find(*run));
    if (std::isnan(found.back())) return found.back();
  }
  return *std::ranges::max_element(found, {}, [&](double value) { return std::abs(value - centre); });
}

}  // namespace

std::vector<Measure> regime_measures() {
  return {
      {"bounce_down_end", "amplitude at the end of bounce-down; the release's if nothing ever sticks",
       [](const Asked& asked, const Run& run) {
         if (const auto end = end_of_bounce_down(run, asked.analysis().regimes)) return end->amplitude;
         // No series of stuck half cycles has come to an end: either one still goes on or there was none.
         return sticks(asked, run).back() ? run.half_cycles->amplitude.back()
                                          : run.half_cycles->amplitude.front();
       }},
      {"first_missed", "amplitude at the first missed impact", first_missed},
      {"first_missed_ratio", "that of the first scene, divided by the second's",
       [](const Asked& asked, const Run& first, const Run& second) {
         return first_missed(asked, first) / first_missed(asked, second);
       }},
      {"window_nearest",
       "amplitude of a regular window of so many impacts that is nearest to the given one, which it is "
       "inside a window; infinite if there is none",
       [](const Asked& asked, const Run& run) {
         const RegularWindow window = nearest_window(asked, run);
         return std::min(window.upper, std::max(window.lower, asked.number("amplitude")));
       },
       numbers("impacts", "amplitude")},
      {"window_upper", "amplitude at which that window begins",
       [](const Asked& asked, const Run& run) { return nearest_window(asked, run).upper; },
       numbers("impacts", "amplitude")},
      {"window_lower", "amplitude at which it ends",
       [](const Asked& asked, const Run& run) { return nearest_window(asked, run).lower; },
       numbers("impacts", "amplitude")},
      {"windows_in_order",
       "how many regular windows, of most, most - 1, ... 1 impacts, follow each other down in amplitude",
       [](const Asked& asked, const Run& run) {
         const std::vector<RegularWindow> windows = regular_windows(run, asked.analysis().regimes);
         double found = 0, below = infinity;
         for (std::int64_t count = static_cast<std::int64_t>(asked.number("most")); count >= 1; --count) {
           const auto window = longest_window(windows, count);
           if (!window || !(window->upper < below)) break;
           below = window->lower;
           ++found;
         }
         return found;
       },
       numbers("most")},
      {"mixed_gaps", "how many pairs of neighbours among them leave a gap of mixed counts",
       [](const Asked& asked, const Run& run) {
         const std::vector<RegularWindow> windows = regular_windows(run, asked.analysis().regimes);
         double gaps = 0;
         for (std::int64_t count = static_cast<std::int64_t>(asked.number("most")); count >= 2; --count) {
           const auto above = longest_window(windows, count), below = longest_window(windows, count - 1);
           // Between two adjoining windows one half cycle may belong to neither.
           if (above && below && below->first > above->last + 2) ++gaps;
         }
         return gaps;
       },
       numbers("most")},
      {"impacts_per_half_cycle",
       "mean number of impacts in so many half cycles from the first below an amplitude on",
       [](const Asked& asked, const Run& run) { return mean_impacts(run, rows_below(asked, run)); },
       numbers("amplitude", "half_cycles")},
      {"rows_with_impacts", "share of these half cycles with just so many impacts",
       [](const Asked& asked, const Run& run) {
         const Rows rows = rows_below(asked, run);
         double share = 0;
         for (std::size_t row = rows.first; row < rows.last; ++row)
           share += static_cast<double>(run.half_cycles->impacts[row]) == asked.number("impacts");
         return share / static_cast<double>(rows.last - rows.first);
       },
       numbers("amplitude", "half_cycles", "impacts")},
      // The exponent by least squares over four values of e. Each is released at 1.1 times the amplitude
      // above which its bounces end; at a fixed amplitude no half cycle would end stuck beyond some e. NaN if
      // a scene, as one with a heavy secondary mass, has too few half cycles in that time.
      {"stuck_impacts_growth",
       "power of 1/(1 - e) as which the impacts in a half cycle that ends stuck become more",
       [](const Asked& asked) {
         const Run& base = asked.file();
         constexpr double above = 1.1;
         constexpr std::size_t half_cycles = 5;
         Curve growth;
         for (const double e : {0.4, 0.6, 0.8, 0.9}) {
           Scene scene = base.scene;
           scene.damper().restitution = e;
           scene.x0 = above * bounce_down_end(e);
           scene.until_amplitude.reset();
           scene.until_time = double(half_cycles + 1) * half_turn<double>();
           const Run run = asked.runs.simulated(scene, base.engine, Record{});
           if (half_cycles_of(run).amplitude.size() <= half_cycles) return std::nan("");
           growth.add(1 / (1 - e), mean_impacts(run, {1, 1 + half_cycles}));
         }
         return log_slope(growth);
       },
       numbers(), scenes(1, 1)},
      {"bounce_down_closed_form",
       "amplitude at the end of bounce-down, closed form for nu -> 0 and e <= 0.95",
       [](const Asked& asked) {
         const double e = asked.number("restitution");
         return e <= 0.95 ? bounce_down_end(e) : std::nan("");
       },
       numbers("restitution")},
      {"longest_stuck_series", "most half cycles in succession in which the mass sticks to a wall",
       [](const Asked& asked, const Run& run) {
         double longest = 0, series = 0;
         for (const bool stuck : sticks(asked, run)) {
           series = stuck ? series + 1 : 0;
           longest = std::max(longest, series);
         }
         return longest;
       }},
      {"stuck_share", "share of the half cycles in which the mass sticks",
       [](const Asked& asked, const Run& run) {
         const std::vector<bool> stuck = sticks(asked, run);
         double count = 0;
         const std::vector<std::size_t> rows = rows_between(asked, run);
         for (const std::size_t row : rows) count += stuck[row];
         return count / static_cast<double>(rows.size());
       },
       numbers("from", "to")},
      {"alternation",
       "share of the half cycles that, with the one before, have one and two impacts in turn, amplitude in "
       "[from, to]",
       [](const Asked& asked, const Run& run) {
         const auto& impacts = half_cycles_of(run).impacts;
         double pairs = 0, alternating = 0;
         for (const std::size_t row : rows_between(asked, run)) {
           ++pairs;
           alternating +=
               std::min(impacts[row - 1], impacts[row]) == 1 && impacts[row - 1] + impacts[row] == 3;
         }
         return alternating / pairs;
       },
       numbers("from", "to")},
      {"phase_difference",
       "mean difference in phase between successive impacts, degrees, if each half cycle has one",
       [](const Asked& asked, const Run& run) {
         const Rows rows = rows_below(asked, run);
         const auto by_row = impacts_by_row(run);
         std::vector<double> phase;
         for (std::size_t row = rows.first; row < rows.last; ++row)
           for (const std::size_t i : by_row[row])
             if (const auto degrees = run.impacts->phase_deg[i]) phase.push_back(*degrees);
         if (phase.size() != rows.last - rows.first || phase.size() < 2) return std::nan("");
         double sum = 0;
         for (std::size_t i = 1; i < phase.size(); ++i) sum += std::abs(phase[i] - phase[i - 1]);
         return sum / static_cast<double>(phase.size() - 1);
       },
       numbers("amplitude", "half_cycles")},
      {"stuck_degrees_slope", "growth of the stuck part of a half cycle with amplitude, degrees",
       [](const Asked& asked, const Run& run) {
         const StuckPhases stuck = stuck_phases(run, asked.analysis().regimes);
         Curve curve;
         for (std::size_t i = 0; i < stuck.amplitude.size(); ++i) {
           // The mass is released slightly after the zero crossing: the remnant at the start belongs to the
           // half cycle before.
           if (!asked.is_between(stuck.amplitude[i]) || stuck.begin_deg[i] <= 0) continue;
           curve.add(stuck.amplitude[i], stuck.end_deg[i] - stuck.begin_deg[i]);
         }
         return slope(curve);
       },
       numbers("from", "to")},
      {"bounce_down_degrees_slope",
       "growth of the part between first and last impact of a half cycle with amplitude, degrees",
       [](const Asked& asked, const Run& run) {
         const auto by_row = impacts_by_row(run);
         Curve curve;
         for (const std::size_t row : rows_between(asked, run)) {
           std::vector<double> phase;
           for (const std::size_t i : by_row[row])
             if (const auto degrees = run.impacts->phase_deg[i]) phase.push_back(*degrees);
           if (!phase.empty()) curve.add(run.half_cycles->amplitude[row], phase.back() - phase.front());
         }
         return slope(curve);
       },
       numbers("from", "to")},
      {"first_amplitude",
       "amplitude of the first half cycle, of the scene in which it is farthest from the given one",
       [](const Asked& asked, const RunGroup& group) {
         return farthest_from(asked.number("amplitude"), group, [](const Run& run) {
           const std::vector<double>& amplitude = half_cycles_of(run).amplitude;
           return amplitude.empty() ? std::nan("") : amplitude.front();
         });
       },
       numbers("amplitude"), scenes(1, 8)},
      {"first_impact_place",
       "place of the secondary mass at its first impact, of the scene in which it is farthest from the given "
       "one",
       [](const Asked& asked, const RunGroup& group) {
         return farthest_from(asked.number("amplitude"), group, [](const Run& run) {
           const Impacts& impacts = impacts_of(run);
           if (impacts.time.empty()) return std::nan("");
           return impacts.displacement.front() + (impacts.wall.front() == Wall::right ? 1 : 0);
         });
       },
       numbers("amplitude"), scenes(1, 8)},
      // An impact at the relative speed w dissipates nu (1 - e^2) w^2 / (2 (1 + nu)); without viscous damping
      // nothing else is lost between the first amplitude and the last.
      {"impact_loss_error",
       "energy that the impacts' speeds take out, divided by that which the amplitudes lose, less 1; of the "
       "scene in which it is farthest from 0",
       [](const Asked&, const RunGroup& group) {
         return farthest_from(0, group, [](const Run& run) {
           const double nu = run.scene.damper().mass_ratio, e = run.scene.damper().restitution;
           double squares = 0;
           for (const double w : impacts_of(run).relative_velocity) squares += w * w;
           const double lost = nu * (1 - e * e) / (2 * (1 + nu)) * squares;
           const std::vector<double>& amplitude = half_cycles_of(run).amplitude;
           const double first = amplitude.front(), last = amplitude.back();
           return lost / ((first * first - last * last) / 2) - 1;
         });
       },
       numbers(), scenes(1, 8)},
      {"impact_speed_slope", "d ln (w / A^power) / d ln A, w the fastest impact of a half cycle",
       [](const Asked& asked, const Run& run) {
         const auto by_row = impacts_by_row(run);
         Curve curve;
         for (const std::size_t row : rows_between(asked, run)) {
           double fastest = 0;
           for (const std::size_t i : by_row[row])
             fastest = std::max(fastest, std::abs(run.impacts->relative_velocity[i]));
           const double amplitude = run.half_cycles->amplitude[row];
           if (fastest > 0)
             curve.add(amplitude, fastest * exponential(-asked.number("power") * logarithm(amplitude)));
         }
         return log_slope(curve);
       },
       numbers("from", "to", "power")},
  };
}

}  // namespace impact_damper
