#include "application/report/page.hpp"

#include <algorithm>
#include <stdexcept>

#include "application/report/quantities.hpp"
#include "impact_damper/io/provenance.hpp"
#include "impact_damper/io/scene_file.hpp"

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
           (findings.several()
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

}  // namespace impact_damper
