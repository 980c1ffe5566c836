#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_cem<double>(const Scene&, const Cem&, Recorder&);

}  // namespace impact_damper
