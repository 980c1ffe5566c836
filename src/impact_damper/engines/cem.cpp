#include "impact_damper/engines/cem.hpp"

#include <numbers>
#include <string>

#include "impact_damper/base/number_text.hpp"

namespace impact_damper {
namespace {

std::string rounded(double value) { return rounded_text(value, 6); }
// Rounded to at most `value`, so that whoever types it in is not rejected.
std::string rounded_down(double value) { return rounded(value * (1 - 5e-6)); }

}  // namespace

Cem resolved(const Scene& scene, Cem options) {
  if (!options.time_step) {
    double half_period = std::numbers::pi;
    for (const SceneDamper& damper : scene.dampers)
      half_period = std::min(half_period, nominal_contact_time(damper));
    if (scene.force_amplitude != 0)
      half_period = std::min(half_period, std::numbers::pi / scene.force_frequency);
    options.time_step = half_period / 100;
  }
  return options;
}

std::vector<Problem> problems_of(const Scene& scene, const Cem& options) {
  std::vector<Problem> problems = problems_of(options);
  if (!problems.empty()) return problems;
  const double h = options.time_step.value();
  const double limit = stability_limit(scene, options.damper, options.calibration);
  if (!(h <= limit || options.unstable)) {
    problems.push_back(
        {"time_step",
         "must be <= " + rounded_down(limit) + ", got " + number_text(h) +
             ": beyond this stability limit the fastest mode in contact grows (angular frequency " +
             rounded(fastest_contact_frequency(scene)) + ", " + std::string(name_of(options.damper)) +
             " damper); take a smaller step, or run it all the same with --unstable"});
  }
  if (options.large_step) {
    const double large = *options.large_step;
    const double half_period = scene.force_amplitude != 0 ? std::numbers::pi / scene.force_frequency : 2;
    if (!(large > h && large < 2)) {
      problems.push_back({"large_step", "must be > " + rounded(h) +
                                            ", the time step, and < 2, the stability limit in flight, got " +
                                            number_text(large)});
    } else if (!(large <= half_period)) {
      problems.push_back({"large_step", "must be <= " + rounded_down(half_period) +
                                            ", half a period of the forcing, got " + number_text(large)});
    }
  }
  return problems;
}

}  // namespace impact_damper
