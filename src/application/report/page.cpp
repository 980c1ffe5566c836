// The frame of a report's page, and its section about the scene itself.
#include "application/report/page.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "application/report/quantities.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/io/provenance.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {
namespace {

struct Section {
  std::string id, title;
  std::string html;                   // text with its numbers
  std::vector<std::string> drawings;  // names; they follow the text
};

std::string caption_of(const std::string& name, const Findings& findings) {
  if (name == "response")
    return "The largest amplitude under the same force over its frequency. Triangles: with " +
           damper_of(findings) +
           ", pointing up where the frequency has risen to there, down where it has fallen; open: a motion "
           "that is not periodic, or not steady yet. Dashed: " +
           masses_of(findings) + " locked to " + boxes_of(findings) + ", and the " +
           (findings.several() ? "boxes" : "box") + " empty. Upright: the frequency given.";
  if (name == "decay")
    return "Each half cycle's peak amplitude. Pale: the least and greatest of all releases, where they part.";
  if (name == "loss")
    return std::string("The loss factor over the amplitude; a decay runs from right to left. Pale: all ") +
           (!is_ideal(findings.subject.scene) ? "releases."
            : findings.several()
                ? "releases. Marks: where by the closed form for a light mass the impacts of a damper fail."
                : "releases. Thin: closed forms for a light mass, with the primary system's own damping put "
                  "on. Dashed: where the closed form ends and impacts fail.");
  if (name == "phase")
    return "Each dot is an impact: when in its half cycle, counted in degrees from one zero crossing to the "
           "next, over the half cycle's amplitude. Grey: stuck to a wall. Green: so many impacts in each "
           "half cycle.";
  if (name == "prediction")
    return "Greatest less least amplitude of all releases, in percent of their median.";
  return "Above, the secondary mass between the walls of its cavity; below, the displacement of the cavity.";
}

// Returns a picture as part of a page: without what only a file of its own needs, and with a description for
// readers who cannot see it.
std::string inline_svg(const std::string& svg, const std::string& title, const std::string& caption) {
  const std::size_t begin = svg.find("<svg");
  if (begin == std::string::npos) throw std::invalid_argument("a picture must be an SVG");
  return R"(<svg role="img" aria-label=")" + escaped(title + ". " + caption) + '"' + svg.substr(begin + 4);
}

std::string figure_html(const Drawing& drawing, const std::string& svg, const Findings& findings) {
  std::string caption = caption_of(drawing.name, findings);
  if (drawing.every > 1) caption += " One of every " + std::to_string(drawing.every) + " is drawn.";
  return R"(<figure class="plot" id="figure-)" + drawing.name + "\"><div class=\"drawing\">\n" +
         inline_svg(svg, drawing.title, caption) + "</div><figcaption>" + drawing.title + ". " + caption +
         "</figcaption></figure>\n";
}

std::string section_html(const Section& section, const std::vector<Drawing>& drawings,
                         const std::map<std::string, std::string>& svgs, const Findings& findings) {
  std::string html = "<section id=\"" + section.id + "\">\n<h2>" + section.title + "</h2>\n" + section.html;
  if (svgs.empty()) return html + "</section>\n";
  bool drawn = section.drawings.empty();
  for (const Drawing& drawing : drawings) {
    if (std::ranges::find(section.drawings, drawing.name) == section.drawings.end()) continue;
    html += figure_html(drawing, svgs.at(drawing.name), findings);
    drawn = true;
  }
  if (!drawn) html += "<p>There is no picture of it.</p>\n";
  return html + "</section>\n";
}

std::string made_html(const Findings& findings, bool with_figures) {
  return "<p>By <code>impact-damper report" + std::string(with_figures ? "" : " --without-figures") +
         "</code>, version " + escaped(provenance().version) + ", with the engine <code>" +
         std::string(name_of(findings.subject.engine)) +
         "</code>. Equal scene, equal bytes. The scene as the program keeps it, for <code>impact-damper run "
         "--scene</code>:</p>\n"
         "<pre><code>" +
         escaped(scene_text(findings.subject.scene)) +
         "</code></pre>\n"
         "<p>Each number above carries all its digits in the page's source, in <code>&lt;data "
         "value&gt;</code>.</p>\n";
}

void put_in(std::string& page, const std::string& name, std::string_view text) {
  const std::string place = "{{" + name + "}}";
  const std::size_t at = page.find(place);
  if (at == std::string::npos) throw std::invalid_argument("the page's frame has no place for " + name);
  page.replace(at, place.size(), text);
}

