// Plants one fault in one output, where it leaves the library: planter.cpp is linked into every test program,
// around simulate(), the run files' writer and readers, figure_table() and measure(). The environment
// variable PLANTED_FAULT names the fault, "exact/impacts.time/shifted"; without it nothing is altered.
//
// A fault is of one of these kinds, as far as they change anything:
//   scaled   1 % off; a count one too large, the other wall, the next word
//   negated  the other sign
//   shifted  a column's first row put behind its last; what one of several dampers has given to another
//   filled   1 where a scalar is zero, 90 where an entry is absent
// A measure, which may be zero but for rounding, is altered by 1e-9 at least.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "application/reproduction/catalogue.hpp"
#include "application/reproduction/table.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/run.hpp"

namespace planted {

inline constexpr std::array<std::string_view, 4> kinds{"scaled", "negated", "shifted", "filled"};

// Each alters what `output` names and returns whether there is such an output. Of several dampers the first
// one's numbers are altered, "energy.dampers.1.impact_loss".
bool alter(impact_damper::Run& run, std::string_view output, std::string_view kind);  // "energy.final.wall"
bool alter(std::string& run_text, std::string_view output, std::string_view kind);    // the same, in a file
bool alter(impact_damper::Table& table, std::string_view output, std::string_view kind);    // "curve.2"
bool alter(impact_damper::Spread& spread, std::string_view output, std::string_view kind);  // "median"

// "loss_factor-eta": what tables of equal blocks have in common.
std::string kind_of_table(const impact_damper::Figure& figure);
// "curve" for "curve-2": blocks that are made alike.
std::string family(std::string block);

}  // namespace planted
