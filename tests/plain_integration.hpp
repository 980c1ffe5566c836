// A scene stepped through with Runge and Kutta's fourth-order rule, and everything recorded that a run can
// hold. It shares nothing with the engines: no closed form, no root search (events are bisected inside the
// step that shows them), works as further differential equations. Its steps are 1/1000 of a radian of the
// primary mass and 1/100 of one of the contact, so its own error is about 1e-12 and 1e-10 per radian; events
// closer together than a step are beyond it. Between rigid walls a mass that leaves its wall slower than
// `slowest`, and is pressed back, bounces on under constant acceleration for 2 w / (a (1 - e)) and sticks:
// that acceleration changes by 4e-5 of itself meanwhile, so the time errs by 1e-9. (Slower bounces are lost
// in the rounding of y at the right wall.)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "impact_damper/run.hpp"

namespace reference {

using impact_damper::Energy, impact_damper::Run, impact_damper::Scene, impact_damper::Wall;

class PlainIntegration {
 public:
  static constexpr double slowest = 1e-5;

  // Rigid walls are those of the restitution engine. Samples the history `samples` times from 0 to
  // until_time.
  PlainIntegration(const Scene& scene, bool rigid, int samples) : scene_(scene), rigid_(rigid) {
    const double decrement = -std::log(scene.damper().restitution);
    wall_damping_ = 2 * std::sqrt(k_over_nu()) * decrement / std::hypot(std::numbers::pi, decrement);
    run_.scene = scene;
    run_.half_cycles.emplace(), run_.impacts.emplace(), run_.contacts.emplace();
    run_.energy.emplace(), run_.history.emplace();
    const double duration = *scene.until_time;
    begin();
    sample();
    for (int i = 1; i < samples; ++i) {
      const double until = i == samples - 1 ? duration : duration * i / (samples - 1);
      while (time_ < until) advance(until);
      sample();
    }
    finish();
  }
  const Run& run() const { return run_; }

 private:
  enum class Regime { flight, contact, stuck };
  using State = std::array<double, 7>;  // x, v, y, w; viscous work, work of the force, loss in the wall

  double k_over_nu() const { return scene_.damper().wall_stiffness / scene_.damper().mass_ratio; }
  double position() const { return wall_ == Wall::left ? 0 : 1; }
  double inward() const { return wall_ == Wall::left ? -1 : 1; }

  State rates(double t, const State& s) const {
    const double nu = scene_.damper().mass_ratio, zeta = scene_.damping_ratio;
    const double force = scene_.force_amplitude * std::sin(scene_.force_frequency * t);
    double acceleration = force - 2 * zeta * s[1] - s[0], relative = 0, lost = 0;
    if (regime_ == Regime::stuck) {
      acceleration /= 1 + nu;
    } else if (regime_ == Regime::flight) {
      relative = -acceleration;
    } else {
      const double wall = wall_damping_ * s[3] + k_over_nu() * (s[2] - position());
      acceleration += nu * wall;
      relative = -wall - acceleration;
      lost = nu * wall_damping_ * s[3] * s[3];
    }
    return {s[1], acceleration, s[3], relative, 2 * zeta * s[1] * s[1], force * s[1], lost};
  }
  State stepped(double h) const {
    const auto plus = [](const State& a, double f, const State& b) {
      State c;
      for (std::size_t i = 0; i < a.size(); ++i) c[i] = a[i] + f * b[i];
      return c;
    };
    const State a = rates(time_, now_), b = rates(time_ + h / 2, plus(now_, h / 2, a)),
                c = rates(time_ + h / 2, plus(now_, h / 2, b)), d = rates(time_ + h, plus(now_, h, c));
    State next = now_;
    for (std::size_t i = 0; i < next.size(); ++i) next[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
    return next;
  }
  // The part of a step of h after which `holds` no longer does; it holds at the step's beginning.
  template <class Holds>
  double last_of(double h, Holds holds) const {
    double low = 0, high = h;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (holds(time_ + middle, stepped(middle)) ? low : high) = middle;
    }
    return high;
  }
  bool goes_on(double t, const State& s) const {
    if (regime_ == Regime::flight) return s[2] >= 0 && s[2] <= 1;
    if (regime_ == Regime::contact) return inward() * (s[2] - position()) > 0;
    return -inward() * rates(t, s)[1] > 0;  // pressed by the joined masses' acceleration
  }

