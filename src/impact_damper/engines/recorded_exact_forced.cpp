#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {

template Outcome run_exact(const ForcedSystem&, const Scene&, const Exact&, Recorder&);
template Outcome run_exact<Contact<double>>(const ForcedModes&, const ForcedSystem&, const Scene&,
                                            const Exact&, Recorder&);
template Outcome run_exact<ContactWithoutModes<double>>(const ForcedModes&, const ForcedSystem&, const Scene&,
                                                        const Exact&, Recorder&);

}  // namespace impact_damper
