#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_cem_dampers<double>(const Scene&, const Cem&, Recorder&);

}  // namespace impact_damper
