#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_exact_with_components<double>(const Checked&, Recorder&);

}  // namespace impact_damper
