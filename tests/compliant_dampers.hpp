// What the tests of several dampers with compliant walls (cem_dampers.cpp, exact_dampers.cpp) share: a Taylor
// series in long double that shares nothing with either engine, scenes, and how far runs are apart.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "impact_damper/simulate.hpp"
#include "list_of_one.hpp"

namespace compliant_dampers {

using namespace impact_damper;

// The compliant equations of several dampers by their Taylor series, the steps a quarter of a radian of the
// stiffest wall; a wall that is met or left within one is bisected, where 16 points of the step show it.
class Reference {
 public:
  using Real = long double;
  struct Impact {
    double time;
    int damper;
    double w;
  };

  Reference(const Scene& scene, const std::vector<double>& times)
      : scene_(scene), now_(scene.dampers.size()) {
    x_ = scene.x0, v_ = scene.v0;
    losses.resize(now_.size());
    Real fastest = 1;
    for (std::size_t i = 0; i < now_.size(); ++i) {
      const SceneDamper& d = scene.dampers[i];
      const Real l = -std::log(Real(d.restitution)), pi = std::numbers::pi_v<Real>;
      now_[i] = {d.y0, d.w0, d.mass_ratio, d.clearance, Real(d.wall_stiffness) / d.mass_ratio};
      now_[i].damping = 2 * std::sqrt(now_[i].stiffness) * l / std::sqrt(pi * pi + l * l);
      if (d.restitution == 0) now_[i].damping = 2 * std::sqrt(now_[i].stiffness);
      now_[i].wall = d.y0 < 0 ? -1 : d.y0 > d.clearance ? 1 : 0;
      fastest = std::max(fastest, std::sqrt(now_[i].stiffness * (1 + now_[i].nu)));
    }
    for (const double time : times) {
      while (time_ < time) advance(std::min(Real(0.25) / fastest, Real(time) - time_), time);
      x.push_back(double(x_));
      for (std::size_t i = 0; i < now_.size(); ++i) y.push_back(double(now_[i].y));
    }
  }

  std::vector<double> x, y;  // at the times; of all dampers
  std::vector<Impact> impacts;
  std::vector<double> losses;  // of each damper's wall
  double viscous = 0;
  int most_in_contact = 0;

 private:
  static constexpr int order = 16;
  using Series = std::array<Real, order + 1>;
  struct Mass {
    Real y, w, nu, clearance, stiffness, damping = 0;
    int wall = 0;  // -1: in contact with the left one
    Series series{};
    Real place() const { return wall > 0 ? clearance : 0; }
  };

