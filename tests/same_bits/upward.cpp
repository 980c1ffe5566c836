// Loaded before a program (LD_PRELOAD), as a plug-in or another library would be: leaves the rounding mode
// changed.
#include <cfenv>

[[gnu::constructor]] static void change_rounding() { std::fesetround(FE_UPWARD); }
