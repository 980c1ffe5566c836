#include "counted.hpp"

#include <utility>

#include "impact_damper/engines/exact.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/engines/restitution.hpp"

namespace impact_damper::bench {
namespace {

template <class Engine>
CountedRun count_with(const Scene& scene, Engine&& engine) {
  Recorder recorder({.half_cycles = true, .impacts = true});
  counts = {};
  engine(scene, recorder);
  const Counts counted = counts;
  Run run;
  recorder.finish(run);
  return {counted, std::int64_t(run.impacts->time.size()), std::move(run.half_cycles->amplitude)};
}

}  // namespace

CountedRun count(const Scene& scene, const Exact& options) {
  return count_with(
      scene, [&](const Scene& s, Recorder& recorder) { run_exact<Counted>(checked(s, options), recorder); });
}

CountedRun count(const Scene& scene, const Restitution& options) {
  return count_with(scene, [&](const Scene& s, Recorder& recorder) {
    run_restitution<Counted>(checked(s, options), recorder);
  });
}

}  // namespace impact_damper::bench
