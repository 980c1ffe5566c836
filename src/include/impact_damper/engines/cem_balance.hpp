// The energy balance of a run by the component element method, (M8.1), with components (M18.5). Its integrals
// are trapezoids over the steps: CemSteps sums whole powers, this class adds the ends.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "impact_damper/engines/cem_steps.hpp"
#include "impact_damper/motion/energy.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

template <class Real, template <class> class ForEach>
class CemBalance {
  using Masses = CemMasses<Real, ForEach>;
  using State = typename Masses::State;

 public:
  // balance: where the energies are written. Null: none are wanted, and no function does anything.
  CemBalance(Masses& masses, CemSteps<Real, ForEach>& steps, EnergyBalance* balance)
      : masses_(masses), steps_(steps), balance_(balance), of_dampers_(masses.size()) {}
  explicit operator bool() const { return balance_ != nullptr; }

  void begin(const State& start) {
    if (!balance_) return;
    balance_->initial = energy(start);
    for (std::size_t i = 0; i < masses_.size(); ++i) of_damper(i).initial_kinetic = kinetic(start, i);
  }
  // An impact begins a contact of the i-th mass.
  void enter(std::size_t i) {
    if (!balance_) return;
    masses_[i].impact = balance_->impact_loss.size();
    balance_->impact_loss.push_back(0);
  }
  // A contact ends.
  void leave(std::size_t i) {
    auto& m = masses_[i];
    if (balance_) {
      if (m.impact) balance_->impact_loss[*m.impact] = double(m.work);
      (m.impact ? m.impact_loss : m.contact_loss) += m.work;
      m.loss += m.work;
    }
    m.impact.reset();
    m.work = 0;
  }
  // Takes account of the energy in a state: the largest is the measure of the residual.
  void look_at(const State& s) { energy(s); }

  // Adds the powers at `time`, in the state s, times `weight`.
  void add_powers(const Real& weight, const Real& time, const State& s) {
    if (!balance_) return;
    viscous_work_ += weight * 2 * masses_.zeta * s.v * s.v;
    forcing_work_ += weight * masses_.force_at(time) * s.v;
    for (const std::size_t i : masses_.coupled) {
      auto& m = masses_[i];
      if (masses_.law_of(i))
        m.work += weight * m.nu * (masses_.resistance(i, s.q[i]) - m.drag) * s.w[i] * s.w[i];
      else if (m.wall)
        m.work += weight * m.nu * m.c * s.w[i] * s.w[i];
      if (m.drag != 0) m.drag_loss += weight * m.nu * m.drag * s.w[i] * s.w[i];
    }
  }
  // Adds what has been summed over steps.
  void add_sums() {
    if (!balance_) return;
    const Real& h = steps_.h();
    const auto sums = steps_.take_sums();
    viscous_work_ += masses_.zeta * sums.vv / (2 * h);
    forcing_work_ += sums.fv / 2;
    for (const std::size_t i : masses_.coupled) {
      auto& m = masses_[i];
      if (m.wall) m.work += m.nu * (masses_.has_laws() ? Real(1) : m.c) * m.sum_ww / (4 * h);
      if (m.drag != 0) m.drag_loss += m.nu * m.drag * m.sum_drag / (4 * h);
      m.sum_ww = m.sum_drag = 0;
    }
  }
  // Begins a segment at `time`, in the state s.
  void open(const Real& time, const State& s) {
    add_powers(-steps_.h() / 2, time, s);
    for (std::size_t i = 0; masses_.has_components() && i < masses_.size(); ++i)
      masses_[i].slid_from = masses_.y(s, i);
  }
  // Ends it at a time in its last step.
  void close(const Real& at) {
    if (!balance_) return;
    add_sums();
    for (std::size_t i = 0; masses_.has_components() && i < masses_.size(); ++i) {
      auto& m = masses_[i];
      const Real y = m.origin_of_q() + m.arc(steps_.h()).at(at);
      if (!m.stuck) m.friction_loss += m.nu * m.friction * (m.slides * (y - m.slid_from));
    }
    add_powers((at - steps_.h()) / 2, steps_.begin(), steps_.state_at(Real(0)));
    add_powers(at / 2, steps_.begin() + at, steps_.state_at(at));
  }

  void set_final(const State& s) {
    balance_->final = energy(s);
    for (std::size_t i = 0; i < masses_.size(); ++i) of_damper(i).final_kinetic = kinetic(s, i);
  }
  // Writes the works and losses, after the last contact has ended. of_dampers: for each damper, too.
  void finish(bool of_dampers) {
    if (!balance_) return;
    balance_->viscous_work = double(viscous_work_);
    balance_->forcing_work = double(forcing_work_);
    const double largest = std::max(largest_energy_, std::abs(balance_->forcing_work));
    Real contact_loss = 0, losses = 0, friction_loss = 0, drag_loss = 0;
    for (std::size_t i = 0; i < masses_.size(); ++i) {
      const auto& m = masses_[i];
      of_damper(i).impact_loss = double(m.impact_loss);
      of_damper(i).contact_loss = double(m.contact_loss);
      of_damper(i).friction_loss = double(m.friction_loss);
      of_damper(i).drag_loss = double(m.drag_loss);
      contact_loss += m.contact_loss;
      friction_loss += m.friction_loss;
      drag_loss += m.drag_loss;
      losses += m.loss + (m.friction_loss + m.drag_loss);
    }
    balance_->contact_loss = double(contact_loss);
    balance_->friction_loss = double(friction_loss);
    balance_->drag_loss = double(drag_loss);
    const Real open =
        (balance_->initial.total() + forcing_work_) - (balance_->final.total() + losses + viscous_work_);
    balance_->residual = largest > 0 ? double(open) / largest : 0.0;
    if (of_dampers) balance_->dampers = of_dampers_;
  }

 private:
  DamperEnergy& of_damper(std::size_t i) { return of_dampers_[masses_[i].number]; }
  double kinetic(const State& s, std::size_t i) const { return kinetic_energy(masses_[i].nu, s.v, s.w[i]); }
  Energy energy(const State& s) {
    Energy energy = energy_of_masses(s.x, s.v, masses_.size(), [&](std::size_t i) {
      const auto& m = masses_[i];
      return EnergyTerms<Real>{m.nu, s.w[i], masses_.wall_energy(i, s.q[i])};
    });
    if (masses_.has_laws()) {
      const double spring = masses_.primary_energy(s.x);
      energy.paper += spring - energy.spring;
      energy.spring = spring;
    }
    if (masses_.weight != 0) {
      Real weight = 0;
      for (std::size_t i = 0; i < masses_.size(); ++i)
        weight += masses_[i].nu * masses_.weight * (s.x + masses_.y(s, i));
      energy.weight = double(weight);
    }
    largest_energy_ = std::max(largest_energy_, energy.total());
    return energy;
  }

  Masses& masses_;
  CemSteps<Real, ForEach>& steps_;
  EnergyBalance* const balance_;
  Real viscous_work_ = 0, forcing_work_ = 0;
  double largest_energy_ = 0;
  std::vector<DamperEnergy> of_dampers_;  // by number in the scene
};

}  // namespace impact_damper
