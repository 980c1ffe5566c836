#include "impact_damper/analysis/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/motion/force_law.hpp"
#include "impact_damper/motion/impact_law.hpp"

namespace impact_damper {
namespace {

// Relative difference of numbers that two computations give: the rounding of a few dozen operations.
constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();

class Examination {
 public:
  explicit Examination(const Run& run)
      : run_(run),
        scene_(run.scene),
        several_(!has_one_damper(run.scene)),
        cem_(std::get_if<Cem>(&run.engine)) {
    std::visit([&](const auto& engine) { budget_ = engine.budget; }, run.engine);
    if (cem_) step_ = cem_->large_step.value_or(cem_->time_step.value_or(0));
  }

  std::vector<Problem> problems() {
    examine_end();
    if (run_.half_cycles) examine_half_cycles(*run_.half_cycles);
    if (run_.half_cycles && several_) examine_counts(*run_.half_cycles);
    if (run_.impacts) {
      examine_impacts(*run_.impacts);
      if (run_.half_cycles)
        examine_rows(*run_.half_cycles, *run_.impacts);
      else
        examine_phases(*run_.impacts);
    }
    if (run_.contacts) examine_contacts(*run_.contacts);
    if (run_.history) examine_history(*run_.history);
    if (run_.history && run_.half_cycles) examine_samples(*run_.half_cycles, *run_.history);
    if (run_.energy) examine_energy(*run_.energy);
    return std::move(problems_);
  }

 private:
  bool is_rigid() const { return has_rigid_walls(run_.engine); }

  // Notes a problem unless `holds`, and returns `holds`.
  bool require(bool holds, const std::string& field, const std::string& message) {
    if (!holds) problems_.push_back({field, message});
    return holds;
  }
  bool require(bool holds, const std::string& column, std::size_t row, const std::string& message) {
    return holds || require(false, column + '/' + std::to_string(row), message);
  }
  static std::string got(const std::string& wanted, double given) {
    return "must be " + wanted + ", got " + number_text(given);
  }
  static std::string got(const std::string& wanted, std::int64_t given) {
    return "must be " + wanted + ", got " + std::to_string(given);
  }
  bool equal(const std::string& field, double wanted, double given, double tolerance, const std::string& of) {
    return require(std::abs(given - wanted) <= tolerance, field, got(number_text(wanted) + of, given));
  }

  // The JSON pointer of one damper's part of a section; the section itself where the scene has one damper.
  std::string of_damper(const std::string& section, std::size_t damper) const {
    return several_ ? section + "dampers/" + std::to_string(damper) + '/' : section;
  }
  // An upper bound of |x| and |x'| in a run that only the force puts energy into: d/dt sqrt(2 E) <= f0. E is
  // counted from its least value, which the weight of the masses puts below that at x = y = 0.
  double fastest() const {
    double twice_energy =
        std::max(scene_.x0 * scene_.x0, 2 * energy_in_spring(scene_.x0)) + scene_.v0 * scene_.v0;
    for (const SceneDamper& damper : scene_.dampers)
      twice_energy += damper.mass_ratio * (scene_.v0 + damper.w0) * (scene_.v0 + damper.w0);
    const double weight = scene_.weight * secondary_mass(scene_);
    twice_energy += weight * (2 * std::abs(scene_.x0) + weight);
    for (const SceneDamper& damper : scene_.dampers) {
      const double its = scene_.weight * damper.mass_ratio;
      twice_energy += its * (2 * std::abs(damper.y0) + its / damper.wall_stiffness);
    }
    twice_energy += 2 * energy_in_walls();
    return std::sqrt(twice_energy) + weight + std::abs(scene_.force_amplitude) * run_.end_time;
  }

  double energy_in_walls() const {  // at the release
    double energy = 0;
    for (const SceneDamper& damper : scene_.dampers) {
      const double depth = is_rigid() ? 0 : std::max({0.0, -damper.y0, damper.y0 - damper.clearance});
      energy += ForceLaw::of_wall(damper).energy(depth);
    }
    return energy;
  }
  double energy_in_spring(double x) const { return ForceLaw::of_spring(scene_.spring).energy(x); }

