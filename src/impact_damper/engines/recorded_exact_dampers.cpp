#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_exact_dampers<double>(const Checked&, Recorder&);
template Outcome run_exact_dampers(const ForcedSystem&, const Scene&, const Exact&, Recorder&,
                                   const ModesOfDampers<double, Forcing<double>>&);

}  // namespace impact_damper
