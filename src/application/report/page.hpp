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

}  // namespace impact_damper
