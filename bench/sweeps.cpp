#include <cmath>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/engines/exact.hpp"
#include "impact_damper/engines/restitution.hpp"
#include "measurements.hpp"
#include "quiet_observer.hpp"

namespace impact_damper::bench {
namespace {

Outcome run(const Scene& scene, const Exact& options, QuietObserver& observer) {
  return run_exact<double>(checked(scene, options), observer);
}
Outcome run(const Scene& scene, const Restitution& options, QuietObserver& observer) {
  return run_restitution<double>(checked(scene, options), observer);
}

template <class Options>
SweepPoint measure_point(double at, const Scene& scene, const Options& options) {
  SweepPoint point{.at = at};
  QuietObserver accountant(true);
  run(scene, options, accountant);
  point.impacts = accountant.impacts;
  point.half_cycles = accountant.rows;
  point.residual = std::abs(accountant.energy_balance().residual);

  const auto once = [&] {
    QuietObserver observer;
    run(scene, options, observer);
  };
  const double first = cpu_seconds(once);
  point.timing = measure(once, first < 1 ? 9 : 3, first);
  return point;
}

template <class Options>
void add_sweeps(double most_impacts, const std::function<void(const std::string&)>& told,
                std::vector<Sweep>& all) {
  const std::string name(Options::name);
  const auto add = [&](Sweep& sweep, double at, const Scene& scene, const Options& options) {
    told(name + ", cost against " + sweep.against + ": " + number_text(at));
    sweep.points.push_back(measure_point(at, scene, options));
  };

  Sweep impacts{name, "impacts", "number of impacts, e = 1", {}};
  for (double n = 100; n <= most_impacts; n *= 10) {
    Options options;
    options.budget.max_impacts = std::int64_t(n);
    add(impacts, n, {.x0 = 6, .until_time = 1e12, .dampers = {{.restitution = 1}}}, options);
  }
  all.push_back(impacts);

  if constexpr (std::same_as<Options, Exact>) {
    Sweep stiffness{name, "stiffness", "wall stiffness k, e = 0.6, decay from 6 to 0.5", {}};
    for (double k = 1e2; k < 2e10; k *= 10) {
      add(stiffness, k, {.x0 = 6, .until_amplitude = 0.5, .dampers = {{.wall_stiffness = k}}}, {});
    }
    all.push_back(stiffness);
  }

  Sweep restitution{name, "restitution", "restitution e, decay from 6 to 0.5", {}};
  for (const double e : {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99}) {
    Options options;
    options.budget.max_impacts = 20'000;
    add(restitution, e, {.x0 = 6, .until_amplitude = 0.5, .dampers = {{.restitution = e}}}, options);
  }
  all.push_back(restitution);
}

}  // namespace

std::vector<Sweep> measure_sweeps(double most_impacts, const std::function<void(const std::string&)>& told) {
  std::vector<Sweep> all;
  add_sweeps<Exact>(most_impacts, told, all);
  add_sweeps<Restitution>(most_impacts, told, all);
  return all;
}

}  // namespace impact_damper::bench