  // How far two records of one event may be apart in time: rounding, and the component element method sees an
  // event up to a step late.
  double instant(double time) const { return rounding * (1 + time) + 2 * step_; }
  // How far two values of x from the same motion may be apart, `scale` being the size of x, x' and the force:
  // rounding, and with the component element method the parabola through three steps, whose curvature the
  // walls make as large as k nu.
  double blur(double time, double scale) const {
    double curvature = 1;
    for (const SceneDamper& damper : scene_.dampers)
      curvature += damper.mass_ratio * (damper.wall_stiffness * step_ + damper.friction + scene_.weight);
    return rounding * (1 + time) * scale + step_ * step_ * curvature * (1 + scale);
  }

  void examine_end() {
    const double end = run_.end_time;
    const std::string field = "/end_time";
    const auto at_most = [&](const std::optional<double>& limit, const std::string& name) {
      if (limit) require(end <= *limit, field, got("<= " + name + ", " + number_text(*limit), end));
    };
    at_most(scene_.until_time, "until_time");
    at_most(budget_.max_time, "max_time");
    const auto ends_at = [&](const double* wanted, const std::string& what) {
      const std::string reason = "\"" + std::string(name_of(run_.stop_reason)) + "\"";
      if (!require(wanted != nullptr, "/stop_reason",
                   "must be another one where there is no " + what + ", got " + reason))
        return;
      require(end == *wanted, field,
              got(what + ", " + number_text(*wanted) + ", with the stop reason " + reason, end));
    };
    const auto last_crossing = [&] {
      const std::vector<double>& all = run_.half_cycles->zero_crossing;
      return all.empty() ? nullptr : &all.back();
    };
    switch (run_.stop_reason) {
      case StopReason::time:
        ends_at(scene_.until_time ? &*scene_.until_time : nullptr, "until_time");
        break;
      case StopReason::time_budget:
        if (budget_.max_time) ends_at(&*budget_.max_time, "max_time");
        break;
      case StopReason::amplitude:
        require(scene_.until_amplitude.has_value(), "/stop_reason",
                "must be another one where there is no until_amplitude, got \"amplitude\"");
        if (run_.half_cycles) ends_at(last_crossing(), "last zero crossing");
        break;
      case StopReason::half_cycle_budget:
        if (run_.half_cycles) ends_at(last_crossing(), "last zero crossing");
        break;
      case StopReason::impact_budget:
      case StopReason::step_budget:
        break;
    }
    if (run_.impacts) {
      const auto impacts = static_cast<std::int64_t>(run_.impacts->time.size());
      const bool used_up = run_.stop_reason == StopReason::impact_budget;
      // Of several impacts at one instant all are recorded, or none.
      const auto at_once = static_cast<std::int64_t>(scene_.dampers.size());
      require(impacts <= budget_.max_impacts && (!used_up || impacts > budget_.max_impacts - at_once),
              "/impacts/time",
              std::string("must hold ") + (used_up ? "" : "at most ") + "max_impacts, " +
                  std::to_string(budget_.max_impacts) + ", impacts, got " + std::to_string(impacts));
    }
    if (run_.half_cycles) examine_last_row(*run_.half_cycles);
  }

  void examine_last_row(const HalfCycles& rows) {
    const auto count = static_cast<std::int64_t>(rows.amplitude.size());
    const bool used_up = run_.stop_reason == StopReason::half_cycle_budget;
    require(used_up ? count == budget_.max_half_cycles : count <= budget_.max_half_cycles,
            "/half_cycles/zero_crossing",
            std::string("must hold ") + (used_up ? "" : "at most ") + "max_half_cycles, " +
                std::to_string(budget_.max_half_cycles) + ", rows, got " + std::to_string(count));
    if (!scene_.until_amplitude) return;
    const auto low =
        std::ranges::find_if(rows.amplitude, [&](double a) { return a < *scene_.until_amplitude; });
    const auto row = static_cast<std::size_t>(low - rows.amplitude.begin());
    const bool stopped = run_.stop_reason == StopReason::amplitude;
    if (low == rows.amplitude.end()) {
      require(!stopped, "/stop_reason",
              "must be another one where no amplitude is below until_amplitude, got \"amplitude\"");
    } else {
      require(stopped && row + 1 == rows.amplitude.size(), "/half_cycles/amplitude", row,
              got(">= until_amplitude, " + number_text(*scene_.until_amplitude) +
                      ", in all rows but the last of a run that it stopped",
                  *low));
    }
  }

