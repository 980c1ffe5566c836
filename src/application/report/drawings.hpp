// The tables that a report's figures draw, each with the script that draws it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "application/report/findings.hpp"
#include "application/reproduction/table.hpp"

namespace impact_damper {

struct Drawing {
  std::string name;    // of its files and its place on the page: "decay"
  std::string script;  // in figures/
  std::string title;
  Table table;
  std::size_t every = 1;  // only one in so many rows of its longest block is drawn
};

// Returns the drawings of the findings, in the order of the page:
//
//   decay        "curve" (time, amplitude), "band" (time, least, greatest) if there is an ensemble
//   loss         as the table of a figure of the loss factor (reproduction/series.hpp) with one curve, that
//                of the local loss factor; closed forms are those of zeta = 0, on which 2 zeta is put;
//                "fold" (amplitude)
//   response     forced motion: "rising" and "falling" (frequency, amplitude) of the motions that are
//                periodic, "rising-open" and "falling-open" of those that are not, "locked" and "empty"
//                likewise, "given" (frequency)
//   phase        as the table of the figure of phases, but for what the scene has nothing of
//   begin, best  as the table of a figure of motion
//   prediction   "curve" (time, spread of the ensemble's amplitudes in percent)
//
// A scene in units has "scales" (s in 1/Omega_n, mm in epsilon, Hz in Omega_n) beside these.
std::vector<Drawing> drawings_of(const Findings& findings);

}  // namespace impact_damper
