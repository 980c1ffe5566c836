// The section of a report's page about the scene itself.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "impact_damper/analysis/cautions.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "application/report/page_parts.hpp"
#include "application/report/quantities.hpp"

namespace impact_damper {
namespace {

// A table with a row for each number: name, in units, dimensionless. Without scales the middle column is
// omitted.
class SceneTable {
 public:
  explicit SceneTable(const Subject& subject) : scales_(subject.scales) {}

  void row(const std::string& what, const std::string& symbol, double value, double scale,
           const std::string& unit) {
    std::vector<std::string> cells{what};
    if (scales_) cells.push_back(unit.empty() ? "" : number_html(value * scale, 4) + ' ' + unit);
    cells.push_back((symbol.empty() ? "" : "<i>" + symbol + "</i> = ") + number_html(value, 4));
    table_.rows.push_back(std::move(cells));
  }
  // Adds a quantity that only scales, which a dimensionless scene does not have.
  void scale(const std::string& what, const std::string& symbol, double value, const std::string& unit) {
    if (scales_)
      table_.rows.push_back({what, number_html(value, 4) + ' ' + unit, "<i>" + symbol + "</i>, a scale"});
  }
  std::string html(const std::string& caption) {
    table_.caption = caption;
    table_.heads = {"Quantity"};
    if (scales_) table_.heads.emplace_back("In units");
    table_.heads.emplace_back("Dimensionless");
    return table_html(table_);
  }

