// What was asked and what was found as JSON, schema "impact-damper/design/1"
// (data/schema/design.schema.json).
#pragma once

#include <string>

#include "impact_damper/sweeps/lightest_design.hpp"

namespace impact_damper {

// `dimensionless`: the scene was made by with_unit_scales(). The question's scene must have secondary_mass
// and clearance.
std::string design_text(const DesignQuestion& question, const DesignAnswer& answer, bool dimensionless);

// What an answer's numbers are in.
struct DesignUnits {
  std::string_view mass, length, time, velocity, force;
  double force_scale = 1;  // the answer's forces times it are in `force`
};
// `dimensionless` as above; the question's scene must then have a clearance.
DesignUnits units_of(const DesignQuestion& question, bool dimensionless);

// The plan that `sweep` makes the neighbours of a design with, as the text of its file.
std::string plan_text(const Plan& plan);

}  // namespace impact_damper
