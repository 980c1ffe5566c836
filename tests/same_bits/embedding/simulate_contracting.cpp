// The library's own source, with other flags.
#include "impact_damper/simulate.cpp"
