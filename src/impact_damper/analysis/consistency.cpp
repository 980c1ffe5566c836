#include "impact_damper/analysis/consistency.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "impact_damper/base/number_text.hpp"

namespace impact_damper {
namespace {

// Numbers that two computations give differ by the rounding of a few dozen operations.
constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();

class Examination {
 public:
  explicit Examination(const Run& run) : run_(run), scene_(run.scene), cem_(std::get_if<Cem>(&run.engine)) {
    std::visit([&](const auto& engine) { budget_ = engine.budget; }, run.engine);
    if (cem_) step_ = cem_->large_step.value_or(cem_->time_step.value_or(0));
  }

  std::vector<Problem> problems() {
    examine_end();
    if (run_.half_cycles) examine_half_cycles(*run_.half_cycles);
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
  bool equal(const std::string& field, double wanted, double given, double tolerance, const std::string& of) {
    return require(std::abs(given - wanted) <= tolerance, field, got(number_text(wanted) + of, given));
  }

  // How far two events may be apart in time that are one: rounding, and the component element method sees an
  // event up to a step late.
  double instant(double time) const { return rounding * (1 + time) + 2 * step_; }
  // By how much x may differ between two ways to read it off the same motion, of which `scale` is the size of
  // x, x' and the force: rounding, and with the component element method the parabola through three steps,
  // whose curvature the walls make as large as k nu.
  double blur(double time, double scale) const {
    const double curvature = 1 + scene_.wall_stiffness * scene_.mass_ratio * step_;
    return rounding * (1 + time) * scale + step_ * step_ * curvature * (1 + scale);
  }

  void examine_end() {
    const double end = run_.end_time;
    const std::string field = "/end_time";
    if (scene_.until_time) {
      require(end <= *scene_.until_time, field,
              got("<= until_time, " + number_text(*scene_.until_time), end));
    }
    if (budget_.max_time) {
      require(end <= *budget_.max_time, field, got("<= max_time, " + number_text(*budget_.max_time), end));
    }
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
      require(used_up ? impacts == budget_.max_impacts : impacts <= budget_.max_impacts, "/impacts/time",
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
    // An impact at the release may turn x so early that the time of the peak is rounded to zero.
    const bool is_x0 = std::abs(first - x0) <= 4 * std::numeric_limits<double>::epsilon() * x0;
    require(rows.peak_time[0] == 0 ? is_x0 : first >= x0, section + "amplitude/0",
            got((rows.peak_time[0] == 0 ? "|x0| = " : ">= |x0| = ") + number_text(x0), first));
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
      // The component element method may see a mass that hardly moves arrive as it goes away again.
      const double least =
          -step_ * (1 + std::abs(impacts.displacement[i]) + std::abs(scene_.force_amplitude));
      if (!require(
              into >= least, section + "relative_velocity", i,
              got(impacts.wall[i] == Wall::left ? "<= 0 at the left wall" : ">= 0 at the right wall", w)))
        break;
    }
  }

  // Without rows: which impacts have a phase and an amplitude.
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
      for (std::int64_t n = 0; n < rows.impacts[row]; ++n, ++i) {
        const double time = impacts.time[i];
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
    for (std::size_t i = 0; i < contacts.begin.size(); ++i) {
      if (i > 0 &&
          !require(contacts.begin[i] >= contacts.end[i - 1], section + "begin", i,
                   got("at or after the end of the contact before it, " + number_text(contacts.end[i - 1]),
                       contacts.begin[i])))
        break;
      if (!require(contacts.end[i] <= run_.end_time, section + "end", i,
                   got("<= end_time, " + number_text(run_.end_time), contacts.end[i])))
        break;
    }
    if (!run_.impacts) return;
    const Impacts& impacts = *run_.impacts;
    if (is_rigid()) {
      std::size_t next = 0;
      for (std::size_t i = 0; i < impacts.time.size(); ++i) {
        const double time = impacts.time[i];
        while (next < contacts.end.size() && contacts.end[next] <= time) ++next;
        if (!require(next == contacts.end.size() || time <= contacts.begin[next], "/impacts/time", i,
                     got("in no stuck interval, such as from " +
                             number_text(next < contacts.begin.size() ? contacts.begin[next] : 0) + " on",
                         time)))
          break;
      }
      return;
    }
    const std::size_t without = contacts.begin.size() > impacts.time.size() ? 1 : 0;
    if (!require(contacts.begin.size() == impacts.time.size() + without &&
                     (without == 0 || contacts.begin[0] == 0),
                 section + "begin",
                 "must hold one contact for each of the " + std::to_string(impacts.time.size()) +
                     " impacts and at most one more, from the release on, got " +
                     std::to_string(contacts.begin.size())))
      return;
    for (std::size_t i = 0; i < impacts.time.size(); ++i) {
      if (!require(
              contacts.begin[i + without] == impacts.time[i], section + "begin", i + without,
              got("the time of its impact, " + number_text(impacts.time[i]), contacts.begin[i + without])))
        return;
      if (!require(contacts.wall[i + without] == impacts.wall[i], section + "wall", i + without,
                   "must be that of its impact"))
        return;
    }
  }

  void examine_history(const History& history) {
    const double f0 = std::abs(scene_.force_amplitude);
    if (history.time.empty()) return;
    require(history.time.back() <= run_.end_time, "/history/time", history.time.size() - 1,
            got("<= end_time, " + number_text(run_.end_time), history.time.back()));
    if (history.time[0] != 0) return;
    const double size = std::abs(scene_.x0) + std::abs(scene_.v0) + f0;
    if (!equal("/history/x/0", scene_.x0, history.x[0], rounding * size, ", x0")) return;
    equal("/history/y/0", scene_.y0, history.y[0],
          rounding * (1 + size + std::abs(scene_.y0) + std::abs(scene_.w0)), ", y0");
  }

  void examine_samples(const HalfCycles& rows, const History& history) {
    const std::vector<double>& crossings = rows.zero_crossing;
    const double f0 = std::abs(scene_.force_amplitude);
    // A wall may make x' as large as it ever is within a rounding of time. Between samples no more bounds it
    // with central differences, which see a crossing late, than the energy at the release and the force;
    // where they have put in more, nothing does.
    double fastest = std::max(f0, 2 * std::abs(scene_.w0));  // as an impact at the release may make it
    for (const auto* column : {&rows.amplitude, &history.x, &history.v})
      for (const double value : *column) fastest = std::max(fastest, std::abs(value));
    bool zeros_are_bounded = true;
    if (cem_) {
      const double nu = scene_.mass_ratio, z1 = scene_.v0 + scene_.w0,
                   depth = std::max({0.0, -scene_.y0, scene_.y0 - 1});
      const double bound =
          2 * (f0 * run_.end_time + std::sqrt(scene_.v0 * scene_.v0 + nu * z1 * z1 + scene_.x0 * scene_.x0 +
                                              scene_.wall_stiffness * depth * depth));
      zeros_are_bounded = fastest <= bound;
      fastest = bound;
    }
    std::size_t row = 0;        // of the sample
    bool side_is_told = false;  // that of the last sample whose sign is no matter of rounding
    double last_time = 0, last_x = 0, largest = 0;
    bool signs_hold = true, heights_hold = true, zeros_hold = true;
    for (std::size_t i = 0; i < history.time.size(); ++i) {
      const double time = history.time[i], x = history.x[i], near = instant(time);
      // An impact may have left no more of x and x' than the rounding of what they were.
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
      if (side_is_told && x * last_x < 0 && signs_hold) {
        const auto first = std::ranges::lower_bound(crossings, last_time - instant(last_time));
        signs_hold = require(first != crossings.end() && *first <= time + near, "/history/x", i,
                             got("of the same sign as " + number_text(last_x) + " at " +
                                     number_text(last_time) + ", as there is no zero crossing between",
                                 x));
      }
      side_is_told = true;
      last_time = time;
      last_x = x;
    }
  }

  void examine_energy(const EnergyBalance& balance) {
    const double nu = scene_.mass_ratio, e = scene_.restitution;
    const double depth = is_rigid() ? 0 : std::max({0.0, -scene_.y0, scene_.y0 - 1});
    examine_energy_at("/energy/initial/", balance.initial, scene_.x0, scene_.v0, scene_.w0,
                      scene_.wall_stiffness * depth * depth / 2, rounding);
    if (run_.history && !run_.history->time.empty() && run_.history->time.back() == run_.end_time) {
      const History& history = *run_.history;
      // Near resonance or in an overdamped motion a state carries the rounding of more than it is made of at
      // last; velocities of central differences are of second order.
      examine_energy_at("/energy/final/", balance.final, history.x.back(), history.v.back(), history.w.back(),
                        balance.final.wall, 1e-9 + step_ * step_);
    }
    const std::vector<double>& losses = balance.impact_loss;
    for (std::size_t i = 0; is_rigid() && run_.impacts && i < losses.size(); ++i) {
      const double w = run_.impacts->relative_velocity[i];
      const double loss = nu * (1 - e) * (1 + e) * w * w / (2 * (1 + nu));
      if (!equal("/energy/impact_loss/" + std::to_string(i), loss, losses[i], rounding * loss,
                 ", by its speed and the restitution"))
        break;
    }
    if (is_rigid()) equal("/energy/contact_loss", 0, balance.contact_loss, 0, ": rigid walls take no energy");
    if (!is_rigid() || balance.bounce_downs == 0) {
      require(balance.bounce_downs == 0, "/energy/bounce_downs",
              "must be 0 with compliant walls, got " + std::to_string(balance.bounce_downs));
      equal("/energy/bounce_down_loss", 0, balance.bounce_down_loss, 0,
            ": there was no bounce-down to jump over");
    }
    if (scene_.damping_ratio == 0)
      equal("/energy/viscous_work", 0, balance.viscous_work, 0, ": there is no damper");
    require(balance.viscous_work >= (cem_ ? -step_ * balance.initial.total() : 0.0), "/energy/viscous_work",
            got(">= 0", balance.viscous_work));
    if (scene_.force_amplitude == 0)
      equal("/energy/forcing_work", 0, balance.forcing_work, 0, ": there is no force");
    examine_residual(balance);
  }

  void examine_energy_at(const std::string& section, const Energy& energy, double x, double v, double w,
                         double wall, double part) {
    const double nu = scene_.mass_ratio, z1 = v + w;
    const double moving = (v * v + nu * (std::abs(v) + std::abs(w)) * (std::abs(v) + std::abs(w))) / 2;
    const double tolerance = part * (moving + x * x / 2 + wall);
    const std::string of = ", that of the state";
    equal(section + "kinetic", (v * v + nu * z1 * z1) / 2, energy.kinetic, tolerance, of);
    equal(section + "spring", x * x / 2, energy.spring, tolerance, of);
    equal(section + "wall", wall, energy.wall, tolerance, of);
    equal(section + "paper", (v * v + nu * (v * v + w * w) + x * x) / 2, energy.paper, tolerance, of);
  }

  // What it is divided by, the initial energy and the integral of the force's |power|, is not recorded. It is
  // at least |the force's work| and at most what the force can do to a mass that keeps all it is given: v^2/2
  // <= D and D <= E + f0 T sqrt(2 D) bound D. With the component element method it is the largest energy
  // seen.
  void examine_residual(const EnergyBalance& balance) {
    const std::vector<double>& losses = balance.impact_loss;
    const double begin = balance.initial.total(), end = balance.final.total(), put_in = balance.forcing_work;
    const double lost = std::accumulate(losses.begin(), losses.end(), 0.0) + balance.contact_loss +
                        balance.bounce_down_loss + balance.viscous_work;
    const double open = (begin + put_in) - (end + lost);
    const double push = std::abs(scene_.force_amplitude) * run_.end_time / std::sqrt(2.0);
    const double root = push + std::sqrt(push * push + begin);
    const double least = cem_ ? std::max({begin, end, std::abs(put_in)}) : begin + std::abs(put_in);
    // The component element method's energy is its own but for an error of the order of the step.
    const double bound = scene_.force_amplitude == 0 ? begin : root * root;
    const double most = cem_ ? 2 * std::max(bound, least) : bound;
    double handled = begin + std::abs(put_in) + end + std::abs(balance.contact_loss) +
                     std::abs(balance.bounce_down_loss) + std::abs(balance.viscous_work);
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
  const Cem* const cem_;
  Budget budget_;
  double step_ = 0;  // the longest of the component element method, else 0
  std::vector<Problem> problems_;
};

}  // namespace

std::vector<Problem> inconsistencies_of(const Run& run) { return Examination(run).problems(); }

}  // namespace impact_damper