 private:
  std::optional<Scales> scales_;
  HtmlTable table_;
};

std::string scene_table(const Subject& subject) {
  const Scene& scene = subject.scene;
  const Scales scales = subject.scales.value_or(Scales{});
  const bool rigid = has_rigid_walls(subject.engine);
  SceneTable table(subject);
  table.scale("Primary mass", "M", scales.mass, "kg");
  table.scale("Stiffness", "K", scales.stiffness, "N/m");
  table.scale("Natural frequency, Ω/2π", "Ω", scales.frequency(), "Hz");
  const bool several = !has_one_damper(scene);
  table.scale(several ? "Clearance of the first damper" : "Clearance of the secondary mass", "ε",
              scales.length, "mm");
  if (!several) {
    table.row("Secondary mass", "ν", scene.damper().mass_ratio, scales.mass, "kg");
    table.row("Restitution", "e", scene.damper().restitution, 1, "");
  }
  table.row("Viscous damping of the primary mass", "ζ", scene.damping_ratio, scales.damping(), "N s/m");
  if (!several && !rigid)
    table.row("Stiffness of the walls", "k", scene.damper().wall_stiffness, scales.stiffness, "N/m");
  table.row("Initial displacement", "x", scene.x0, scales.length, "mm");
  table.row("Initial velocity", "x′", scene.v0, scales.velocity(), "mm/s");
  if (!several) {
    table.row("Secondary mass, from the left wall", "y", scene.damper().y0, scales.length, "mm");
    table.row("Its velocity in the cavity", "y′", scene.damper().w0, scales.velocity(), "mm/s");
  }
  if (scene.force_amplitude != 0) {
    table.row("Exciting force, amplitude", "f", scene.force_amplitude, scales.force(), "N");
    table.row("Its frequency", "ω", scene.force_frequency, scales.frequency(), "Hz");
  }
  if (scene.until_time) table.row("Ends at this time", "t", *scene.until_time, scales.time(), "s");
  if (scene.until_amplitude)
    table.row("Ends below this amplitude", "A", *scene.until_amplitude, scales.length, "mm");
  return table.html(subject.scales ? "The scene, as it was given and as it is computed"
                                   : "The scene, as it is computed");
}

// Returns the table of several dampers, in units if they are known.
std::string dampers_table(const Subject& subject) {
  const bool rigid = has_rigid_walls(subject.engine), in_units = subject.scales.has_value();
  const Scales scales = subject.scales.value_or(Scales{});
  HtmlTable table{
      .caption = in_units ? "Its dampers" : "Its dampers, dimensionless", .heads = {"Damper"}, .rows = {}};
  const auto head = [&](const std::string& what, const std::string& symbol, const std::string& unit) {
    table.heads.push_back(in_units && !unit.empty() ? what + ", " + unit : what + ", <i>" + symbol + "</i>");
  };
  head("secondary mass", "ν", "kg");
  head("clearance", "c", "mm");
  head("restitution", "e", "");
  if (!rigid) head("stiffness of the walls", "k", "N/m");
  head("place at first", "y", "mm");
  head("velocity at first", "y′", "mm/s");
  for (std::size_t n = 0; n < subject.scene.dampers.size(); ++n) {
    const SceneDamper& damper = subject.scene.dampers[n];
    const auto number = [&](double value, double scale) {
      return number_html(in_units ? value * scale : value, 4);
    };
    table.rows.push_back({std::to_string(n + 1), number(damper.mass_ratio, scales.mass),
                          number(damper.clearance, scales.length), number(damper.restitution, 1)});
    std::vector<std::string>& row = table.rows.back();
    if (!rigid) row.push_back(number(damper.wall_stiffness, scales.stiffness));
    row.push_back(number(damper.y0, scales.length));
    row.push_back(number(damper.w0, scales.velocity()));
  }
  return table_html(table);
}

// Describes the method of the engine, from the options of the run, which are filled in.
struct Method {
  bool several;
  std::string operator()(const Exact&) const {
    if (several)
      return "The walls are springs with dampers, and each stretch of the motion is a closed form or, where "
             "several "
             "walls are pushed at once, a power series that is as good: there is no time step, and no impact "
             "is "
             "missed.";
    return "The walls are springs with dampers, and each stretch of the motion is a closed form: there is no "
           "time step, and no impact is missed.";
  }
  std::string operator()(const Restitution&) const {
    return "The walls are rigid and impacts take no time; of infinitely many bounces the sum is taken.";
  }
  std::string operator()(const Cem& cem) const {
    return "The walls are springs with dampers, and the motion is followed by central differences with a "
           "fixed step of " +
           number_html(cem.time_step.value_or(0)) + " in units of 1/Ω.";
  }
};

std::string engine_sentence(const Findings& findings) {
  const Quantities quantities(findings.subject.scales);
  std::string text = "<p>" + std::visit(Method{findings.several()}, findings.run.engine);
  text += " It was followed for " + quantities.time(findings.run.end_time) + ", ";
  switch (findings.run.stop_reason) {
    case StopReason::time:
      text += "the time that was asked for";
      break;
    case StopReason::amplitude:
      text += "until the amplitude was below the one asked for";
      break;
    case StopReason::impact_budget:
      text += "until the allowed number of impacts was used up (<code>--max-impacts</code>)";
      break;
    case StopReason::half_cycle_budget:
      text += "until the allowed number of half cycles was used up (<code>--max-half-cycles</code>)";
      break;
    case StopReason::time_budget:
      text += "until the allowed time was used up (<code>--max-time</code>)";
      break;
    case StopReason::step_budget:
      text += "until the allowed number of steps was used up (<code>--max-steps</code>)";
      break;
  }
  return text + ".</p>\n";
}

}  // namespace

// Returns warnings about numbers that are valid but likely mistakes: a length in metres, a mass in grams.
std::string warnings_html(const Findings& findings) {
  const Scene& scene = findings.subject.scene;
  const Quantities quantities(findings.subject.scales);
  const double reach = std::max(std::abs(scene.x0), std::abs(scene.v0));
  std::vector<std::string> looks;
  for (std::string caution : cautions_of(scene, findings.subject.scales)) {
    if (caution.starts_with("the ")) caution[0] = 'T';
    looks.push_back(caution + (caution.ends_with('?') ? "" : "."));
  }
  if (quantities.in_units() && reach > 1000)
    looks.push_back("The primary mass begins with an amplitude of about " + quantities.length(reach) +
                    ": is the clearance given in millimetres?");
  if (quantities.in_units() && reach > 0 && reach < 1e-3)
    looks.push_back("The clearance is " + number_html(1 / reach) +
                    " times as long as the first amplitude: is it given in millimetres?");
  double softest = scene.damper().wall_stiffness;
  for (const SceneDamper& damper : scene.dampers) softest = std::min(softest, damper.wall_stiffness);
  if (softest < 100 && !has_rigid_walls(findings.subject.engine))
    looks.push_back(
        (findings.several() ? "The softest walls are only " : "The walls are only ") + number_html(softest) +
        " times as stiff as the primary spring: an impact takes as long as a good part of a period.");
  if (scene.damping_ratio >= 1)
    looks.push_back("The primary mass is damped " + number_html(scene.damping_ratio) +
                    " times critically: it creeps back and does not swing.");
  if (looks.empty()) return "";
  std::string html = "<p>Worth a second look:</p>\n<ul>\n";
  for (const std::string& look : looks) html += "<li>" + look + "</li>\n";
  return html + "</ul>\n";
}

std::string scene_html(const Findings& findings) {
  const std::string scales =
      findings.subject.scales
          ? "<p>Numbers are given in units first and, in brackets, dimensionless: lengths in units of the "
            "clearance ε" +
                std::string(findings.several() ? " of the first damper" : "") +
                ", times in periods 2π/Ω of the primary mass on its spring, velocities in units of "
                "εΩ, "
                "energies in units of Kε².</p>\n"
          : "<p>Lengths are in units of " +
                std::string(findings.several() ? "one length ε" : "the clearance ε of the secondary mass") +
                ", times <i>t</i> in units of "
                "1/Ω, Ω "
                "= √(K/M) "
                "being the primary mass's natural frequency, velocities in units of εΩ, energies in units of "
                "Kε². A "
                "scene file may give masses in kilograms and lengths in millimetres instead; this page then "
                "gives "
                "both.</p>\n";
  return scene_table(findings.subject) + (findings.several() ? dampers_table(findings.subject) : "") +
         scales + engine_sentence(findings);
}

}  // namespace impact_damper
