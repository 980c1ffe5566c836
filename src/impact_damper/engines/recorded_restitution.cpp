#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_restitution(const FreeSystem&, const Scene&, const Restitution&, Recorder&);
template Outcome run_restitution(const ForcedSystem&, const Scene&, const Restitution&, Recorder&);

}  // namespace impact_damper
