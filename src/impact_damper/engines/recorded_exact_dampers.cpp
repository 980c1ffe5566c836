#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_exact_dampers<double>(const Scene&, const Exact&, Recorder&);
template Outcome run_exact_dampers(const ForcedSystem&, const Scene&, const Exact&, Recorder&,
                                   const ModesOfDampers<double, Forcing<double>>&);

}  // namespace impact_damper
