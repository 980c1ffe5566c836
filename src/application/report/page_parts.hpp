// The sections of a report's page as HTML, each from the findings. A part of page.hpp.
#pragma once

#include <string>

#include "application/report/findings.hpp"

namespace impact_damper {

std::string summary_html(const Findings& findings);   // a few sentences about everything
std::string warnings_html(const Findings& findings);  // about the scene; may be empty
std::string scene_html(const Findings& findings);
std::string decay_html(const Findings& findings);     // of a forced motion: its amplitudes
std::string loss_html(const Findings& findings);      // of a free motion
std::string response_html(const Findings& findings);  // of a forced one
// Returns the response in a few sentences; nothing if no motion is known.
std::string response_in_short(const Findings& findings);
std::string loads_html(const Findings& findings);
std::string regimes_html(const Findings& findings);
std::string dampers_html(const Findings& findings);  // of several, in place of the regimes
std::string motion_html(const Findings& findings);
std::string energy_html(const Findings& findings);
std::string prediction_html(const Findings& findings);

}  // namespace impact_damper
