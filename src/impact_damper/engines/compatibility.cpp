#include "impact_damper/engines/compatibility.hpp"

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/engines/cem.hpp"

namespace impact_damper {

std::vector<Problem> incompatibilities_of(const Scene& scene, const Engine& engine) {
  std::vector<Problem> problems;
  const bool one = has_one_damper(scene);
  for (std::size_t i = 0; !one && has_rigid_walls(engine) && i < scene.dampers.size(); ++i) {
    const SceneDamper& damper = scene.dampers[i];
    if (within(0, damper.clearance).allows(damper.y0)) continue;
    problems.push_back({damper_field(i, "y0"), within(0, damper.clearance).describe("must be") +
                                                   ", its clearance, as walls are rigid, got " +
                                                   number_text(damper.y0)});
  }
  const Cem* const cem = std::get_if<Cem>(&engine);
  if (cem && cem->time_step) problems = problems_of(scene, *cem);
  if (one && has_rigid_walls(engine) && !within(0, 1).allows(scene.damper().y0)) {
    problems.push_back({"y0", within(0, 1).describe("must be") + " with the " + std::string(name_of(engine)) +
                                  " engine, whose walls are rigid, got " + number_text(scene.damper().y0)});
  }
  return problems;
}

}  // namespace impact_damper