  void examine_half_cycles(const HalfCycles& rows) {
    const std::string section = "/half_cycles/";
    for (std::size_t i = 0; i < rows.amplitude.size(); ++i) {
      const double begin = i > 0 ? rows.zero_crossing[i - 1] : 0, end = rows.zero_crossing[i];
      if (i > 0 && !require(begin < end, section + "zero_crossing", i,
                            got("later than the one before it, " + number_text(begin), end)))
        break;
      if (!require(end <= run_.end_time, section + "zero_crossing", i,
                   got("<= end_time, " + number_text(run_.end_time), end)))
        break;
    }
    for (std::size_t i = 0; i < rows.amplitude.size(); ++i) {
      const double begin = i > 0 ? rows.zero_crossing[i - 1] : 0, end = rows.zero_crossing[i];
      const double peak = rows.peak_time[i];
      if (!require(begin - instant(begin) <= peak && peak <= end + instant(end), section + "peak_time", i,
                   got("in its row, " + number_text(begin) + " to " + number_text(end), peak)))
        break;
    }
    if (rows.amplitude.empty()) return;
    const double first = rows.amplitude[0], x0 = std::abs(scene_.x0);
    // An impact at the release may reverse x' so early that the time of the peak is rounded to zero.
    const bool is_x0 = std::abs(first - x0) <= 4 * std::numeric_limits<double>::epsilon() * x0;
    require(rows.peak_time[0] == 0 ? is_x0 : first >= x0, section + "amplitude/0",
            got((rows.peak_time[0] == 0 ? "|x0| = " : ">= |x0| = ") + number_text(x0), first));
  }

  void examine_counts(const HalfCycles& rows) {
    for (std::size_t row = 0; row < rows.impacts.size(); ++row) {
      std::int64_t sum = 0;
      for (const HalfCycles::Damper& its : rows.dampers) sum += its.impacts[row];
      if (!require(sum == rows.impacts[row], "/half_cycles/impacts", row,
                   got("the sum over all dampers, " + std::to_string(sum), rows.impacts[row])))
        break;
    }
  }

  void examine_impacts(const Impacts& impacts) {
    const std::string section = "/impacts/";
    for (std::size_t i = 0; i < impacts.time.size(); ++i) {
      if (!require(impacts.time[i] <= run_.end_time, section + "time", i,
                   got("<= end_time, " + number_text(run_.end_time), impacts.time[i])))
        break;
    }
    for (std::size_t i = 0; i < impacts.time.size(); ++i) {
      const double w = impacts.relative_velocity[i], into = impacts.wall[i] == Wall::left ? -w : w;
      // The component element method may record the impact of a slow mass when it moves away again.
      const double least =
          -step_ * (1 + std::abs(impacts.displacement[i]) + std::abs(scene_.force_amplitude));
      if (!require(
              into >= least, section + "relative_velocity", i,
              got(impacts.wall[i] == Wall::left ? "<= 0 at the left wall" : ">= 0 at the right wall", w)))
        break;
    }
  }

  // Without half cycles: checks which impacts have a phase and an amplitude.
  void examine_phases(const Impacts& impacts) {
    std::size_t i = 0;
    const std::size_t count = impacts.time.size();
    while (i < count && !impacts.phase_deg[i] && impacts.amplitude[i]) ++i;
    while (i < count && impacts.phase_deg[i] && impacts.amplitude[i]) ++i;
    while (i < count && !impacts.phase_deg[i] && !impacts.amplitude[i]) ++i;
    require(i == count, "/impacts/phase_deg", i,
            "must be there from the first zero crossing on, with the amplitude, and not after the last");
  }