  static Real at(const Series& s, Real t) {
    Real sum = 0;
    for (int k = order; k >= 0; --k) sum = sum * t + s[k];
    return sum;
  }
  static Real slope_at(const Series& s, Real t) {
    Real sum = 0;
    for (int k = order; k >= 1; --k) sum = sum * t + k * s[k];
    return sum;
  }
  static Real square_of_slope(const Series& s, Real t) {  // its integral
    Real sum = 0;
    for (int j = 1; j <= order; ++j)
      for (int k = 1; k <= order; ++k) sum += j * k * s[j] * s[k] * std::pow(t, j + k - 1) / (j + k - 1);
    return sum;
  }
  void expand() {
    series_[0] = x_, series_[1] = v_;
    for (Mass& m : now_) m.series[0] = m.y - m.place(), m.series[1] = m.w;
    Real f = scene_.force_amplitude;
    const Real omega = scene_.force_frequency;
    for (int k = 0; k + 2 <= order; ++k) {
      const Real phase = omega * time_ + k * std::numbers::pi_v<Real> / 2;
      Real x2 = f * std::sin(phase) - 2 * Real(scene_.damping_ratio) * (k + 1) * series_[k + 1] - series_[k];
      const auto force = [&](const Mass& m) {
        return m.wall == 0 ? 0 : m.damping * (k + 1) * m.series[k + 1] + m.stiffness * m.series[k];
      };
      for (const Mass& m : now_) x2 += m.nu * force(m);
      series_[k + 2] = x2 / ((k + 1) * (k + 2));
      for (Mass& m : now_) m.series[k + 2] = (-force(m) - x2) / ((k + 1) * (k + 2));
      f *= omega / (k + 1);
    }
  }
  static bool stays(const Mass& m, Real t) {
    const Real q = at(m.series, t);
    return m.wall == 0 ? q >= 0 && q <= m.clearance : m.wall * q > 0;
  }
  void advance(Real h, double until) {
    expand();
    Mass* changes = nullptr;
    constexpr int points = 16;
    for (int n = 1; n <= points && !changes; ++n) {
      Real first = h * n / points;
      for (Mass& m : now_) {
        // A mass that has just come to a wall or left it is on it.
        if (stays(m, first)) continue;
        Real low = h * (n - 1) / points, high = first;
        for (int k = 0; k < 80; ++k) {
          const Real middle = (low + high) / 2;
          (stays(m, middle) ? low : high) = middle;
        }
        first = high;
        changes = &m;
      }
      if (changes) h = first;
    }
    viscous += double(2 * Real(scene_.damping_ratio) * square_of_slope(series_, h));
    int in_contact = 0;
    for (std::size_t i = 0; i < now_.size(); ++i) {
      if (now_[i].wall == 0) continue;
      ++in_contact;
      losses[i] += double(now_[i].nu * now_[i].damping * square_of_slope(now_[i].series, h));
    }
    most_in_contact = std::max(most_in_contact, in_contact);
    x_ = at(series_, h), v_ = slope_at(series_, h);
    for (Mass& m : now_) {
      m.w = slope_at(m.series, h);
      m.y = m.place() + at(m.series, h);
    }
    time_ = !changes && until - time_ <= h ? Real(until) : time_ + h;
    if (!changes) return;
    Mass& m = *changes;
    if (m.wall == 0) {
      m.wall = m.w < 0 ? -1 : 1;
      impacts.push_back({double(time_), int(&m - now_.data()), double(m.w)});
      m.y = m.place();
    } else {
      m.y = m.place();
      m.wall = 0;
    }
  }