// A table with a row for each number: name, in units, dimensionless. Without scales the middle column is
// omitted.
class SceneTable {
 public:
  explicit SceneTable(const Subject& subject) : scales_(subject.scales) {}

  void row(const std::string& what, const std::string& symbol, double value, Dimension dimension) {
    std::vector<std::string> cells{what};
    if (scales_) cells.push_back(dimension == Dimension::ratio ? "" : in_units(value, dimension));
    cells.push_back((symbol.empty() ? "" : "<i>" + symbol + "</i> = ") + number_html(value, 4));
    table_.rows.push_back(std::move(cells));
  }
  // Adds a quantity that only scales, which a dimensionless scene does not have.
  void scale(const std::string& what, const std::string& symbol, Dimension dimension) {
    if (scales_) table_.rows.push_back({what, in_units(1, dimension), "<i>" + symbol + "</i>, a scale"});
  }
  std::string html(const std::string& caption) {
    table_.caption = caption;
    table_.heads = {"Quantity"};
    if (scales_) table_.heads.emplace_back("In units");
    table_.heads.emplace_back("Dimensionless");
    return table_html(table_);
  }

 private:
  std::string in_units(double value, Dimension dimension) const {
    return with_unit(number_html(value * scales_->of(dimension), 4), unit_of(dimension, true));
  }
  std::optional<Scales> scales_;
  HtmlTable table_;
};

std::string scene_table(const Subject& subject) {
  const Scene& scene = subject.scene;
  using enum Dimension;
  const bool rigid = has_rigid_walls(subject.engine), several = !has_one_damper(scene);
  SceneTable table(subject);
  table.scale("Primary mass", "M", mass);
  table.scale("Stiffness", "K", stiffness);
  table.scale("Natural frequency, Ω/2π", "Ω", frequency);
  table.scale(several ? "Clearance of the first damper" : "Clearance of the secondary mass", "ε", length);
  const SceneDamper& damper = scene.damper();
  if (!several) {
    table.row("Secondary mass", "ν", damper.mass_ratio, mass);
    table.row("Restitution", "e", damper.restitution, ratio);
  }
  table.row("Viscous damping of the primary mass", "ζ", scene.damping_ratio, damping);
  if (!several && !rigid) table.row("Stiffness of the walls", "k", damper.wall_stiffness, stiffness);
  table.row("Initial displacement", "x", scene.x0, length);
  table.row("Initial velocity", "x′", scene.v0, velocity);
  if (!several) {
    table.row("Secondary mass, from the left wall", "y", damper.y0, length);
    table.row("Its velocity in the cavity", "y′", damper.w0, velocity);
  }
  if (!several && damper.friction != 0)
    table.row("Friction, by the mass", "φ", damper.friction, acceleration);
  if (!several && damper.static_friction != 0)
    table.row("Static friction, by the mass", "φ<sub>s</sub>", damper.static_friction, acceleration);
  if (!several && damper.drag != 0) table.row("Drag in the cavity", "d", damper.drag, ratio);
  if (scene.weight != 0)
    table.row("Weight towards the left wall, by the mass", "γ", scene.weight, acceleration);
  if (scene.force_amplitude != 0) {
    table.row("Exciting force, amplitude", "f", scene.force_amplitude, force);
    table.row("Its frequency", "ω", scene.force_frequency, frequency);
  }
  if (scene.until_time) table.row("Ends at this time", "t", *scene.until_time, time);
  if (scene.until_amplitude) table.row("Ends below this amplitude", "A", *scene.until_amplitude, length);
  return table.html(subject.scales ? "The scene, as it was given and as it is computed"
                                   : "The scene, as it is computed");
}