  void examine_rows(const HalfCycles& rows, const Impacts& impacts) {
    const std::string section = "/impacts/";
    const std::size_t count = impacts.time.size();
    const double counted = std::accumulate(rows.impacts.begin(), rows.impacts.end(), 0.0);
    if (!require(counted <= static_cast<double>(count), "/half_cycles/impacts",
                 got("at most " + std::to_string(count) + " in all, the impacts there are", counted)))
      return;
    std::size_t i = 0;
    for (std::size_t row = 0; row < rows.impacts.size(); ++row) {
      const double begin = row > 0 ? rows.zero_crossing[row - 1] : 0, end = rows.zero_crossing[row];
      const double amplitude = rows.amplitude[row];
      std::vector<std::int64_t> by_damper(scene_.dampers.size());
      for (std::int64_t n = 0; n < rows.impacts[row]; ++n, ++i) {
        const double time = impacts.time[i];
        ++by_damper[impacts.damper[i]];
        if (!require(
                begin - instant(begin) <= time && time <= end + instant(end), section + "time", i,
                got("in row " + std::to_string(row) + ", " + number_text(begin) + " to " + number_text(end),
                    time)))
          return;
        if (!require(impacts.amplitude[i] == amplitude, section + "amplitude", i,
                     "must be that of row " + std::to_string(row) + ", " + number_text(amplitude)))
          return;
        const double phase = 180 * ((time - begin) / (end - begin));
        const std::optional<double>& given = impacts.phase_deg[i];
        if (!require(
                row > 0 ? given && std::abs(*given - phase) <= 180 * instant(end) / (end - begin) : !given,
                section + "phase_deg", i,
                row > 0 ? "must be " + number_text(phase) + ", by its time and the zero crossings about it"
                        : "must be null before the first zero crossing"))
          return;
        const double x = std::abs(impacts.displacement[i]);
        if (!require(
                x <= amplitude + blur(time, amplitude + std::abs(scene_.force_amplitude)),
                section + "displacement", i,
                got("at most the amplitude of its row, " + number_text(amplitude), impacts.displacement[i])))
          return;
      }
      for (std::size_t damper = 0; several_ && damper < rows.dampers.size(); ++damper) {
        const std::int64_t given = rows.dampers[damper].impacts[row];
        if (!require(
                given == by_damper[damper], of_damper("/half_cycles/", damper) + "impacts", row,
                got("the number of its impacts in the row, " + std::to_string(by_damper[damper]), given)))
          return;
      }
    }
    for (; i < count; ++i) {
      const double last = rows.zero_crossing.empty() ? 0 : rows.zero_crossing.back();
      if (!require(impacts.time[i] >= last - instant(last), section + "time", i,
                   got("after the last zero crossing, " + number_text(last) + ", where no row counts it",
                       impacts.time[i])))
        return;
      if (!require(!impacts.phase_deg[i] && !impacts.amplitude[i], section + "phase_deg", i,
                   "must be null after the last zero crossing, as must the amplitude"))
        return;
    }
  }

  void examine_contacts(const Contacts& contacts) {
    const std::string section = "/contacts/";
    std::vector<std::vector<std::size_t>> of(scene_.dampers.size());  // each damper
    for (std::size_t i = 0; i < contacts.begin.size(); ++i) {
      std::vector<std::size_t>& before = of[contacts.damper[i]];
      const double free_from = before.empty() ? 0 : contacts.end[before.back()];
      if (!before.empty() &&
          !require(contacts.begin[i] >= free_from, section + "begin", i,
                   got("at or after the end of the contact before it, " + number_text(free_from),
                       contacts.begin[i])))
        break;
      before.push_back(i);
      if (!require(contacts.end[i] <= run_.end_time, section + "end", i,
                   got("<= end_time, " + number_text(run_.end_time), contacts.end[i])))
        break;
    }
    if (!run_.impacts) return;
    const Impacts& impacts = *run_.impacts;
    if (is_rigid()) {
      std::vector<std::size_t> next(scene_.dampers.size());
      for (std::size_t i = 0; i < impacts.time.size(); ++i) {
        const double time = impacts.time[i];
        const std::vector<std::size_t>& its = of[impacts.damper[i]];
        std::size_t& n = next[impacts.damper[i]];
        while (n < its.size() && contacts.end[its[n]] <= time) ++n;
        if (!require(n == its.size() || time <= contacts.begin[its[n]], "/impacts/time", i,
                     got("in no stuck interval, such as from " +
                             number_text(n < its.size() ? contacts.begin[its[n]] : 0) + " on",
                         time)))
          break;
      }
      return;
    }
    std::vector<std::vector<std::size_t>> impacts_of(scene_.dampers.size());
    for (std::size_t i = 0; i < impacts.time.size(); ++i) impacts_of[impacts.damper[i]].push_back(i);
    for (std::size_t damper = 0; damper < scene_.dampers.size(); ++damper) {
      const std::vector<std::size_t>&its = of[damper], &begun_by = impacts_of[damper];
      const std::size_t without = its.size() > begun_by.size() ? 1 : 0;
      if (!require(its.size() == begun_by.size() + without && (without == 0 || contacts.begin[its[0]] == 0),
                   section + "begin",
                   "must hold one contact for each of the " + std::to_string(begun_by.size()) + " impacts" +
                       (several_ ? " of damper " + std::to_string(damper + 1) : "") +
                       " and at most one more, from the release on, got " + std::to_string(its.size())))
        return;
      for (std::size_t n = 0; n < begun_by.size(); ++n) {
        const std::size_t i = begun_by[n], contact = its[n + without];
        if (!require(contacts.begin[contact] == impacts.time[i], section + "begin", contact,
                     got("the time of its impact, " + number_text(impacts.time[i]), contacts.begin[contact])))
          return;
        if (!require(contacts.wall[contact] == impacts.wall[i], section + "wall", contact,
                     "must be that of its impact"))
          return;
      }
    }
  }