  const Scene& scene_;
  std::vector<Mass> now_;
  Real x_, v_, time_ = 0;
  Series series_{};
};

inline Record everything(const Scene& scene, int samples = 201) {
  return {.impacts = true, .contacts = true, .energy = true, .history = {{0, *scene.until_time, samples}}};
}
inline Run run_of(const Scene& scene, const Engine& engine) {
  return simulate(scene, engine, everything(scene));
}

inline const Scene four{
    .damping_ratio = 0.03,
    .x0 = 3,
    .until_time = 7,
    .dampers = {{.mass_ratio = 0.05, .restitution = 0.5, .wall_stiffness = 400},
                {.mass_ratio = 0.1, .restitution = 0.2, .clearance = 0.3, .wall_stiffness = 900},
                {.mass_ratio = 0.2, .restitution = 0.7, .clearance = 4, .wall_stiffness = 300, .y0 = 1},
                {.mass_ratio = 0.08,
                 .restitution = 0.4,
                 .clearance = 0.7,
                 .wall_stiffness = 2000,
                 .y0 = 0.7,
                 .w0 = -0.5}}};
inline const Scene two_shaken{
    .x0 = 0.2,
    .v0 = 1,
    .force_amplitude = 2,
    .force_frequency = 1.7,
    .until_time = 9,
    .dampers = {{.mass_ratio = 0.3, .restitution = 0.6, .clearance = 0.3, .wall_stiffness = 200, .y0 = 0.1},
                {.mass_ratio = 0.1, .restitution = 0.3, .clearance = 4, .wall_stiffness = 500, .y0 = -0.01}}};

// How far a run is from the reference, at 201 times and in all impacts.
struct Distance {
  double x = 0, y = 0, impacts = 0, losses = 0, viscous = 0, residual = 0;
};
inline Distance distance(const Run& run, const Reference& reference) {
  Distance far;
  const std::size_t count = run.scene.dampers.size();
  for (std::size_t i = 0; i < run.history->time.size(); ++i) {
    far.x = std::max(far.x, std::abs(run.history->x[i] - reference.x[i]));
    for (std::size_t j = 0; j < count; ++j)
      far.y = std::max(far.y, std::abs(run.history->dampers[j].y[i] - reference.y[i * count + j]));
  }
  // Impacts of each damper by itself: those of different ones may be closer together than the error.
  for (std::size_t j = 0; j < count; ++j) {
    std::vector<std::size_t> its;
    for (std::size_t i = 0; i < run.impacts->time.size(); ++i)
      if (run.impacts->damper[i] == int(j)) its.push_back(i);
    std::size_t n = 0;
    for (const auto& [time, damper, w] : reference.impacts) {
      if (damper != int(j)) continue;
      if (n == its.size()) far.impacts = 1;  // one is missing
      if (far.impacts >= 1) break;
      far.impacts = std::max({far.impacts, std::abs(run.impacts->time[its[n]] - time),
                              std::abs(run.impacts->relative_velocity[its[n]] - w)});
      ++n;
    }
    if (n < its.size()) far.impacts = 1;
  }
  double loss = run.energy->contact_loss, expected = 0;
  for (std::size_t j = 0; j < count; ++j) {
    loss += run.energy->dampers[j].impact_loss;
    expected += reference.losses[j];
    if (run.scene.dampers[j].y0 < 0) continue;  // a contact that no impact began is in no damper's losses
    far.losses = std::max(far.losses, std::abs(run.energy->dampers[j].impact_loss - reference.losses[j]));
  }
  far.losses = std::max(far.losses, std::abs(loss - expected));
  far.viscous = std::abs(run.energy->viscous_work - reference.viscous);
  far.residual = std::abs(run.energy->residual);
  return far;
}
inline Reference reference_of(const Scene& scene) {
  const Run run = run_of(scene, Cem{});
  return {scene, run.history->time};
}
// What the engines of lists make of a scene of one damper.
inline Run run_of_list(const Scene& scene, const Engine& engine) {
  return in_its_own_units(run_of(list_of_one(scene), engine));
}

inline const std::vector<Scene> single{
    {.until_time = 30},
    {.damping_ratio = 0.02,
     .x0 = 3,
     .force_amplitude = 0.5,
     .force_frequency = 0.9,
     .until_time = 15,
     .dampers = {{.mass_ratio = 0.1, .restitution = 0.3, .y0 = 0.4}}},
    {.damping_ratio = 0.3,
     .x0 = 0.5,
     .v0 = -1,
     .force_amplitude = 3,
     .force_frequency = 4,
     .until_time = 8,
     .dampers = {{.mass_ratio = 0.5, .restitution = 0.7, .y0 = 0.5}}},
    {.damping_ratio = 1.2,
     .x0 = -4,
     .until_time = 4,
     .dampers = {{.restitution = 0.2, .y0 = -0.01, .w0 = 0.5}}},
    {.x0 = 2,
     .until_time = 8,
     .dampers = {{.mass_ratio = 0.05, .restitution = 0.5, .wall_stiffness = 50, .y0 = 1.05}}},
    {.x0 = 0, .force_amplitude = 1, .force_frequency = 2, .until_time = 10, .dampers = {{.y0 = 1}}}};
// All columns of `some` are those of `all` to within `off`, and `unit` times as large.
inline void check_alike(const Run& some, const Run& all, double off) {
  const auto alike = [&](const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) CHECK(std::abs(a[i] - b[i]) <= off * (1 + std::abs(b[i])));
  };
  CHECK(some.stop_reason == all.stop_reason);
  CHECK(some.end_time == doctest::Approx(all.end_time).epsilon(off));
  alike(some.half_cycles->zero_crossing, all.half_cycles->zero_crossing);
  alike(some.half_cycles->peak_time, all.half_cycles->peak_time);
  alike(some.half_cycles->amplitude, all.half_cycles->amplitude);
  alike(some.history->x, all.history->x);
  alike(some.history->v, all.history->v);
  const auto energies = [](const Run& run) {
    const EnergyBalance& e = *run.energy;
    double losses = 0;
    for (const double loss : e.impact_loss) losses += loss;
    return std::vector{e.initial.total(), e.initial.paper, e.final.kinetic, e.final.spring,
                       e.final.wall,      e.final.paper,   losses,          e.contact_loss,
                       e.viscous_work,    e.forcing_work,  e.residual};
  };
  alike(energies(some), energies(all));
}

}  // namespace compliant_dampers
