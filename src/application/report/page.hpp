// The page about one scene: its findings in sentences, tables and figures, as one HTML file that needs no
// other. Every number in it is computed; a section that does not apply to this scene says what is missing.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "application/report/drawings.hpp"
#include "application/report/findings.hpp"

namespace impact_damper {

// Returns the page. `svgs`: one SVG text for each of the `drawings`, by Drawing::name; if empty, the page has
// no figures. `frame` is the page with {{title}}, {{body}} and the names of the `parts` that are inserted, as
// {{page.css}}. Throws std::invalid_argument if a text is no SVG or `frame` lacks a place, std::out_of_range
// if a picture is missing.
std::string page_html(const Findings& findings, const std::vector<Drawing>& drawings,
                      const std::map<std::string, std::string>& svgs, std::string_view frame,
                      const std::map<std::string, std::string_view>& parts);

// Return its sections as HTML, each from the findings: page.cpp, page_*.cpp.
std::string summary_html(const Findings& findings);   // a few sentences about everything
std::string warnings_html(const Findings& findings);  // about the scene; may be empty
std::string scene_html(const Findings& findings);
std::string friction_html(
    const Findings& findings);                     // what friction would change; empty if nothing is assumed
std::string decay_html(const Findings& findings);  // of a forced motion: its amplitudes
std::string loss_html(const Findings& findings);   // of a free motion
std::string response_html(const Findings& findings);      // of a forced one
std::string response_in_short(const Findings& findings);  // a few sentences; none if no motion is known
std::string loads_html(const Findings& findings);
std::string regimes_html(const Findings& findings);
std::string dampers_html(const Findings& findings);  // of several, in place of the regimes
std::string motion_html(const Findings& findings);
std::string energy_html(const Findings& findings);
std::string prediction_html(const Findings& findings);
// Return "the dampers" or "the damper" and so on, by how many the scene has.
std::string damper_of(const Findings& findings);
std::string masses_of(const Findings& findings);
std::string boxes_of(const Findings& findings);  // "their boxes"

}  // namespace impact_damper