  void examine_history(const History& history) {
    const double f0 = std::abs(scene_.force_amplitude);
    if (history.time.empty()) return;
    require(history.time.back() <= run_.end_time, "/history/time", history.time.size() - 1,
            got("<= end_time, " + number_text(run_.end_time), history.time.back()));
    for (std::size_t i = 0; several_ && is_rigid() && i < scene_.dampers.size(); ++i)
      examine_place(history, i);
    if (history.time[0] != 0) return;
    const double size = std::abs(scene_.x0) + std::abs(scene_.v0) + f0;
    if (!equal("/history/x/0", scene_.x0, history.x[0], rounding * size, ", x0")) return;
    for (std::size_t i = 0; i < scene_.dampers.size(); ++i) {
      const double y0 = scene_.dampers[i].y0;
      if (!equal(of_damper("/history/", i) + "y/0", y0, history.dampers[i].y[0],
                 rounding * (1 + size + std::abs(y0) + std::abs(scene_.dampers[i].w0)), ", y0"))
        return;
    }
  }

  // Checks that a mass lies between its rigid walls, to within the rounding of its flight.
  void examine_place(const History& history, std::size_t damper) {
    const double clearance = scene_.dampers[damper].clearance, near = rounding * (clearance + 2 * fastest());
    const std::vector<double>& y = history.dampers[damper].y;
    for (std::size_t i = 0; i < y.size(); ++i) {
      if (!require(-near <= y[i] && y[i] <= clearance + near, of_damper("/history/", damper) + "y", i,
                   got("between the walls, 0 to " + number_text(clearance), y[i])))
        break;
    }
  }

  void examine_samples(const HalfCycles& rows, const History& history) {
    const std::vector<double>& crossings = rows.zero_crossing;
    const double f0 = std::abs(scene_.force_amplitude);
    // `fastest` bounds |x| near a zero crossing by |x'|, which a wall can raise to its largest value within a
    // rounding of time. With central differences, which see a crossing late, only the energy at the release
    // and the work of the force bound |x'| between samples. Where recorded numbers exceed that bound, x at
    // zero crossings is not checked.
    double fastest = std::max(f0, 2 * std::abs(scene_.damper().w0));  // as after an impact at the release
    if (several_) fastest = std::max(f0, this->fastest());
    for (const auto* column : {&rows.amplitude, &history.x, &history.v})
      for (const double value : *column) fastest = std::max(fastest, std::abs(value));
    bool zeros_are_bounded = true;
    if (cem_) {
      const double bound = 2 * this->fastest();
      zeros_are_bounded = fastest <= bound;
      fastest = bound;
    }
    std::size_t row = 0;         // of the sample
    bool side_is_known = false;  // whether last_x is set: x of the last sample with a certain sign
    double last_time = 0, last_x = 0, largest = 0;
    bool signs_hold = true, heights_hold = true, zeros_hold = true;
    for (std::size_t i = 0; i < history.time.size(); ++i) {
      const double time = history.time[i], x = history.x[i], near = instant(time);
      // An impact can reduce x and x' to the rounding errors of their earlier values.
      const double size = std::abs(x) + std::abs(history.v[i]) + f0;
      largest = std::max(largest, size);
      while (row < crossings.size() && crossings[row] < time) ++row;
      const bool at_next = row < crossings.size() && crossings[row] - time <= near;
      const bool at_last = row > 0 && time - crossings[row - 1] <= near;
      if (at_next || at_last) {
        zeros_hold = zeros_hold && (!zeros_are_bounded ||
                                    require(std::abs(x) <= near * fastest + blur(time, size), "/history/x", i,
                                            got("zero, as there is a zero crossing at its time", x)));
      } else if (row < crossings.size()) {
        const double amplitude = rows.amplitude[row];
        heights_hold =
            heights_hold &&
            require(std::abs(x) <= amplitude + blur(time, amplitude + size), "/history/x", i,
                    got("at most the amplitude of row " + std::to_string(row) + ", " + number_text(amplitude),
                        x));
      }
      if (at_next || at_last || std::abs(x) <= near * size + blur(time, largest)) continue;
      if (side_is_known && x * last_x < 0 && signs_hold) {
        const auto first = std::ranges::lower_bound(crossings, last_time - instant(last_time));
        signs_hold = require(first != crossings.end() && *first <= time + near, "/history/x", i,
                             got("of the same sign as " + number_text(last_x) + " at " +
                                     number_text(last_time) + ", as there is no zero crossing between",
                                 x));
      }
      side_is_known = true;
      last_time = time;
      last_x = x;
    }
  }

