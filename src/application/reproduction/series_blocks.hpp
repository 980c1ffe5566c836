// The blocks of the figures' tables, by kind; parts of series.hpp.
#pragma once

#include <span>
#include <string>

#include "application/reproduction/series.hpp"
#include "impact_damper/base/errors.hpp"

namespace impact_damper {

// Returns the error of a figure that cannot be made from a file: "figure 8: FILE: why".
InputError unusable(const Figure& figure, const std::filesystem::path& file, const std::string& why);

// Returns the first lines of a table's header.
std::vector<std::string> header_of(const Figure& figure, const std::string& parameters);

// Returns the engine with the options that decide the motion, for a table's header.
std::string options_text(const Engine& engine);

// Returns the run's half cycles. Throws unusable() if there is none, or none down to Figure::down_to.
const HalfCycles& half_cycles_of(const Figure& figure, const FigureRun& source);

// Throws unusable() unless the run holds impacts and contacts.
void require_impacts(const Figure& figure, const FigureRun& source);

void add_motion_blocks(const Figure& figure, const FigureRun& source, Table& table);
// Adds these blocks for the samples [first, last] of any run's history, as far as there is something to show:
// "motion", and "impacts" and "stuck" if there are any. Needs impacts and contacts.
void add_motion_parts(const Run& run, std::size_t first, std::size_t last, Table& table);
void add_loss_block(const Figure& figure, const FigureCurve& curve, const FigureRun& source,
                    const std::string& number, const std::string& legend, Table& table);
// One of the curves that a band encloses: its rows in the order of time.
struct BandCurve {
  std::span<const double> amplitude, ordinate;
};
// Adds rows (amplitude, least, greatest) to the block, where all of the curves have an ordinate: linear
// between the first row below the amplitude and the one before it.
void add_band_rows(const std::vector<BandCurve>& curves, const std::vector<double>& amplitudes,
                   TableBlock& block);
void add_spread_block(const Figure& figure, Table& table);
void add_loss_theory_blocks(const Figure& figure, const std::vector<const FigureRun*>& sources, Table& table);
void add_phase_blocks(const Figure& figure, const FigureRun& source, Table& table);
// Adds these blocks for any run, as far as there is something to show. Needs half cycles, impacts and
// contacts.
void add_phase_parts(const Run& run, Table& table);

const Scene& scene_of(const Response& response);
void add_response_blocks(const Figure& figure, const std::vector<const FigureResponse*>& sources,
                         Table& table);
void add_largest_blocks(const Figure& figure, const FigureRun& decay,
                        const std::vector<const FigureResponse*>& sources, Table& table);
void add_map_blocks(const Figure& figure, const FigureResponse& source, Table& table);

// Return the whole table.
Table design_table(const Figure& figure, const SweepTable& sweep);
Table damper_sets_table(const Figure& figure, const FigureRuns& runs);

}  // namespace impact_damper
