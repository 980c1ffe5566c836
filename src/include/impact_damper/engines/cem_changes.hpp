// The changes in one step of the component element method: masses that come to a wall or leave it, and which
// of them come to stick to it or cease to, where the option Cem::stuck_speed allows sticking; and with
// friction masses that come to rest in their cavities, or that it ceases to hold there.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "impact_damper/engines/cem_balance.hpp"
#include "impact_damper/engines/cem_steps.hpp"

namespace impact_damper {

// A mass that came to a wall or left it in the last step, the time of this since the beginning of the step,
// and whether the mass sticks to the wall from then on.
template <class Real>
struct CemChange {
  std::size_t index;
  Real at;
  bool joins = false;
  bool slips = false;  // by friction: it comes to rest, or does so no more, and meets or leaves no wall
};

template <class Real, template <class> class ForEach>
class CemChanges {
  using Masses = CemMasses<Real, ForEach>;
  using State = typename Masses::State;
  using Change = CemChange<Real>;

 public:
  CemChanges(Masses& masses, const CemSteps<Real, ForEach>& steps, std::optional<double> stuck_speed)
      : masses_(masses), steps_(steps), stuck_speed_(stuck_speed) {}

  // Sets the list to the changes of the last step, in the order of time. Throws NumericalError if x or y is
  // not finite.
  void find() {
    all_.clear();
    bool finite = std::isfinite(double(steps_.x().x));
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const auto& m = masses_[i];
      finite = finite && std::isfinite(double(m.now.x));
      if (m.stuck) {
        if (const auto at = parting(m)) all_.push_back({i, *at, false, masses_.has_components()});
      } else if (masses_.has_components() && !m.slides_on(m.before.dx, m.now.dx)) {
        all_.push_back({i, m.arc(steps_.h()).extremum(Real(0), steps_.h()), false, true});
      }
      if (!(m.now.x >= m.least && m.now.x <= m.most)) all_.push_back({i, wall_crossing(m)});
    }
    if (!finite) fail_of_overflow(double(steps_.begin()), double(steps_.h()));
    if constexpr (!Masses::one) {
      std::sort(all_.begin(), all_.end(), [&](const Change& some, const Change& other) {
        const double at = time_of(some), then = time_of(other);
        return at < then || (at == then && masses_[some.index].number < masses_[other.index].number);
      });
    }
  }
  const std::vector<Change>& all() const { return all_; }
  // Removes the changes later than the time `time` of the run.
  void erase_after(const Real& time) {
    std::erase_if(all_, [&](const Change& each) { return steps_.begin() + each.at > time; });
  }
  // Keeps the changes of the earliest time, to double precision, and gives them one time. The motion begins
  // anew there, and its first step finds the later ones. The list must not be empty.
  void keep_first() {
    const Real first = std::ranges::min_element(all_, {}, &Change::at)->at;
    std::erase_if(all_, [&](const Change& each) { return time_of(each) > time_of({0, first}); });
    for (Change& each : all_) each.at = first;
  }

  // Decides which of the masses join, by Cem::stuck_speed. Returns whether any mass joins, one that is stuck
  // parts, or one slides no more.
  bool find_joining() {
    bool any = false;
    for (Change& change : all_) {
      change.joins = stuck_speed_ && joins(change);
      any = any || change.joins || change.slips || masses_[change.index].stuck;
    }
    return any;
  }
  bool any_joins() const { return std::ranges::any_of(all_, &Change::joins); }
  // Makes the masses that join stick to their walls, and sets x' and all y' of the state s to those after it
  // (M17.24), for one damper (M9.10). The energy lost (M9.11) is added to the losses of the contacts that
  // begin.
  void join(State& s) {
    std::vector<std::size_t> joining;
    for (const Change& change : all_)
      if (change.joins) joining.push_back(change.index);
    if constexpr (!Masses::one) std::ranges::sort(joining);
    const Real before = masses_.joined;
    for (const std::size_t i : joining) masses_.set_wall(i, masses_[i].wall, true);
    Real gain = 0;  // of x'
    for (const std::size_t i : joining) {
      auto& m = masses_[i];
      Real excess = before * s.w[i];
      for (const std::size_t j : joining) excess += masses_[j].nu * (s.w[i] - s.w[j]);
      m.work += m.nu / masses_.joined * s.w[i] * excess / 2;
      gain += m.nu / masses_.joined * s.w[i];
    }
    s.v += gain;
    for (std::size_t i = 0; i < masses_.size(); ++i)
      s.w[i] = masses_[i].stuck ? Real(0) : Real(s.w[i] - gain);
  }
  // To be called after an impact of the i-th mass on `wall` with the relative velocity w. It pushes the
  // primary mass into the masses that are stuck to the other wall. Where they may meet it at stuck_speed or
  // faster, these are no longer stuck, but in contact with that wall.
  void release_other_side(std::size_t i, Wall wall, const Real& w) {
    const Real& nu = masses_[i].nu;
    if (!stuck_speed_ || masses_.joined == 1 || 2 * nu / (1 + nu) * absolute(w) < Real(*stuck_speed_)) return;
    for (std::size_t other = 0; other < masses_.size(); ++other)
      if (masses_[other].stuck && masses_[other].wall != wall) masses_.set_wall(other, masses_[other].wall);
  }

 private:
  double time_of(const Change& change) const { return double(steps_.begin() + change.at); }
  // Returns the time in the last step at which a mass came to a wall or left it.
  Real wall_crossing(const CemMass<Real>& m) const {
    const Real& h = steps_.h();
    const bool falls = m.wall == Wall::right || (!m.wall && m.now.x < 0);
    Arc<Real> gap = m.arc(h).times(falls ? Real(1) : Real(-1));
    if (!m.wall && !falls) gap.g += m.clearance;
    return gap.fall(h);
  }
  // Returns the time in the last step at which x'' passed one of its limits for a stuck mass, at which the
  // wall ceases to push or friction to hold it; nothing if it did not.
  std::optional<Real> parting(const CemMass<Real>& m) const {
    const Real &h = steps_.h(), least = h * h * m.least_second, most = h * h * m.most_second;
    const Real before = steps_.second_before(), after = steps_.second_after();
    const bool falls = after < least;
    if (!falls && !(after > most)) return {};
    const Real from = falls ? Real(before - least) : Real(most - before);
    const Real to = falls ? Real(after - least) : Real(most - after);
    return from > 0 ? h * from / (from - to) : Real(0);
  }
  // Whether a touch begins the stuck regime (M9.9).
  bool joins(const Change& touch) const {
    const auto& m = masses_[touch.index];
    if (m.wall) return false;
    State s = steps_.refined_state_at(touch.at);
    const Real w = s.w[touch.index], mass = masses_.joined + m.nu;
    const Real towards = m.now.x < 0 ? Real(1) : Real(-1);
    s.v += m.nu / mass * w;
    return absolute(w) < Real(*stuck_speed_) &&
           towards * masses_.second_of_x(steps_.begin() + touch.at, s, mass) > 0;
  }

  Masses& masses_;
  const CemSteps<Real, ForEach>& steps_;
  const std::optional<double> stuck_speed_;
  std::vector<Change> all_;
};

}  // namespace impact_damper
