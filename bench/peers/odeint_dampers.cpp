// By itself: where a compiler has more to do in one file it inlines less, and the other runs would take
// longer.
#include "peers/odeint.hpp"
#include "peers/several_dampers.hpp"

namespace impact_damper::bench {
namespace {

template <std::size_t N>
Rows run(const Scene& scene, Walls walls, double tolerance) {
  return OdeintRun<SeveralDampers<double, N>, DormandPrince>(scene, walls, tolerance).run();
}

}  // namespace

Rows run_dampers(const Scene& scene, Walls walls, double tolerance) {
  switch (scene.dampers.size()) {
    case 1:
      return run<1>(scene, walls, tolerance);
    case 2:
      return run<2>(scene, walls, tolerance);
    case 5:
      return run<5>(scene, walls, tolerance);
    case 20:
      return run<20>(scene, walls, tolerance);
    case 100:
      return run<100>(scene, walls, tolerance);
    default:
      throw std::invalid_argument("not compiled for so many dampers");
  }
}

}  // namespace impact_damper::bench
