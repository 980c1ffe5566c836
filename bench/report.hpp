// What a run of the bench leaves: a JSON with every number, one with the results alone, tables for gnuplot, a
// page for people.
#pragma once

#include <filesystem>
#include <string>

#include "findings.hpp"

namespace impact_damper::bench {

std::string report_json(const Findings& findings);
std::string results_json(const Findings& findings);

// One block for each curve, "S1-exact": error, median and quartiles of the run time in reference operations,
// setting.
std::string time_error_table(const Findings& findings);
// One block for each sweep, "exact-impacts": at, reference operations per impact, residual.
std::string sweep_table(const Findings& findings);

std::string report_page(const Findings& findings);

}  // namespace impact_damper::bench