  void examine_energy(const EnergyBalance& balance) {
    std::vector<double> y, w;
    for (const SceneDamper& damper : scene_.dampers) y.push_back(damper.y0), w.push_back(damper.w0);
    examine_energy_at("/energy/initial/", balance.initial, scene_.x0, scene_.v0, y, w, energy_in_walls(),
                      rounding);
    examine_kinetic("initial_kinetic", &DamperEnergy::initial_kinetic, scene_.v0, w, rounding);
    if (run_.history && !run_.history->time.empty() && run_.history->time.back() == run_.end_time) {
      const History& history = *run_.history;
      // Near resonance or in an overdamped motion the final state carries rounding errors of larger numbers
      // before it; velocities of central differences are of second order.
      for (std::size_t i = 0; i < w.size(); ++i)
        y[i] = history.dampers[i].y.back(), w[i] = history.dampers[i].w.back();
      const double part = 1e-9 + step_ * step_;
      examine_energy_at("/energy/final/", balance.final, history.x.back(), history.v.back(), y, w,
                        balance.final.wall, part);
      examine_kinetic("final_kinetic", &DamperEnergy::final_kinetic, history.v.back(), w, part);
    }
    if (is_rigid() && run_.impacts) examine_losses(*run_.impacts, balance.impact_loss);
    if (several_) examine_sums(balance);
    if (is_rigid()) equal("/energy/contact_loss", 0, balance.contact_loss, 0, ": rigid walls take no energy");
    if (!is_rigid() || balance.bounce_downs == 0) {
      require(balance.bounce_downs == 0, "/energy/bounce_downs",
              got("0 with compliant walls", balance.bounce_downs));
      equal("/energy/bounce_down_loss", 0, balance.bounce_down_loss, 0,
            ": there was no bounce-down to jump over");
    }
    if (scene_.damping_ratio == 0)
      equal("/energy/viscous_work", 0, balance.viscous_work, 0, ": there is no damper");
    require(balance.viscous_work >= (cem_ ? -step_ * balance.initial.total() : 0.0), "/energy/viscous_work",
            got(">= 0", balance.viscous_work));
    const auto has = [&](double SceneDamper::*number) {
      return std::ranges::any_of(scene_.dampers, [&](const SceneDamper& its) { return its.*number != 0; });
    };
    if (!has(&SceneDamper::friction))
      equal("/energy/friction_loss", 0, balance.friction_loss, 0, ": no mass slides with friction");
    if (!has(&SceneDamper::drag)) equal("/energy/drag_loss", 0, balance.drag_loss, 0, ": there is no drag");
    require(balance.friction_loss >= 0, "/energy/friction_loss", got(">= 0", balance.friction_loss));
    require(balance.drag_loss >= 0, "/energy/drag_loss", got(">= 0", balance.drag_loss));
    if (scene_.force_amplitude == 0)
      equal("/energy/forcing_work", 0, balance.forcing_work, 0, ": there is no force");
    examine_residual(balance);
  }

