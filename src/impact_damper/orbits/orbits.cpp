#include "impact_damper/orbits/orbits.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "impact_damper/engines/checked.hpp"
#include "impact_damper/orbits/corrector.hpp"

namespace impact_damper {

namespace {

using namespace corrector;

// Whether that residual is at most `gap`, in units of the larger of 1 and |s|.
bool closes_after(const Equation& equation, const Point& p, int half_periods, double gap) {
  const auto residual = residual_after(equation, p, half_periods);
  return residual && largest(*residual) <= gap * std::max(1.0, largest(state_at(p)));
}

}  // namespace

double Scene::*member_of(Parameter parameter) {
  switch (parameter) {
    case Parameter::force_frequency:
      return &Scene::force_frequency;
    case Parameter::force_amplitude:
      return &Scene::force_amplitude;
  }
  return {};
}

Expected<Orbit, NoOrbit> find_orbit(const Scene& scene, const Engine& engine, int periods,
                                    const SceneState& guess, const OrbitOptions& options) {
  if (guess.dampers.size() != scene.dampers.size())
    require_none(
        {{"guess", "must be of as many dampers as the scene's list, " + std::to_string(scene.dampers.size()) +
                       ", got " + std::to_string(guess.dampers.size())}});
  Scene guessed = released_from(scene, guess);
  guessed.until_time = 1;
  std::vector<Problem> problems = impact_damper::problems_of(guessed);
  if (problems.empty()) problems = incompatibilities_of(guessed, engine);
  for (const Problem& problem : corrector::problems_of(options)) problems.push_back(problem);
  if (!(periods >= 1)) problems.push_back({"periods", "must be >= 1"});
  if (options.symmetric && periods % 2 == 0)
    problems.push_back({"periods", "must be odd for a symmetric orbit"});
  if (options.symmetric && !has_mirror(scene))
    problems.push_back({"symmetric", "must be false with weight, without which left and right are alike"});
  require_none(problems);

  Equation equation{scene, engine, options.symmetric ? periods : 2 * periods, Parameter::force_frequency,
                    options};
  const Point start = point_at(vector_of(guess), scene.force_frequency);
  Solved found = solve(equation, start, start, at_value(start));
  if (!found) return found.failure();

  // The least number of half periods after which the orbit closes.
  for (int n = 1; n < equation.half_periods; ++n) {
    const bool divides = equation.half_periods % n == 0 && (n % 2 == 0 || has_mirror(scene));
    if (!divides || !closes_after(equation, found->point, n, 100 * options.tolerance)) continue;
    Equation less = equation;
    less.half_periods = n;
    Solved shorter = solve(less, found->point, found->point, at_value(found->point));
    if (!shorter) continue;
    shorter->residuals = std::move(found->residuals);
    found = std::move(shorter);
    equation = less;
    break;
  }
  const bool symmetric = equation.half_periods % 2 != 0;
  periods = symmetric ? equation.half_periods : equation.half_periods / 2;
  return orbit_of(equation, *found, periods, symmetric);
}

Expected<Orbit, NoOrbit> branching_off(const BranchEvent& event, Parameter parameter,
                                       const OrbitOptions& options) {
  require_none(corrector::problems_of(options));
  const Orbit& from = event.orbit;
  const bool doubles =
      event.kind == BranchEventKind::flip || event.kind == BranchEventKind::symmetry_breaking;
  if (!doubles) return NoOrbit{};
  const int half_periods = from.symmetric ? from.periods : 2 * from.periods;
  const Equation equation{from.scene, from.engine, 2 * half_periods, parameter, options};
  const Point origin = point_at(vector_of(release_of(from.scene)), event.parameter);
  const auto image =
      PoincareMap(equation.scene_at(event.parameter), from.engine, half_periods)(release_of(from.scene));
  if (!image) return NoOrbit{OrbitEnd::run_stopped};
  const std::optional<StateVector> direction = eigenvector_of_minus_1(*image, from.scene);
  if (!direction) return NoOrbit{};
  const Point normal = point_at(*direction, 0);
  for (const double gap : {0.01, -0.01, 0.001, -0.001}) {
    const Point start = along(origin, gap, normal);
    const Solved found = solve(equation, origin, start, {start, normal});
    if (!found) continue;
    // H^n(s) - s is zero on the branch of H^n. On the new one it leads to the other side, by about 2 gap.
    const auto residual = residual_after(equation, found->point, half_periods);
    if (residual && largest(*residual) > std::fabs(gap) / 2)
      return orbit_of(equation, *found, half_periods, false);
  }
  return NoOrbit{};
}

}  // namespace impact_damper
