// Siconos behind plain numbers: its headers need Boost.uBLAS, which is not for C++20, and the library's need
// C++20.
#pragma once

#include <vector>

#include "rows.hpp"

namespace impact_damper::bench {

// A scene with rigid walls, without forcing, that ends at a time; the names are Scene's.
struct SiconosScene {
  double damping_ratio, x0, v0, until_time;
  struct Damper {
    double mass_ratio, restitution, clearance, y0, w0;
  };
  std::vector<Damper> dampers;
};

Rows siconos_moreau_jean(const SiconosScene& scene, double time_step);
// Bounces end where the speed falls below `bounce_tolerance`; `tolerance` is LSODAR's, absolute and relative.
// Throws std::exception where it cannot tell a bounce from a contact, as with most pairs of the two.
Rows siconos_event_driven(const SiconosScene& scene, double bounce_tolerance, double tolerance);

}  // namespace impact_damper::bench