  // Compares the energies at one instant with those of the state; y, w: of all dampers; part: relative
  // tolerance.
  void examine_energy_at(const std::string& section, const Energy& energy, double x, double v,
                         const std::vector<double>& y, const std::vector<double>& w, double wall,
                         double part) {
    double moving = v * v, kinetic = moving, paper = moving, weight = 0, lifted = 0;
    for (std::size_t i = 0; i < w.size(); ++i) {
      const double nu = scene_.dampers[i].mass_ratio, most = std::abs(v) + std::abs(w[i]), z1 = v + w[i];
      moving += nu * most * most;
      kinetic += nu * z1 * z1;
      paper += nu * (v * v + w[i] * w[i]);
      weight += scene_.weight * nu * (x + y[i]);
      lifted += scene_.weight * nu * (std::abs(x) + std::abs(y[i]));
    }
    const double spring = energy_in_spring(x), tolerance = part * (moving / 2 + spring + wall + lifted);
    const std::string of = ", that of the state";
    equal(section + "kinetic", kinetic / 2, energy.kinetic, tolerance, of);
    equal(section + "spring", spring, energy.spring, tolerance, of);
    equal(section + "wall", wall, energy.wall, tolerance, of);
    equal(section + "weight", weight, energy.weight, tolerance, of);
    equal(section + "paper", paper / 2 + spring, energy.paper, tolerance, of);
  }

  void examine_kinetic(const std::string& name, double DamperEnergy::*member, double v,
                       const std::vector<double>& w, double part) {
    for (std::size_t i = 0; several_ && i < w.size(); ++i) {
      const double nu = scene_.dampers[i].mass_ratio, z1 = v + w[i], most = std::abs(v) + std::abs(w[i]);
      if (!equal(of_damper("/energy/", i) + name, nu * z1 * z1 / 2, run_.energy->dampers[i].*member,
                 part * nu * most * most, ", that of its state"))
        break;
    }
  }

  // Checks the loss of each impact on a rigid wall, nu (1 - e^2) w^2 m/(m + nu)/2, where m, in units of the
  // primary mass, is what is struck: the primary mass and any secondary masses that rest on the other side.
  // Of several impacts at the same time only the sign is checked.
  void examine_losses(const Impacts& impacts, const std::vector<double>& losses) {
    double all = 1;
    for (const SceneDamper& damper : scene_.dampers) all += damper.mass_ratio;
    for (std::size_t i = 0; i < losses.size(); ++i) {
      const SceneDamper& damper = scene_.dampers[impacts.damper[i]];
      const double nu = damper.mass_ratio, w = impacts.relative_velocity[i];
      const Pairs& by_speed = damper.restitution_by_speed;
      const double e = by_speed.empty() ? damper.restitution : restitution_at(by_speed, std::abs(w));
      const double least = nu * (1 - e) * (1 + e) * w * w / (2 * (1 + nu));
      const std::string field = "/energy/impact_loss/" + std::to_string(i);
      // Several dampers, and one with friction, weight or drag, have theirs from the impulse.
      const double near = rounding * nu * w * w;
      if (!several_) {
        const double off = has_components(scene_) ? near : rounding * least;
        if (!equal(field, least, losses[i], off, ", by its speed and the restitution")) break;
        continue;
      }
      const auto is_same = [&](std::size_t j) { return impacts.time[j] == impacts.time[i]; };
      const bool alone = !(i > 0 && is_same(i - 1)) && !(i + 1 < losses.size() && is_same(i + 1));
      const double most = least * (1 + nu) * (all - nu) / all;
      if (!require(alone ? least - near <= losses[i] && losses[i] <= most + near : losses[i] >= 0, field,
                   got(alone ? number_text(least) + " to " + number_text(most) +
                                   ", by its speed and the restitution"
                             : ">= 0",
                       losses[i])))
        break;
    }
  }