// Returns the table of several dampers, in units if they are known.
std::string dampers_table(const Subject& subject) {
  struct Column {
    std::string what, symbol;
    double SceneDamper::*number;
    Dimension dimension;
  };
  using enum Dimension;
  std::vector<Column> columns{{"secondary mass", "ν", &SceneDamper::mass_ratio, mass},
                              {"clearance", "c", &SceneDamper::clearance, length},
                              {"restitution", "e", &SceneDamper::restitution, ratio},
                              {"stiffness of the walls", "k", &SceneDamper::wall_stiffness, stiffness},
                              {"place at first", "y", &SceneDamper::y0, length},
                              {"velocity at first", "y′", &SceneDamper::w0, velocity}};
  if (has_rigid_walls(subject.engine)) columns.erase(columns.begin() + 3);
  for (const Column& each :
       {Column{"friction by the mass", "φ", &SceneDamper::friction, acceleration},
        Column{"static friction by the mass", "φ<sub>s</sub>", &SceneDamper::static_friction, acceleration},
        Column{"drag by <i>m</i>Ω", "d", &SceneDamper::drag, ratio}})
    if (std::ranges::any_of(subject.scene.dampers,
                            [&](const SceneDamper& its) { return its.*each.number != 0; }))
      columns.push_back(each);
  const bool in_units = subject.scales.has_value();
  HtmlTable table{.caption = in_units ? "Its dampers" : "Its dampers, dimensionless", .heads = {"Damper"}};
  for (const Column& each : columns) {
    const std::string unit(in_units ? unit_of(each.dimension, true) : "");
    table.heads.push_back(each.what + ", " + (unit.empty() ? "<i>" + each.symbol + "</i>" : unit));
  }
  for (const SceneDamper& damper : subject.scene.dampers) {
    std::vector<std::string>& row = table.rows.emplace_back(1, std::to_string(table.rows.size() + 1));
    for (const Column& each : columns)
      row.push_back(number_html(damper.*each.number * scale_of(each.dimension, subject.scales), 4));
  }
  return table_html(table);
}

