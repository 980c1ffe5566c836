// Whether a run agrees with itself: what its columns, its energies and its end say of each other and of its
// scene and engine. A run made by simulate() does; one whose numbers were altered, or that an engine in error
// made, mostly does not.
#pragma once

#include <vector>

#include "impact_damper/run.hpp"

namespace impact_damper {

// What contradicts what: for each rule its first offence, Problem::field being the JSON pointer into the
// run's file
// ("/half_cycles/amplitude/3"). Empty if nothing does. Sections that were not recorded are not asked for; the
// columns of each must be equally long, as the reader of run files ensures.
//
// The rules: the run ended where its stop reason says, and nothing is later; rows have a length, their peaks
// lie in them, the first amplitude is >= |x0|; the impacts of each row are as many as it says, lie in it, and
// have its phases and its amplitude; impacts come from the side of their wall; contacts are disjoint, with
// compliant walls each but one from the release on begins with its impact, with rigid ones no impact lies in
// one; every change of sign between samples has its crossing, no |x| of a half cycle exceeds its amplitude, x
// is zero where a sample meets a crossing; the energies at the release and at the end are those of the states
// there, an impact on a rigid wall costs what its speed says, and the recorded residual is what the recorded
// terms leave.
std::vector<Problem> inconsistencies_of(const Run& run);

}  // namespace impact_damper