  // Checks that the dampers' shares of the energy balance add up to its entries.
  void examine_sums(const EnergyBalance& balance) {
    const std::vector<DamperEnergy>& dampers = balance.dampers;
    std::vector<double> losses(dampers.size());
    double loss = 0;
    for (std::size_t i = 0; i < balance.impact_loss.size(); ++i) {
      loss += balance.impact_loss[i];
      if (run_.impacts) losses[run_.impacts->damper[i]] += balance.impact_loss[i];
    }
    const double rounded = rounding * (1 + static_cast<double>(balance.impact_loss.size()) / 64);
    double impact_loss = 0, contact_loss = 0, bounce_down_loss = 0, friction_loss = 0, drag_loss = 0;
    std::int64_t bounce_downs = 0;
    for (std::size_t i = 0; i < dampers.size(); ++i) {
      const std::string section = of_damper("/energy/", i);
      impact_loss += dampers[i].impact_loss;
      contact_loss += dampers[i].contact_loss;
      bounce_down_loss += dampers[i].bounce_down_loss;
      friction_loss += dampers[i].friction_loss;
      drag_loss += dampers[i].drag_loss;
      bounce_downs += dampers[i].bounce_downs;
      if (run_.impacts && !equal(section + "impact_loss", losses[i], dampers[i].impact_loss,
                                 rounded * std::abs(losses[i]), ", the sum over its impacts"))
        return;
      if (!require(dampers[i].bounce_downs > 0 || dampers[i].bounce_down_loss == 0,
                   section + "bounce_down_loss",
                   got("0 where there was no bounce-down to jump over", dampers[i].bounce_down_loss)))
        return;
    }
    const std::string of = ", the sum over all dampers";
    equal("/energy/impact_loss_total", impact_loss, loss, rounded * std::abs(loss), of);
    equal("/energy/contact_loss", contact_loss, balance.contact_loss, rounding * std::abs(contact_loss), of);
    equal("/energy/bounce_down_loss", bounce_down_loss, balance.bounce_down_loss,
          rounding * (1 + static_cast<double>(bounce_downs) / 64) * bounce_down_loss, of);
    equal("/energy/friction_loss", friction_loss, balance.friction_loss, rounding * friction_loss, of);
    equal("/energy/drag_loss", drag_loss, balance.drag_loss, rounding * drag_loss, of);
    require(bounce_downs == balance.bounce_downs, "/energy/bounce_downs",
            got(std::to_string(bounce_downs) + of, balance.bounce_downs));
  }

  // Compares the recorded residual with the one of the recorded terms. Its divisor, the initial energy plus
  // the integral of the force's |power|, is not recorded. It is at least the initial energy plus |the force's
  // work|, and at most what the force can do to a mass that keeps all energy: v^2/2 <= D and D <= E + f0 T
  // sqrt(2 D) bound D. With the component element method it is the largest energy seen.
  void examine_residual(const EnergyBalance& balance) {
    const std::vector<double>& losses = balance.impact_loss;
    const double begin = balance.initial.total(), end = balance.final.total(), put_in = balance.forcing_work;
    const double lost = balance.impact_loss_total() + balance.contact_loss + balance.bounce_down_loss +
                        balance.viscous_work + balance.friction_loss + balance.drag_loss;
    const double open = (begin + put_in) - (end + lost);
    const double sunk = cem_ ? 0 : scene_.weight * secondary_mass(scene_),
                 available = begin + sunk * sunk / 2;
    const double push = std::abs(scene_.force_amplitude) * run_.end_time / std::sqrt(2.0);
    const double root = push + std::sqrt(push * push + available);
    const double least = cem_ ? std::max({begin, end, std::abs(put_in)}) : available + std::abs(put_in);
    // The energy of the component element method has an error of the order of the step.
    const double bound = scene_.force_amplitude == 0 ? available : root * root;
    const double most = cem_ ? 2 * std::max(bound, least) : bound;
    double handled = std::abs(begin) + std::abs(put_in) + std::abs(end) + std::abs(balance.contact_loss) +
                     std::abs(balance.bounce_down_loss) + std::abs(balance.viscous_work) +
                     std::abs(balance.friction_loss) + std::abs(balance.drag_loss);
    for (const double loss : losses) handled += std::abs(loss);
    const double rounded = (1 + static_cast<double>(losses.size()) / 64) * rounding * handled;
    const double size = std::abs(balance.residual);
    const bool same_sign = open * balance.residual >= 0 || std::abs(open) <= rounded;
    require(same_sign && std::abs(open) <= size * most + rounded && std::abs(open) >= size * least - rounded,
            "/energy/residual",
            got("what the terms of the energy balance leave open, " + number_text(open) + ", by " +
                    number_text(least) + (most > least ? " to " + number_text(most) : ""),
                balance.residual));
  }

  const Run& run_;
  const Scene& scene_;
  const bool several_;
  const Cem* const cem_;
  Budget budget_;
  double step_ = 0;  // the longest step of the component element method, else 0
  std::vector<Problem> problems_;
};

}  // namespace

std::vector<Problem> inconsistencies_of(const Run& run) { return Examination(run).problems(); }

}  // namespace impact_damper