// Describes the method of the engine, from the options of the run, which are filled in.
struct Method {
  bool several;
  std::string operator()(const Exact&) const {
    if (several)
      return "The walls are springs with dampers, and each stretch of the motion is a closed form or, where "
             "several walls are pushed at once, a power series that is as good: there is no time step, and "
             "no impact is missed.";
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

std::string end_in_words(StopReason reason) {
  const auto used_up = [](const std::string& what, const std::string& option) {
    return "until the allowed " + what + " was used up (<code>--max-" + option + "</code>)";
  };
  switch (reason) {
    case StopReason::time:
      return "the time that was asked for";
    case StopReason::amplitude:
      return "until the amplitude was below the one asked for";
    case StopReason::impact_budget:
      return used_up("number of impacts", "impacts");
    case StopReason::half_cycle_budget:
      return used_up("number of half cycles", "half-cycles");
    case StopReason::time_budget:
      return used_up("time", "time");
    case StopReason::step_budget:
      return used_up("number of steps", "steps");
  }
  return "";
}

// What is assumed of the cavity, and below which amplitude friction and weight hold the secondary mass in it.
std::string cavity_sentences(const Findings& findings) {
  const Subject& subject = findings.subject;
  const Scene& scene = subject.scene;
  const Quantities quantities(subject.scales);
  const double omega = findings.forced() ? scene.force_frequency : 1 / std::sqrt(1 + secondary_mass(scene));
  const auto locking = [&](double most) { return quantities.length(locking_amplitude(omega, most)); };
  const std::string them = findings.several() ? "them" : "it";
  const std::string damps_nothing = " the primary mass swings with " + them + " and is not damped by " + them;
  if (has_components(scene)) {
    double least = std::numeric_limits<double>::infinity();
    for (const SceneDamper& damper : scene.dampers) least = std::min(least, damper.holding() + scene.weight);
    if (least == 0) return "";
    const std::string what = least == scene.weight ? " its weight keeps "
                             : scene.weight == 0   ? " friction keeps "
                                                   : " friction and weight keep ";
    return paragraph_html("Below an amplitude of " + locking(least) + what +
                          (findings.several() ? "all secondary masses at rest in their cavities:"
                                              : "the secondary mass at rest in its cavity:") +
                          damps_nothing + ".");
  }
  const std::string they = findings.several() ? "they" : "it";
  std::string text = findings.several() ? "It is assumed that the secondary masses move in level cavities"
                                        : "It is assumed that the secondary mass moves in a level cavity";
  text += " without friction, as on rollers or on a thread. ";
  if (subject.scales && subject.gravity == 0) {
    text += "Without gravity nothing presses " + std::string(findings.several() ? "them" : "it") +
            " on a floor that could rub.";
  } else if (subject.scales) {
    const double g = subject.gravity / subject.scales->of(Dimension::acceleration);
    text +=
        "If " + they + " slid with a coefficient of friction of 0.1, 0.2 or 0.3, " + they +
        " would be held there below an amplitude of " + locking(0.1 * g) + ", " + locking(0.2 * g) + " or " +
        locking(0.3 * g) + ", and would not leave the floor of an upright cavity below " + locking(g) + ":" +
        damps_nothing +
        " there. <code>friction_coefficient</code> and <code>inclination</code> in the scene compute more.";
  } else {
    text += "With a friction φ, divided by the mass and by εΩ², " + they +
            " would be held there below an amplitude of " +
            (findings.forced() ? "φε/ω<sup>2</sup>" : "about φε") + ":" + damps_nothing +
            ". <code>--friction</code> and <code>--weight</code> compute more.";
  }
  return paragraph_html(text);
}

std::string engine_sentence(const Findings& findings) {
  return "<p>" + std::visit(Method{findings.several()}, findings.run.engine) + " It was followed for " +
         Quantities(findings.subject.scales).time(findings.run.end_time) + ", " +
         end_in_words(findings.run.stop_reason) + ".</p>\n";
}

}  // namespace

std::string page_html(const Findings& findings, const std::vector<Drawing>& drawings,
                      const std::map<std::string, std::string>& svgs, std::string_view frame,
                      const std::map<std::string, std::string_view>& parts) {
  const Subject& subject = findings.subject;
  std::vector<Section> sections{
      {"scene", "The scene", scene_html(findings), {}},
      {"decay", findings.forced() ? "Amplitude over time" : "Decay", decay_html(findings), {"decay"}},
      findings.forced()
          ? Section{"response", "Amplitude over frequency", response_html(findings), {"response"}}
          : Section{"loss", "Loss factor", loss_html(findings), {}},
      findings.several() ? Section{"dampers", "The dampers", dampers_html(findings), {}}
                         : Section{"regimes", "Regimes", regimes_html(findings), {}},
      {"phase",
       "Phase of the impacts",
       svgs.contains("phase")
           ? std::string(findings.several() ? "<p>Of the damper that took most of the energy: "
                                            : "<p>The same regimes at a glance: ") +
                 "branches where the motion is regular, clouds where it is chaotic.</p>\n"
           : "<p>A phase is counted from zero crossing to zero crossing, and no impact lies between "
             "two.</p>\n",
       {"phase"}},
      {"motion", "The motion itself", motion_html(findings), {"begin", "best"}},
      {"loads", "What the walls bear", loads_html(findings), {}},
      {"energy", "Where the energy goes", energy_html(findings), {}},
      {"prediction", "How far this can be predicted", prediction_html(findings), {"prediction"}},
      {"made", "How this page was made", made_html(findings, !svgs.empty()), {}},
  };
  if (svgs.empty()) std::erase_if(sections, [](const Section& section) { return section.id == "phase"; });
  const std::string name = escaped(subject.name);
  std::string body = "<header>\n<h1>Impact damper: " + name + "</h1>\n";
  if (!subject.description.empty()) body += "<p>" + escaped(subject.description) + "</p>\n";
  body += warnings_html(findings) + summary_html(findings) + "</header>\n<nav aria-label=\"Contents\"><ul>\n";
  for (const Section& section : sections)
    body += "<li><a href=\"#" + section.id + "\">" + section.title + "</a></li>\n";
  body += "</ul></nav>\n<main>\n";
  for (Section section : sections) {
    // Without a loss factor the text has said why.
    if (section.id == "loss" && svgs.contains("loss")) section.drawings = {"loss"};
    body += section_html(section, drawings, svgs, findings);
  }
  body += "</main>";

  // An inserted text must not contain the place of a later one: texts of the user come last.
  std::string page(frame);
  for (const auto& [part, text] : parts) put_in(page, part, text);
  put_in(page, "title", name + " – impact damper");
  put_in(page, "body", body);
  return page;
}

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
                ", times in periods 2π/Ω of the primary mass on its spring, velocities in units of εΩ, "
                "energies in units of Kε².</p>\n"
          : "<p>Lengths are in units of " +
                std::string(findings.several() ? "one length ε" : "the clearance ε of the secondary mass") +
                ", times <i>t</i> in units of 1/Ω, Ω = √(K/M) being the primary mass's natural frequency, "
                "velocities in units of εΩ, energies in units of Kε². A scene file may give masses in "
                "kilograms and lengths in millimetres instead; this page then gives both.</p>\n";
  return scene_table(findings.subject) + (findings.several() ? dampers_table(findings.subject) : "") +
         scales + engine_sentence(findings) + cavity_sentences(findings) + friction_html(findings);
}

}  // namespace impact_damper
