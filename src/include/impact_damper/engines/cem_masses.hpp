// The masses of the component element method (docs/mathematics.md, 9 and 17.5), and the equations that give
// their accelerations. Only x couples the secondary masses. Each is in flight, in contact with a wall, or
// stuck to one, by itself.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "impact_damper/engines/cem_scheme.hpp"
#include "impact_damper/engines/damper_order.hpp"
#include "impact_damper/motion/force_law.hpp"
#include "impact_damper/motion/lead.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// ForEach of the classes cem_*: the container for what there is of each secondary mass, for a scene of one
// damper and for a list.
template <class T>
using ForOne = std::array<T, 1>;
template <class T>
using ForSeveral = std::vector<T>;

// A secondary mass: its q is y in flight and at the left wall, y - clearance at the right one.
template <class Real>
struct CemMass {
  std::int32_t number;  // in the scene
  Real nu, k, clearance;
  Real c, omega_2;  // of its wall, whether the mass is there or not; of a wall with a law (M18.16), at q
  std::int64_t steps_of_contact;         // small steps in the nominal contact time
  Real friction, static_friction, drag;  // phi, phi_s and d of chapter 18
  std::optional<Wall> wall{};            // the wall it is at, in contact or stuck
  bool stuck = false;                    // to the primary mass: to a wall, or held by friction
  Real slides{};                         // with friction the sign of y' while it slides, else 0
  Real least_second{}, most_second{};    // limits of x'' while it stays stuck
  CemMoment<Real> before{}, now{};       // q before and after the last step
  // For a list: dq_{n+1} = dq_dq dq_n + dq_q q_n + dq_dx (dx_n - dx_{n+1}) + dq_1,
  // dx_{n+1} = ... + dx_dq dq_n + dx_q q_n.
  Real dq_dq = 1, dq_q = 0, dq_dx = 1, dq_1 = 0, dx_dq = 0, dx_q = 0;
  Real least{}, most{};  // limits of q while nothing changes
  Real contact_begin = 0;
  std::optional<std::size_t> impact{};  // the one that began the contact
  Real work = 0, sum_ww = 0;  // lost at the wall in this contact; sum of (2 h w)^2 not yet added to it
  Real slid_from = 0;         // y at the beginning of the segment
  Real friction_loss = 0, drag_loss = 0, sum_drag = 0;  // sum_drag: as sum_ww, with w centred
  Real impact_loss = 0, contact_loss = 0, loss = 0;  // past contacts, with and without an impact; their sum

  Real origin_of_q() const { return wall == Wall::right ? clearance : Real(0); }
  Real push() const { return wall == Wall::left ? Real(1) : Real(-1); }  // sign of the wall's push
  Wall wall_ahead() const { return now.x > clearance / 2 ? Wall::right : Wall::left; }
  Arc<Real> arc(const Real& h) const { return arc_of(before, now, h); }
  // Whether it still slides the same way, or not at all, at the end of a step with the increment dq; that of
  // the step before is last_dq.
  bool slides_on(const Real& last_dq, const Real& dq) const { return slides * (3 * dq - last_dq) >= 0; }
  // The coefficients of y' and q in the force between it and the primary mass, divided by its mass.
  Real resistance() const { return wall ? Real(c + drag) : drag; }
  Real spring() const { return wall ? omega_2 : Real(0); }
};

// The state of all masses: x and x', and q and q' of each secondary mass.
template <class Real, template <class> class ForEach>
struct CemState {
  Real x, v;
  ForEach<Real> q, w;
};

// A wall with the force of (M18.13), divided by the secondary mass. The laws are computed in double.
struct WallWithLaw {
  double nu, chi;  // nu: 0 if the wall is linear
  ForceLaw law;

  double force(double q) const { return law.force(q) / nu; }
  double resistance(double q) const { return chi * absolute(force(q)); }
  // The derivative of the force by q, at the velocity w.
  double slope(double q, double w = 0) const { return law.slope(q) / nu * (1 + chi * (q < 0 ? -w : w)); }
};

template <class Real, template <class> class ForEach>
struct CemMasses {
  static constexpr bool one = std::is_same_v<ForEach<Real>, ForOne<Real>>;
  using State = CemState<Real, ForEach>;

