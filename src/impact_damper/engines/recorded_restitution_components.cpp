#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_restitution_with_components<double>(const Checked&, Recorder&);
template Outcome run_restitution_with_components(const ForcedSystem&, const Scene&, const Restitution&,
                                                 Recorder&);

}  // namespace impact_damper
