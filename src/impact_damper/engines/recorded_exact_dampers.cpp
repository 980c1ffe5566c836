#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_exact_dampers<double>(const Scene&, const Exact&, Recorder&);

}  // namespace impact_damper
