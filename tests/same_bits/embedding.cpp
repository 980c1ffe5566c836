// Somebody's program that uses the library. Compiled and linked in ways that take away what results rest on:
// it prints why the library does not run, and ends as the library's own program would.
#include <cstdio>

#include "impact_damper/simulate.hpp"

int main() {
#ifdef NEEDS_FMA
  if (!__builtin_cpu_supports("fma")) {
    std::puts("this processor has no FMA: not tested");
    return 77;
  }
#endif
  impact_damper::Scene scene;
  scene.until_time = 20;
  try {
    impact_damper::simulate(scene, impact_damper::Exact{}, {});
  } catch (const impact_damper::NumericalError& error) {
    std::puts(error.what());
    return 4;
  }
  std::puts("a run is done");
}