  // All in flight.
  CemMasses(const Scene& scene, const Cem& options)
      : zeta(scene.damping_ratio),
        force{Real(scene.force_amplitude), Real(scene.force_frequency)},
        weight(scene.weight),
        components_(!is_ideal(scene)),
        watches_slopes_(!options.unstable),
        lagged_(options.damper == Damper::lagged) {
    const auto keep = [&](std::size_t place, std::int32_t number) {
      const SceneDamper& its = scene.dampers[number];
      const auto wall = regime_equations<Real>(scene, its, options.calibration, Regime::contact);
      const double steps = nominal_contact_time(its) / double(Real(*options.time_step));
      all[place] = {number,        wall.nu,      its.wall_stiffness, its.clearance,
                    wall.c,        wall.omega_2, whole_steps(steps), its.friction,
                    its.holding(), its.drag};
    };
    if constexpr (one) {
      keep(0, 0);  // a sort of one is a sixtieth of the packed module for browsers
    } else {
      all.resize(scene.dampers.size());
      std::size_t place = 0;
      for (const std::int32_t number : damper_order(scene.dampers)) keep(place++, number);
      for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i].drag != 0) coupled.push_back(i);
      if (impact_damper::has_laws(scene)) set_laws(scene);
    }
  }

  // Whether the scene has friction, drag, weight or laws. With ForOne it has not.
  bool has_components() const { return !one && components_; }
  // Whether a wall or the primary spring has a law other than the linear one.
  bool has_laws() const { return !one && !laws_.empty(); }
  std::size_t size() const { return all.size(); }
  const CemMass<Real>& operator[](std::size_t i) const { return all[i]; }
  CemMass<Real>& operator[](std::size_t i) { return all[i]; }
  // Returns value(i) of each mass.
  template <class Value>
  ForEach<Real> of_each(Value&& value) const {
    if constexpr (one) {
      return {value(0)};
    } else {
      std::vector<Real> values(size());
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(i);
      return values;
    }
  }

  // Sets the wall to which a mass sticks, or with which it is in contact; without a wall it is in flight. y
  // stays as it is.
  void set_wall(std::size_t i, std::optional<Wall> wall, bool stuck = false) {
    CemMass<Real>& m = all[i];
    const Real smallest = std::numeric_limits<Real>::denorm_min();
    const Real infinity = std::numeric_limits<Real>::infinity();
    const Real old_origin = m.origin_of_q();
    const bool was_stuck = std::exchange(m.stuck, stuck);
    m.wall = wall;
    m.before.x += old_origin - m.origin_of_q();
    m.now.x += old_origin - m.origin_of_q();
    if (!wall || stuck) m.dq_dq = m.dq_dx = Real(!stuck), m.dq_q = m.dx_dq = m.dx_q = 0;
    m.least = !wall || stuck ? Real(0) : wall == Wall::left ? -infinity : smallest;
    m.most = !wall ? m.clearance : stuck ? Real(0) : wall == Wall::left ? -smallest : infinity;
    if (!has_components()) {
      m.least_second = wall == Wall::left ? Real(0) : -infinity;
      m.most_second = wall == Wall::left ? infinity : Real(0);
    } else if (stuck) {  // held by friction, wherever it is
      m.least = -infinity;
      m.most = infinity;
    }
    if constexpr (one) {
      coupled.resize(wall && !stuck ? 1 : 0);
    } else {
      std::erase(coupled, i);
      if (!stuck && (wall || m.drag != 0)) coupled.insert(std::ranges::lower_bound(coupled, i), i);
    }
    if (!stuck && !was_stuck) return;
    joined = 1;
    least_second = -infinity;
    most_second = infinity;
    for (const CemMass<Real>& each : all) {
      if (!each.stuck) continue;
      joined += each.nu;
      least_second = std::max(least_second, each.least_second);
      most_second = std::min(most_second, each.most_second);
    }
  }

  // Sets which of the masses that do not move in their cavities friction holds, as many as it can, and which
  // way the others with friction slide (18.2), in the state s with q. freed: masses that it just ceased to
  // hold.
  void hold(const Real& time, const State& s, const std::vector<std::size_t>& freed) {
    const Real second_before = second_of_x(time, s);
    for (std::size_t i = 0; i < size(); ++i) {
      CemMass<Real>& m = all[i];
      if (m.static_friction == 0) continue;
      const Real at_rest = -(weight + spring_force(i, s.q[i]));  // x'' that needs no friction
      m.least_second = at_rest - m.static_friction;
      m.most_second = at_rest + m.static_friction;
      const bool is_freed = std::ranges::find(freed, i) != freed.end(), holds = s.w[i] == 0 && !is_freed;
      if (is_freed) m.slides = Real(second_before < at_rest ? 1 : -1);
      if (s.w[i] != 0) m.slides = Real((s.w[i] > 0) - (s.w[i] < 0));
      if (holds || m.stuck) set_wall(i, m.wall, holds);
    }
    for (;;) {
      const Real second = second_of_x(time, s);
      std::optional<std::size_t> first;
      Real most = 0;
      for (std::size_t i = 0; i < size(); ++i) {
        const Real excess = std::max(all[i].least_second - second, second - all[i].most_second);
        if (all[i].stuck && excess > most) first = i, most = excess;
      }
      if (!first) return;
      CemMass<Real>& m = all[*first];
      m.slides = Real(second < m.least_second ? 1 : -1);
      set_wall(*first, m.wall);
    }
  }

  // Sets the walls of all masses at a release in the state s, which has y instead of q and is given q. No
  // impact begins the contacts of these masses:
  // - those that overlap a wall;
  // - those at rest at a wall and pressed to it, unless friction holds them; they are stuck if `joins`.
  //   They are pressed if y'' h^2/2 + y''' h^3/6, the way of such a mass in one step, leads into the wall. If
  //   `joins`, and y'' and y''' are zero to rounding, the first later derivative that is not zero decides
  //   instead.
  // Returns y'' and y''' of a mass at rest in flight.
  std::pair<Real, Real> begin_contacts(State& s, const Real& h, bool joins) {
    const auto begin_contact = [&](std::size_t i, std::optional<Wall> wall, bool sticks = false) {
      set_wall(i, wall, sticks);
      s.q[i] -= all[i].origin_of_q();
    };
    for (std::size_t i = 0; i < size(); ++i)
      begin_contact(i, s.q[i] < 0                  ? std::optional(Wall::left)
                       : s.q[i] > all[i].clearance ? std::optional(Wall::right)
                                                   : std::nullopt);
    if (has_components()) hold(Real(0), s, {});
    const Real second = -(second_of_x(Real(0), s) + weight),
               third = primary_slope(s.x) * s.v - force.amplitude * force.frequency;
    const Lead<Real> lead = lead_of_x(Real(2 * zeta), Real(1), force, force.phase(Real(0)), s.x, s.v);
    const bool by_lead = joins && lead.order > 3 && coupled.empty();
    const Real moves = by_lead ? Real(-lead.value) : Real(second + h / 3 * third);
    for (std::size_t i = 0; i < size(); ++i) {
      if (!rests(s, i) || all[i].stuck) continue;
      if (s.q[i] == 0 && moves < 0) begin_contact(i, Wall::left, joins);
      if (s.q[i] > 0 && moves > 0) begin_contact(i, Wall::right, joins);
    }
    return {second, third};
  }

  Real y(const State& s, std::size_t i) const { return all[i].origin_of_q() + s.q[i]; }
  // Whether a mass is at rest exactly at a wall.
  bool rests(const State& s, std::size_t i) const {
    const Real at = y(s, i);
    return (at == 0 || at == all[i].clearance) && s.w[i] == 0;
  }
  // Whether a mass is exactly at a wall and moves into it.
  bool meets_wall(const State& s, std::size_t i) const {
    const Real at = y(s, i), &w = s.w[i];
    return (at == 0 && w < 0) || (at == all[i].clearance && w > 0);
  }
  Real force_at(const Real& time) const { return value_of(force, time); }
  Real wall_force(const State& s, std::size_t i) const {  // divided by the secondary mass
    const CemMass<Real>& m = all[i];
    return m.wall && !m.stuck ? m.c * s.w[i] + m.omega_2 * s.q[i] : Real(0);
  }
  // The law of the wall at which the i-th mass is, if it is not linear; else null.
  const WallWithLaw* law_of(std::size_t i) const {
    return has_laws() && all[i].wall && laws_[i].nu != 0 ? &laws_[i] : nullptr;
  }
  // The force of q, divided by the secondary mass, and the coefficient of q'.
  Real spring_force(std::size_t i, const Real& q) const {
    const WallWithLaw* const law = law_of(i);
    return law ? Real(law->force(double(q))) : Real(all[i].spring() * q);
  }
  Real resistance(std::size_t i, const Real& q) const {
    const WallWithLaw* const law = law_of(i);
    return law ? Real(law->resistance(double(q)) + all[i].drag) : all[i].resistance();
  }
  // Twice the energy of the wall at which the i-th mass is.
  Real wall_energy(std::size_t i, const Real& q) const {
    const WallWithLaw* const law = law_of(i);
    return law ? Real(2 * law->law.energy(double(q))) : all[i].wall ? Real(all[i].k * q * q) : Real(0);
  }
  // The force of the primary spring, and its slope.
  Real primary_force(const Real& x) const { return has_laws() ? Real(spring_->force(double(x))) : x; }
  Real primary_slope(const Real& x) const { return has_laws() ? Real(spring_->slope(double(x))) : Real(1); }
  double primary_energy(const Real& x) const { return spring_->energy(double(x)); }  // has_laws()
  // The force R of (M18.1) on the primary mass, divided by the secondary mass; 0 if that is stuck.
  Real force_of(const State& s, std::size_t i) const {
    const CemMass<Real>& m = all[i];
    if (!has_components()) return wall_force(s, i);
    return m.stuck ? Real(0)
                   : resistance(i, s.q[i]) * s.w[i] + spring_force(i, s.q[i]) + m.friction * m.slides;
  }
  // With laws: sets c and omega_2 of the walls to what they are at the present q (M18.16). Throws
  // NumericalError where h is longer than the slopes there allow (M18.18). x: at `time`.
  void set_secants(const Real& time, const Real& x, const Real& h) {
    Real all_b{0};
    bool stable = true;
    for (const std::size_t i : coupled) {
      CemMass<Real>& m = all[i];
      Real slope = m.spring();
      if (const WallWithLaw* const law = law_of(i)) {
        const double q = double(m.now.x);
        m.c = law->resistance(q);
        m.omega_2 = q == 0 ? law->slope(q) : law->force(q) / q;
        slope = law->slope(q);
      }
      if (!m.wall) continue;
      const Real b = h * ((lagged_ ? Real(2 * m.c) : Real(0)) + h * slope);
      stable = stable && b < 4;
      all_b += 4 * m.nu * b / (4 - b);
    }
    if (watches_slopes_ && !(stable && all_b <= 4 - h * h * primary_slope(x)))
      fail_of_slope(double(time), double(h));
  }
  // The sum of the primary mass and all masses at walls, divided by the primary mass.
  Real with_walls() const {
    Real mass = joined;
    for (const std::size_t i : coupled) mass += all[i].nu;
    return mass;
  }
  // x'' by (M9.5) with `mass` in place of 1 + nu.
  Real second_as_one(const Real& time, const State& s, const Real& mass) const {
    return (force_at(time) - 2 * zeta * s.v - s.x) / mass;
  }
  // x'' by (M17.9), with components by (M18.3), with `mass` for the primary mass and the masses joined to it.
  Real second_of_x(const Real& time, const State& s, const Real& mass) const {
    if (mass > 1 && coupled.empty() && !has_components()) return second_as_one(time, s, mass);
    Real sum = force_at(time);
    if (has_components()) {
      for (std::size_t i = 0; i < size(); ++i) sum += all[i].nu * force_of(s, i);
      sum -= (mass - 1) * weight;
    } else {
      for (const std::size_t i : coupled) sum += all[i].nu * wall_force(s, i);
    }
    return (sum - (2 * zeta * s.v + primary_force(s.x))) / mass;
  }
  Real second_of_x(const Real& time, const State& s) const { return second_of_x(time, s, joined); }
  Real second_of_q(const State& s, std::size_t i, const Real& x2) const {  // x2: x''
    return all[i].stuck ? Real(0) : Real((-force_of(s, i) - x2) - weight);
  }
  // y''' of a mass in flight where x'' = 0.
  Real third_of_y(const Real& time, const State& s) const {
    Real third = s.v - rate_of(force, time);
    for (const std::size_t i : coupled)
      third -= all[i].nu * (all[i].omega_2 * s.w[i] - all[i].c * wall_force(s, i));
    return third;
  }
  // The same of a mass that friction ceases to hold.
  Real third_where_freed(const Real& time, const State& s) const {
    const Real second = second_of_x(time, s);
    Real sum = rate_of(force, time) - 2 * zeta * second - primary_slope(s.x) * s.v;
    for (const std::size_t i : coupled) {
      const WallWithLaw* const law = law_of(i);
      const Real slope = law ? Real(law->slope(double(s.q[i]), double(s.w[i]))) : all[i].spring();
      sum += all[i].nu * (resistance(i, s.q[i]) * second_of_q(s, i, second) + slope * s.w[i]);
    }
    return -sum / joined;
  }

  Real zeta;
  Forcing<Real> force;
  Real weight;                 // gamma
  ForEach<CemMass<Real>> all;  // in the order of damper_order.hpp
  // Masses in contact or with drag, on which a force of q or q' acts, that are not stuck; ascending.
  std::vector<std::size_t> coupled;
  Real joined = 1;                     // the primary mass and those stuck to it, divided by the first
  Real least_second{}, most_second{};  // limits of x'' while these stay stuck

 private:
  void set_laws(const Scene& scene) {
    spring_ = ForceLaw::of_spring(scene.spring);
    for (const CemMass<Real>& m : all) {
      const SceneDamper& its = scene.dampers[m.number];
      const bool linear = its.wall.law == WallForm::linear;
      laws_.push_back(
          {linear ? 0 : its.mass_ratio, linear ? 0 : loss_factor_of(its), ForceLaw::of_wall(its)});
    }
  }

  bool components_, watches_slopes_, lagged_;
  std::vector<WallWithLaw> laws_;  // as `all`, empty if all is linear
  std::optional<ForceLaw> spring_;
};

}  // namespace impact_damper
