// The equations of hybrid_system.hpp for N dampers on one primary mass, without a force, and without
// sticking: on rigid walls no secondary mass may come to rest.
//
// The state is (x, x', y1, y1', y2, y2', ...); each secondary mass is free or in contact by itself,
//   x'' + 2 zeta x' + x = sum of nu F,      y'' = -F - x'',      F = c y' + (k/nu) q in contact, else 0.
#pragma once

#include <array>
#include <cmath>
#include <stdexcept>

#include "contender.hpp"

namespace impact_damper::bench {

template <class Number, std::size_t N>
class SeveralDampers {
 public:
  using Real = Number;
  using State = std::array<Real, 2 + 2 * N>;
  // Two guards for each secondary mass, falling; then x and x', either way.
  static constexpr std::size_t guards = 2 * N;
  static constexpr std::size_t events = guards + 2;
  // All fly, or somebody is in contact.
  static constexpr std::size_t paces = 2;

  SeveralDampers(const Scene& scene, Walls walls)
      : rigid_(walls == Walls::rigid), two_zeta_(2 * Real(scene.damping_ratio)) {
    using std::acos, std::log, std::sqrt;
    if (scene.force_amplitude != 0) throw std::invalid_argument("no force on several dampers");
    state[0] = scene.x0;
    state[1] = scene.v0;
    const Real pi = acos(Real(-1));
    for (std::size_t i = 0; i < N; ++i) {
      const SceneDamper& d = scene.dampers.at(i);
      const Real nu(d.mass_ratio), e(d.restitution), stiffness = Real(d.wall_stiffness) / nu;
      Real zeta_m = 1;
      if (e > 0) {
        const Real l = -log(e);
        zeta_m = l / sqrt(Real(pi * pi + l * l));
      }
      dampers_[i] = {nu, e, Real(d.clearance), stiffness, 2 * sqrt(stiffness) * zeta_m};
      state[2 + 2 * i] = d.y0;
      state[3 + 2 * i] = d.w0;
      const Real contact_time = pi / sqrt(Real(stiffness * (1 + nu)));
      if (i == 0 || contact_time < contact_time_) contact_time_ = contact_time;
    }
  }

  std::size_t pace() const { return in_contact_ > 0 ? 1 : 0; }
  Real longest_step(std::size_t pace) const { return pace == 0 ? Real(0.5) : Real(contact_time_ / 2); }

  void derivative(const State& u, State& du, const Real&) const {
    du[0] = u[1];
    du[1] = -two_zeta_ * u[1] - u[0];
    if (in_contact_ > 0) {
      for (std::size_t i = 0; i < N; ++i)
        if (dampers_[i].place != Place::free) du[1] += dampers_[i].nu * wall(i, u);
    }
    for (std::size_t i = 0; i < N; ++i) {
      du[2 + 2 * i] = u[3 + 2 * i];
      du[3 + 2 * i] = -du[1];
      if (dampers_[i].place != Place::free) du[3 + 2 * i] -= wall(i, u);
    }
  }

  Real event(std::size_t which, const State& u, const Real&) const {
    if (which >= guards) return u[which - guards];
    const Damper& d = dampers_[which / 2];
    const Real &y = u[2 + which / 2 * 2], beyond = d.clearance - y;
    const bool first = which % 2 == 0;
    if (d.place == Place::free) return first ? y : beyond;
    return !first ? Real(1) : d.place == Place::left ? Real(-y) : Real(-beyond);
  }
  Real event_rate(std::size_t which, const State& u, const Real&) const {
    if (which == guards) return u[1];
    if (which > guards) {
      State du;
      derivative(u, du, 0);
      return du[1];
    }
    const Place place = dampers_[which / 2].place;
    const bool falls = place == Place::free ? which % 2 == 1 : place == Place::left;
    return falls ? Real(-u[3 + which / 2 * 2]) : u[3 + which / 2 * 2];
  }
  bool flies(std::size_t guard) const { return dampers_[guard / 2].place == Place::free; }
  // Where in a state the rate of the gap stands whose guard this is.
  static constexpr std::size_t speed_of(std::size_t guard) { return 3 + guard / 2 * 2; }

  // As HybridSystem::pass.
  bool pass(std::size_t guard, State& u, const Real&) {
    Damper& d = dampers_[guard / 2];
    Real &y = u[2 + guard / 2 * 2], &w = u[3 + guard / 2 * 2];
    if (d.place != Place::free) {
      y = d.place == Place::left ? Real(0) : d.clearance;
      d.place = Place::free;
      --in_contact_;
      return false;
    }
    const bool left = guard % 2 == 0;
    y = left ? Real(0) : d.clearance;
    if (!rigid_) {
      d.place = left ? Place::left : Place::right;
      ++in_contact_;
      return true;
    }
    const Real jump = d.nu * (1 + d.e) * w / (1 + d.nu);
    u[1] += jump;
    for (std::size_t j = 0; j < N; ++j)
      if (j != guard / 2) u[3 + 2 * j] -= jump;
    w *= -d.e;
    const Real push = (left ? 1 : -1) * (-two_zeta_ * u[1] - u[0]), speed = left ? w : -w;
    if (push > 0 && 2 * speed < Real(1e-6) * push * (1 - d.e))
      throw std::runtime_error("a secondary mass comes to rest");
    return true;
  }

 private:
  enum class Place : char { free, left, right };
  struct Damper {
    Real nu, e, clearance, stiffness, damping;
    Place place = Place::free;
  };
  Real wall(std::size_t i, const State& u) const {
    const Damper& d = dampers_[i];
    const Real q = d.place == Place::left ? u[2 + 2 * i] : Real(u[2 + 2 * i] - d.clearance);
    return d.damping * u[3 + 2 * i] + d.stiffness * q;
  }

  bool rigid_;
  Real two_zeta_, contact_time_{0};
  std::array<Damper, N> dampers_;
  std::size_t in_contact_ = 0;

 public:
  State state{};  // the initial one
};

}  // namespace impact_damper::bench
