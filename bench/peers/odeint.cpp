#include "peers/odeint.hpp"

#include <boost/version.hpp>

#include "peers/peers.hpp"

namespace impact_damper::bench {
namespace {

template <template <class> class Stepper>
Contender contender(const std::string& name, Walls walls, double finest, const std::string& about) {
  return {name,
          walls,
          "tolerance",
          [finest](const Scene&) {
            std::vector<double> tolerances;
            for (double tolerance = 1e-4; tolerance > 0.99 * finest; tolerance /= 10)
              tolerances.push_back(tolerance);
            return tolerances;
          },
          [walls](const Scene& scene, double tolerance) {
            return OdeintRun<double, Stepper<double>>(scene, walls, tolerance).run();
          },
          about + "; Boost.odeint " BOOST_LIB_VERSION};
}

}  // namespace

std::vector<Contender> odeint_peers() {
  std::vector<Contender> all;
  for (const Walls walls : {Walls::compliant, Walls::rigid}) {
    all.push_back(contender<Fehlberg>("odeint fehlberg78", walls, 1e-15,
                                      "events by repeated steps and Newton's method"));
    all.push_back(contender<DormandPrince>("odeint dopri5", walls, 1e-13, "the same on the dense output"));
  }
  return all;
}

}  // namespace impact_damper::bench
