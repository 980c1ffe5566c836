// The engines with the program's observer, Recorder. Each takes seconds to compile, so each is
// compiled once, in a source of its own (recorded_*.cpp), and so that two processors share the work.
#pragma once

#include "impact_damper/engines/cem.hpp"
#include "impact_damper/engines/exact.hpp"
#include "impact_damper/engines/exact_components.hpp"
#include "impact_damper/engines/exact_dampers.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/engines/restitution.hpp"
#include "impact_damper/engines/restitution_components.hpp"
#include "impact_damper/engines/restitution_dampers.hpp"

namespace impact_damper {

using FreeSystem = System<double, NoForcing<double>>;
using ForcedSystem = System<double, Forcing<double>>;
using ForcedModes = ContactModes<double, Forcing<double>>;

extern template Outcome run_exact(const FreeSystem&, const Scene&, const Exact&, Recorder&);
extern template Outcome run_exact(const ForcedSystem&, const Scene&, const Exact&, Recorder&);
extern template Outcome run_exact<Contact<double>>(const ForcedModes&, const ForcedSystem&, const Scene&,
                                                   const Exact&, Recorder&);
extern template Outcome run_exact<ContactWithoutModes<double>>(const ForcedModes&, const ForcedSystem&,
                                                               const Scene&, const Exact&, Recorder&);
extern template Outcome run_exact_dampers<double>(const Checked&, Recorder&);
extern template Outcome run_exact_dampers(const ForcedSystem&, const Scene&, const Exact&, Recorder&,
                                          const ModesOfDampers<double, Forcing<double>>&);
extern template Outcome run_exact_with_components<double>(const Checked&, Recorder&);
extern template Outcome run_exact_with_components(const ForcedSystem&, const Scene&, const Exact&, Recorder&);
extern template Outcome run_restitution(const FreeSystem&, const Scene&, const Restitution&, Recorder&);
extern template Outcome run_restitution(const ForcedSystem&, const Scene&, const Restitution&, Recorder&);
extern template Outcome run_restitution_dampers<double>(const Checked&, Recorder&);
extern template Outcome run_restitution_dampers(const ForcedSystem&, const Scene&, const Restitution&,
                                                Recorder&);
extern template Outcome run_restitution_with_components<double>(const Checked&, Recorder&);
extern template Outcome run_restitution_with_components(const ForcedSystem&, const Scene&, const Restitution&,
                                                        Recorder&);
extern template Outcome run_cem<double>(const Checked&, Recorder&);
extern template Outcome run_cem_dampers<double>(const Checked&, Recorder&);

}  // namespace impact_damper
