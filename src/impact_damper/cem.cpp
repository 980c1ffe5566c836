#include "impact_damper/cem.hpp"

#include <charconv>
#include <numbers>
#include <stdexcept>
#include <string>

#include "impact_damper/numerical_failure.hpp"

namespace impact_damper {
namespace {

std::string number(double value, int digits) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits).ptr;
  return {text, end};
}

}  // namespace

Cem resolved(const Scene& scene, Cem options) {
  if (!options.time_step) {
    double half_period = std::min(nominal_contact_time(scene), std::numbers::pi);
    if (scene.force_amplitude != 0) half_period = std::min(half_period, std::numbers::pi / scene.force_frequency);
    options.time_step = half_period / 100;
  }
  return options;
}

std::vector<Problem> problems_of(const Scene& scene, const Cem& options) {
  const double h = options.time_step.value();
  if (!(h > 0 && std::isfinite(h))) return {{"time_step", "must be > 0, got " + number(h, 6)}};
  const double limit = stability_limit(scene, options.damper, options.calibration);
  if (h <= limit || options.unstable) return {};
  return {{"time_step", "must be <= " + number(limit, 6) + ", got " + number(h, 6) +
                            ": beyond it the contact's fastest mode grows (frequency " +
                            number(fastest_contact_frequency(scene), 6) + ", " +
                            std::string(name_of(options.damper)) +
                            " damper); take a smaller step, or give --unstable to run it all the same"}};
}

void require_no_problems(const Scene& scene, const Cem& options) {
  for (const Problem& problem : problems_of(scene, options)) {
    throw std::invalid_argument(problem.field + ": " + problem.message);
  }
}

void fail_of_overflow(double time, double step) {
  throw NumericalFailure("the component element method overflowed near time " + number(time, 6) +
                         " with time_step " + number(step, 6));
}

}  // namespace impact_damper
