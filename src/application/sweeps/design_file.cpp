#include "application/sweeps/design_file.hpp"

#include "application/sweeps/plan_file.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/run_file.hpp"

namespace impact_damper {
namespace {

using Layout = JsonWriter::Layout;

void write_question(JsonWriter& out, const DesignQuestion& question) {
  out.open_object("question", Layout::lines);
  out.open_object("scene", Layout::one_line);
  const Design given{*question.scene.damper().secondary_mass, *question.scene.damper().clearance};
  write_unit_fields(out, *scene_of_design(question, given, longest_followed * question.time).in_units);
  out.close();
  write_engine(out, question.engine);
  out.fields("amplitude", question.amplitude, "time", question.time, "share", question.share);
  out.object("secondary_mass", Layout::one_line, "least", question.secondary_mass.least, "most",
             question.secondary_mass.most);
  out.object("clearance", Layout::one_line, "least", question.clearance.least, "most",
             question.clearance.most);
  out.open_array("tolerances", Layout::one_line);
  for (const SampledNumber& each : question.tolerances) {
    out.open_object(Layout::one_line);
    out.fields("number", each.variable.name, "half_width", each.width, "relative", each.relative);
    out.close();
  }
  out.close();
  out.fields("neighbours", question.neighbours, "seed", question.seed);
  out.close();
}

void write_design(JsonWriter& out, const FoundDesign& found, const DesignQuestion& question,
                  bool dimensionless) {
  const DesignCheck& check = found.check;
  out.open_object(Layout::one_line);
  out.fields("time", found.time, "widest_clearance", found.widest, "secondary_mass",
             found.design.secondary_mass, "clearance", found.design.clearance, "nominal_time",
             check.nominal_time, "time_of_share", check.time_of_share, "slowest", check.slowest, "in_time",
             check.in_time, "share_low", check.share.low, "share_high", check.share.high, "confirmed",
             check.confirmed, "largest_impact_speed", check.largest_impact_speed);
  std::optional<double> force = check.largest_wall_force;
  if (force) force = force_in_unit(*force, question, dimensionless);
  out.field("largest_wall_force", force);
  out.close();
}

}  // namespace

double force_in_unit(double force, const DesignQuestion& question, bool dimensionless) {
  return dimensionless ? force * (1 / scales_of(question.scene).of(Dimension::force)) : force;
}

std::string design_text(const DesignQuestion& question, const DesignAnswer& answer, bool dimensionless) {
  JsonWriter out("design");
  out.open_object(Layout::lines);
  out.field("schema", "impact-damper/design/1");
  write_question(out, question);
  out.open_object("units", Layout::one_line);
  using enum Dimension;
  for (const Dimension each : {mass, length, time, velocity, force})
    out.field(name_of(each), unit_of(each, !dimensionless));
  out.close();
  out.object("search", Layout::one_line, "draws", answer.draws, "late_allowed", answer.late_allowed, "runs",
             answer.runs);
  out.field("met", answer.met);
  out.open_array("designs", Layout::lines);
  for (const FoundDesign& each : answer.designs) write_design(out, each, question, dimensionless);
  out.close();
  write_provenance(out);
  return sealed(out.finish());
}

std::string plan_text(const Plan& plan) {
  JsonWriter out("plan");
  out.open_object(Layout::lines);
  write_plan_fields(out, plan);
  out.close();
  return out.finish() + '\n';
}

}  // namespace impact_damper
