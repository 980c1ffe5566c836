#include "peers/odeint.hpp"

#include <boost/version.hpp>

#include "contender.hpp"

namespace impact_damper::bench {
namespace {

template <template <class> class Stepper>
Rows run(const Scene& scene, Walls walls, double tolerance) {
  return OdeintRun<HybridSystem<double>, Stepper>(scene, walls, tolerance).run();
}

Rows run_dormand_prince(const Scene& scene, Walls walls, double tolerance) {
  return has_one_damper(scene) ? run<DormandPrince>(scene, walls, tolerance)
                               : run_dampers(scene, walls, tolerance);
}

using Runs = Rows(const Scene&, Walls, double tolerance);

Contender contender(const std::string& name, Walls walls, double finest, Runs* runs,
                    const std::string& about) {
  return {name,
          walls,
          "tolerance",
          [finest](const Scene&) {
            std::vector<double> tolerances;
            for (double tolerance = 1e-4; tolerance > 0.99 * finest; tolerance /= 10)
              tolerances.push_back(tolerance);
            return tolerances;
          },
          [=](const Scene& scene, double tolerance) { return runs(scene, walls, tolerance); },
          about + "; Boost.odeint " BOOST_LIB_VERSION};
}

}  // namespace

std::vector<Contender> odeint_peers() {
  std::vector<Contender> all;
  for (const Walls walls : {Walls::compliant, Walls::rigid}) {
    all.push_back(contender("odeint fehlberg78", walls, 1e-15, run<Fehlberg>,
                            "events by repeated steps and Newton's method"));
    all.push_back(
        contender("odeint dopri5", walls, 1e-13, run_dormand_prince, "the same on the dense output"));
    all.back().several = true;
  }
  return all;
}

}  // namespace impact_damper::bench
