#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_cem_dampers<double>(const Checked&, Recorder&);

}  // namespace impact_damper