  void begin() {
    now_ = {scene_.x0, scene_.v0, scene_.damper().y0, scene_.damper().w0, 0, 0, 0};
    wall_ = now_[2] <= 0.5 ? Wall::left : Wall::right;
    const double outward_pull = inward() * rates(0, now_)[3];
    const bool inside = now_[2] < 0 || now_[2] > 1;
    if (inside || (now_[2] == position() && now_[3] == 0 && outward_pull > 0))
      regime_ = rigid_ ? Regime::stuck : Regime::contact;
    run_.energy->initial = energy();
    peak_ = std::abs(now_[0]);
  }
  void advance(double until) {
    const double rate = std::sqrt(k_over_nu() * (1 + scene_.damper().mass_ratio));
    double h = std::min(regime_ == Regime::contact ? 0.01 / rate : 1e-3, until - time_);
    if (regime_ == Regime::flight && time_ == regime_since_ &&
        now_[3] != 0)  // or it may be back at the wall within the step
      h = std::min(h, 0.25 * std::abs(now_[3] / rates(time_, now_)[3]));
    const bool ends = !goes_on(time_ + h, stepped(h));
    if (ends) h = last_of(h, [&](double t, const State& s) { return goes_on(t, s); });
    observe(h);
    now_ = stepped(h);
    time_ = until - time_ <= h ? until : time_ + h;
    if (ends) change_regime();
  }
  // Zero crossings and turns of x in the step of h from now on.
  void observe(double h) {
    const State next = stepped(h);
    if (now_[1] * next[1] < 0) {
      const double turn = last_of(h, [&](double, const State& s) { return s[1] * now_[1] > 0; });
      note_peak(time_ + turn, stepped(turn)[0]);
    }
    if (now_[0] * next[0] < 0) {
      auto& rows = *run_.half_cycles;
      rows.zero_crossing.push_back(time_ +
                                   last_of(h, [&](double, const State& s) { return s[0] * now_[0] > 0; }));
      rows.peak_time.push_back(peak_time_);
      rows.amplitude.push_back(peak_);
      rows.impacts.push_back(0);
      peak_ = 0;
    }
    note_peak(time_ + h, next[0]);
  }
  void note_peak(double t, double x) {
    if (std::abs(x) > peak_) peak_ = std::abs(x), peak_time_ = t;
  }
  void change_regime() {
    if (regime_ == Regime::flight) {
      wall_ = now_[2] < 0.5 ? Wall::left : Wall::right;
      now_[2] = position();
      run_.impacts->time.push_back(time_);
      run_.impacts->wall.push_back(wall_);
      run_.impacts->relative_velocity.push_back(now_[3]);
      run_.impacts->displacement.push_back(now_[0]);
      if (rigid_) {
        const double nu = scene_.damper().mass_ratio, before = energy().kinetic;
        now_[1] += nu * (1 + scene_.damper().restitution) * now_[3] / (1 + nu);
        now_[3] *= -scene_.damper().restitution;
        run_.energy->impact_loss.push_back(before - energy().kinetic);
        const double push = inward() * rates(time_, now_)[3];
        if (push > 0 && std::abs(now_[3]) < slowest) {
          pressed_from_ = time_ + 2 * std::abs(now_[3]) / (push * (1 - scene_.damper().restitution));
          const double apart = energy().kinetic;
          now_[1] += nu * now_[3] / (1 + nu);
          now_[3] = 0;
          regime_ = Regime::stuck;
          ++run_.energy->bounce_downs;
          run_.energy->bounce_down_loss += apart - energy().kinetic;
        }
      } else {
        regime_ = Regime::contact;
        by_impact_ = true;
      }
    } else {
      end_contact();
      regime_ = Regime::flight;
      now_[2] = position();
      by_impact_ = false;
    }
    regime_since_ = regime_ == Regime::stuck ? pressed_from_ : time_;
    lost_before_ = now_[6];
  }
  void end_contact() {
    run_.contacts->begin.push_back(regime_since_);
    run_.contacts->end.push_back(time_);
    run_.contacts->wall.push_back(wall_);
    if (by_impact_)
      run_.energy->impact_loss.push_back(now_[6] - lost_before_);
    else
      run_.energy->contact_loss += now_[6] - lost_before_;
  }
  Energy energy() const {
    const auto& [x, v, y, w, viscous, forcing, lost] = now_;
    const double nu = scene_.damper().mass_ratio, depth = y < 0 ? y : y > 1 ? y - 1 : 0;
    return {(v * v + nu * (v + w) * (v + w)) / 2, x * x / 2,
            scene_.damper().wall_stiffness * depth * depth / 2, (v * v + nu * (v * v + w * w) + x * x) / 2};
  }
  void sample() {
    auto& history = *run_.history;
    history.time.push_back(time_);
    history.x.push_back(now_[0]);
    history.v.push_back(now_[1]);
    history.dampers[0].y.push_back(now_[2]);
    history.dampers[0].w.push_back(now_[3]);
  }
  void finish() {
    if (regime_ != Regime::flight) end_contact();
    run_.end_time = time_;
    run_.energy->final = energy();
    run_.energy->viscous_work = now_[4];
    run_.energy->forcing_work = now_[5];
    auto& rows = *run_.half_cycles;
    for (const double time : run_.impacts->time) {
      const std::size_t row = static_cast<std::size_t>(std::ranges::upper_bound(rows.zero_crossing, time) -
                                                       rows.zero_crossing.begin());
      auto& phase = run_.impacts->phase_deg.emplace_back();
      auto& amplitude = run_.impacts->amplitude.emplace_back();
      if (row == rows.amplitude.size()) continue;
      ++rows.impacts[row];
      amplitude = rows.amplitude[row];
      if (row == 0) continue;
      const double since = rows.zero_crossing[row - 1];
      phase = 180 * (time - since) / (rows.zero_crossing[row] - since);
    }
  }

  const Scene scene_;
  const bool rigid_;
  double wall_damping_ = 0;
  Run run_;
  double time_ = 0, regime_since_ = 0, pressed_from_ = 0, lost_before_ = 0, peak_ = 0, peak_time_ = 0;
  State now_{};
  Regime regime_ = Regime::flight;
  Wall wall_ = Wall::left;
  bool by_impact_ = false;
};

}  // namespace reference
