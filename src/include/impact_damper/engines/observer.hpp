// The interface between every engine and its observer. Recorder (recorder.hpp) keeps columns; a program of
// your own may keep less, or something else. Quantities are dimensionless, as in run.hpp.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>

#include "impact_damper/run.hpp"

namespace impact_damper {

// An engine asks what is wanted, computes only that, and reports it. Calls of one kind come in the order of
// time, and an impact before the half cycle and the contact that it belongs to; the order is not fixed
// otherwise. Impacts are always reported. Observing never changes the motion.
//
// An observer of a closed-form engine may also have passed(begin, duration, end). It is then called for each
// motion in turn, in the engine's own numbers: when it began, how long it lasted, and the state in which it
// ended, before the event at its end changes it; with several dampers only x and x' of that state are set.
// With friction, weight or drag one of such an engine may have settled(damper, place, held, slides, pushes),
// too, called for each damper when a run begins and after each event: its place then, whether it is held, the
// sign of y' with which friction acts on it, 0 where it does not slide, and whether it pushes a compliant
// wall, in which it may slide or be held.
template <class T>
concept RunObserver = requires(T observer, const T asked, double number, Wall wall) {
  { asked.wants_half_cycles() } -> std::same_as<bool>;
  { asked.wants_contacts() } -> std::same_as<bool>;
  { asked.wants_energy() } -> std::same_as<bool>;
  // begin, zero crossing, time of the peak, amplitude; reported at the zero crossing. Only if
  // wants_half_cycles().
  observer.half_cycle(number, number, number, number);
  // time, wall, y' just before, x.
  observer.impact(number, wall, number, number);
  // begin, end, wall; reported at the end. Only if wants_contacts().
  observer.contact(number, number, wall);
  // Returns the time of the next sample that is wanted, infinity for none. Asked for again after each call of
  // sample() and half_cycle(); times ascend.
  { asked.next_sample() } -> std::same_as<double>;
  // That time, and x, x', y, y' there.
  observer.sample(number, number, number, number, number);
  // The object to which the engine writes the energies. Called only if wants_energy().
  { observer.energy_balance() } -> std::same_as<EnergyBalance&>;
};

// The place of the secondary mass of one of several dampers: y and y', divided as in run.hpp.
struct PlaceInCavity {
  double y, w;
};
// The additional interface of the engines of several dampers (exact_dampers.hpp, restitution_dampers.hpp,
// cem.hpp): calls also name the damper, by its number in the scene, from 0. Simultaneous impacts, with rigid
// walls by (M17.2), come in the order of these numbers; one that they cause at the same time comes after
// them.
template <class T>
concept DampersObserver = RunObserver<T> &&
    requires(T observer, double number, Wall wall, std::int32_t damper,
             std::span<const PlaceInCavity> places) {
  observer.impact(number, wall, number, number, damper);
  observer.contact(number, number, wall, damper);
  // Time, x, x', and y and y' of each damper.
  observer.sample(number, number, number, places);
};

}  // namespace impact_damper
