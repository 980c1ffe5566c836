#include "peers/odeint.hpp"

#include <boost/version.hpp>

#include "peers/peers.hpp"
#include "peers/several_dampers.hpp"

namespace impact_damper::bench {
namespace {

template <template <class> class Stepper>
Rows run(const Scene& scene, Walls walls, double tolerance) {
  return OdeintRun<HybridSystem<double>, Stepper>(scene, walls, tolerance).run();
}

// The number of dampers is that of a scene of the bench.
template <std::size_t N>
Rows run_several(const Scene& scene, Walls walls, double tolerance) {
  return OdeintRun<SeveralDampers<double, N>, DormandPrince>(scene, walls, tolerance).run();
}
Rows run_dormand_prince(const Scene& scene, Walls walls, double tolerance) {
  switch (scene.dampers.size()) {
    case 0:
      return run<DormandPrince>(scene, walls, tolerance);
    case 1:
      return run_several<1>(scene, walls, tolerance);
    case 2:
      return run_several<2>(scene, walls, tolerance);
    case 5:
      return run_several<5>(scene, walls, tolerance);
    case 20:
      return run_several<20>(scene, walls, tolerance);
    case 100:
      return run_several<100>(scene, walls, tolerance);
    default:
      throw std::invalid_argument("not compiled for so many dampers");
  }
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
