#include "impact_damper/engines/compatibility.hpp"

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/engines/cem.hpp"

namespace impact_damper {

std::vector<Problem> incompatibilities_of(const Scene& scene, const Engine& engine) {
  std::vector<Problem> problems;
  if (!scene.dampers.empty()) {
    for (std::size_t i = 0; has_rigid_walls(engine) && i < scene.dampers.size(); ++i) {
      const SceneDamper& damper = scene.dampers[i];
      if (within(0, damper.clearance).allows(damper.y0)) continue;
      problems.push_back({"dampers[" + std::to_string(i) + "].y0",
                          within(0, damper.clearance).describe("must be") +
                              ", its clearance, as walls are rigid, got " + number_text(damper.y0)});
    }
  }
  if (const Cem* const cem = std::get_if<Cem>(&engine)) problems = problems_of(scene, resolved(scene, *cem));
  if (scene.dampers.empty() && has_rigid_walls(engine) && !within(0, 1).allows(scene.y0)) {
    problems.push_back({"y0", within(0, 1).describe("must be") + " with the " + std::string(name_of(engine)) +
                                  " engine, whose walls are rigid, got " + number_text(scene.y0)});
  }
  return problems;
}

}  // namespace impact_damper
