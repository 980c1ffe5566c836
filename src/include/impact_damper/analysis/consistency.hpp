// Whether a run is consistent: its columns, energies and end with each other, and with its scene and engine.
// A run made by simulate() is. One with altered numbers, or made by a faulty engine, is in most cases not.
#pragma once

#include <vector>

#include "impact_damper/run.hpp"

namespace impact_damper {

// The contradictions found: the first for each rule, Problem::field being the JSON pointer into the run's
// file ("/half_cycles/amplitude/3"). Empty if there is none. A rule that needs a section which was not
// recorded is left out. The columns of a section must be equally long, as the reader of run files ensures.
//
// The rules:
//   end: the run ended where its stop reason says, and nothing recorded is later;
//   half cycles: each row has a length > 0 and its peak within it; the first amplitude is >= |x0|;
//   impacts: each row has as many as its count says, all within it, with the phases that follow from its
//     crossings and with its amplitude; the relative velocity is towards the wall that is struck;
//   contacts: those of one damper do not overlap; with compliant walls each begins with an impact, except one
//     of each damper that begins at the release; with rigid walls no impact of the damper lies within one;
//   history: x changes its sign only where a zero crossing is recorded and is zero in a sample there; |x|
//     does not exceed the amplitude of its half cycle;
//   energy: the energies at the release and at the end are those of the states there; an impact on a rigid
//     wall loses what its speed implies; the recorded residual is that of the recorded terms;
//   several dampers: counts, losses and bounce-downs are the sums over all dampers, and those of a damper the
//     sums over its impacts; each secondary mass lies between its walls if they are rigid, and its kinetic
//     energy is that of its state.
std::vector<Problem> inconsistencies_of(const Run& run);

}  // namespace impact_damper
