// The engines with one observer for all tests, in double and in extended precision. An engine takes seconds
// to compile with each observer and each type of number; here it is compiled once for all of them.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <variant>

#include "impact_damper/engine.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/motion/state.hpp"

namespace impact_damper {

// A Recorder, by default of nothing. A test overrides what is to be asked, or reported, differently.
template <class Real>
class TestObserver : public Recorder {
 public:
  explicit TestObserver(Record record = {.half_cycles = false}, std::size_t dampers = 1)
      : Recorder(std::move(record), dampers) {}
  virtual ~TestObserver() = default;

  virtual bool wants_half_cycles() const { return Recorder::wants_half_cycles(); }
  virtual bool wants_contacts() const { return Recorder::wants_contacts(); }
  virtual bool wants_energy() const { return Recorder::wants_energy(); }
  virtual void half_cycle(double begin, double end, double peak_time, double amplitude) {
    Recorder::half_cycle(begin, end, peak_time, amplitude);
  }
  virtual void impact(double time, Wall wall, double w, double x) { Recorder::impact(time, wall, w, x); }
  virtual void contact(double begin, double end, Wall wall) { Recorder::contact(begin, end, wall); }
  virtual double next_sample() const { return Recorder::next_sample(); }
  virtual void sample(double time, double x, double v, double y, double w) {
    Recorder::sample(time, x, v, y, w);
  }
  virtual void settled(std::int32_t damper, const PlaceInCavity& place, bool held, double slides,
                       bool pushes) {
    Recorder::settled(damper, place, held, slides, pushes);
  }
  virtual EnergyBalance& energy_balance() { return Recorder::energy_balance(); }

  // Of each of several dampers.
  virtual void impact(double time, Wall wall, double w, double x, std::int32_t damper) {
    Recorder::impact(time, wall, w, x, damper);
  }
  virtual void contact(double begin, double end, Wall wall, std::int32_t damper) {
    Recorder::contact(begin, end, wall, damper);
  }
  virtual void sample(double time, double x, double v, std::span<const PlaceInCavity> places) {
    Recorder::sample(time, x, v, places);
  }

  // The end of each motion of a closed-form engine, in the engine's own numbers.
  virtual void ended(const State<Real>&) {}
  void passed(const Real&, const Real&, const State<Real>& end) { ended(end); }
};

// Runs a scene without checked(): differences, and limits, are also taken of scenes just outside of what is
// allowed.
template <class Real>
Outcome observed(const Scene& scene, const Exact& options, TestObserver<Real>& observer);
template <class Real>
Outcome observed(const Scene& scene, const Restitution& options, TestObserver<Real>& observer);
template <class Real>
Outcome observed(const Scene& scene, const Cem& options, TestObserver<Real>& observer);
template <class Real>
Outcome observed(const Scene& scene, const Engine& engine, TestObserver<Real>& observer) {
  return std::visit([&](const auto& options) { return observed(scene, options, observer); }, engine);
}
// The same with a list of dampers, and with friction, weight and drag, too.
Outcome observed_list(const Scene& scene, const Exact& options, TestObserver<long double>& observer);
Outcome observed_list(const Scene& scene, const Restitution& options, TestObserver<long double>& observer);

}  // namespace impact_damper
