// The library's own source, with other flags.
#include "impact_damper/engines/recorded_exact_free.cpp"
