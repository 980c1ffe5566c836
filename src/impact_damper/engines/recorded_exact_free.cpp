#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_exact(const FreeSystem&, const Scene&, const Exact&, Recorder&);

}  // namespace impact_damper
