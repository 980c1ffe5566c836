// Question and answer of a design as JSON, schema "impact-damper/design/1" (data/schema/design.schema.json).
#pragma once

#include <string>

#include "application/sweeps/lightest_design.hpp"

namespace impact_damper {

// Returns the text. `dimensionless`: the scene was made by with_unit_scales(). The question's scene must have
// secondary_mass and clearance.
std::string design_text(const DesignQuestion& question, const DesignAnswer& answer, bool dimensionless);

// Returns a force of an answer in unit_of(Dimension::force, !dimensionless). `dimensionless` as above; the
// question's scene must then have a clearance.
double force_in_unit(double force, const DesignQuestion& question, bool dimensionless);

// Returns the file text of a plan, with which `sweep` makes the neighbours of a design.
std::string plan_text(const Plan& plan);

}  // namespace impact_damper
