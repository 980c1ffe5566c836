// Readers of the parts of a response that the catalogue has, too. The document of the object collects
// problems.
#pragma once

#include <optional>

#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/steady/response_file.hpp"

namespace impact_damper {

// {"x", "v", "y", "w"}.
SceneState read_state(ObjectReader object, std::size_t dampers = 0);
// {"number", "from", "to", "count"} of a scene, {"number", "from", "to"}; absent if there are problems.
std::optional<Axis> read_axis(ObjectReader& object, const Scene& scene);
std::optional<ParameterRange> read_range(ObjectReader& object);
// Reads a rule. A missing key keeps its default, or is a problem unless `may_be_missing`.
void read_rule(ObjectReader& object, bool may_be_missing, SteadyRule& rule);
void read_rule(ObjectReader& object, bool may_be_missing, BasinRule& rule);
void read_rule(ObjectReader& object, bool may_be_missing, BranchRule& rule);

}  // namespace impact_damper
