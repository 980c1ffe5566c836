// What every engine asks of, and tells, its observer. Recorder (recorder.hpp) keeps columns; a program of
// your own may keep less, or something else.
#pragma once

#include <concepts>

#include "impact_damper/run.hpp"

namespace impact_damper {

// An engine asks what is wanted and computes nothing else, then tells it in the order of time. Observing
// never changes the motion.
template <class T>
concept RunObserver = requires(T observer, const T asked, double number, Wall wall) {
  { asked.wants_half_cycles() } -> std::same_as<bool>;
  { asked.wants_contacts() } -> std::same_as<bool>;
  { asked.wants_energy() } -> std::same_as<bool>;
  // begin, zero crossing, time of the peak, amplitude: told at the zero crossing.
  observer.half_cycle(number, number, number, number);
  // time, wall, y' just before, x.
  observer.impact(number, wall, number, number);
  // begin, end, wall: told at the end.
  observer.contact(number, number, wall);
  // The time of the next sample that is wanted, infinity for none; and x, x', y, y' there.
  { asked.next_sample() } -> std::same_as<double>;
  observer.sample(number, number, number, number, number);
  { observer.energy_balance() } -> std::same_as<EnergyBalance&>;
};

}  // namespace impact_damper
