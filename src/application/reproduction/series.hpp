// The figure stage: from the runs of a figure's scenes to the table the figure draws. Everything that is
// computed for a figure is computed here; its script only draws.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "application/reproduction/catalogue.hpp"
#include "application/reproduction/table.hpp"
#include "application/sweeps/sweep_table.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/responses/response_file.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

struct FigureRun {
  std::filesystem::path file;  // where it was read from, for messages
  Run run;
  std::vector<Run> others{};  // the other members of its ensemble, for curves that show one
};
using FigureRuns = std::map<std::string, FigureRun>;  // by the name of the scene, or of the further run
struct FigureResponse {
  std::filesystem::path file;  // as above
  Response response;
};
using FigureResponses = std::map<std::string, FigureResponse>;  // by name
using FigureSweeps = std::map<std::string, SweepTable>;         // by the name of the plan's file

// Returns the number of members, the scene's own run among them, of the largest ensemble of that scene that
// the figure shows; 0 if it shows none.
std::int64_t members_shown(const Figure& figure, const std::string& scene);

// Returns the table of `figure`, which must not be a drawing; `runs` holds at least its scenes and further
// runs, with as many members of each as the figure shows, `responses` at least the responses, `sweeps` that
// of its plan. Blocks by kind:
//
//   motion       "motion" (time, x, x + 1, z = x + y, y); "impacts", which are also vertices of "motion", so
//                that its line meets the wall however few the samples; "stuck" if the mass sticks
//   decay        "curve-1" ... in the order of the figure's curves (time, amplitude); with Figure::down_to
//                "law" (mass ratio, average of -dA/dt / nu down to there), "line" (nu t, amplitude)
//   loss_factor  "curve-1" ... (amplitude, ordinate) and what of it lies behind impact failure, "failed-1"
//                ...; "band-1" ... (amplitude, least, greatest) for curves with an ensemble; "second-1"
//                ... in the second ordinate, if there is one; "spread" over Figure::range, without each
//                curve's first point; closed forms, for the curves that have them, "one-impact-1" ...,
//                "bounce-down-1" ...
//   phase        "impacts", "stuck", "windows" and the closed forms "one-impact", "bounce-1" ...
//                "bounce-4", "accumulation"
//   response     of the first, second ... force: "panel-1" (f0 / nu); "empty-1" and "locked-1" (frequency,
//                amplitude), the linear oscillators; "rising-1", "falling-1" what is periodic of the sweeps
//                and "rising-open-1", "falling-open-1" what is not; "stable-1", "unstable-1" the branches of
//                orbits that are struck; "plastic-1" the closed form, where e = 0 and zeta = 0. A block of no
//                rows is not there
//   largest_response  "prediction" (f0 / nu, amplitude) of the curve's decay, (M14.7), "beyond" its largest
//                force, "band" the outline of the ensemble's; "rising", "falling" the largest amplitude of
//                sweeps along the same forces
//   response_map "cell" (width, height); "one-symmetric", "one-asymmetric", "each-2", "each-3", "other",
//                "irregular", "idle" (frequency, f0 / nu), as far as they occur
//   design_charts  of the first, second ... restitution: "panel-1" (e); "curve-1-1", "curve-1-2" ... of the
//                mass ratios (amplitude, mean loss factor, least, greatest); "failure-1", "bounce-down-1",
//                the closed forms' amplitudes, where they are in the range; "reading", the report's example
//   damper_sets  of the first, second ... curve: "set-1" (amplitude, mean loss factor of the run's ensemble
//                divided by the mass of all dampers, least, greatest) in bins of a twelfth of a decade;
//                "sum-1" the same if its dampers add, of the run alone; "dampers-1" (clearance, mass)
//   components   of friction, weight and drag: "curve-1-1", "curve-1-2" ... of the runs that have it, and of
//                the one that has none of them (amplitude, A eta / nu of the run's ensemble, least, greatest)
//                in the same bins; "locking-1-1" ..., the closed form's amplitude, where it is in the range
//
// Throws InputError naming figure and file if a run lacks what is drawn: a column, a window of the
// history, enough half cycles, the amplitude Figure::down_to, a member; or if a drawn value is not finite.
Table figure_table(const Figure& figure, const FigureRuns& runs, const FigureResponses& responses = {},
                   const FigureSweeps& sweeps = {});

// The blocks of the tables, by kind: the parts of figure_table(), some of which pages use, too.

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
Table components_table(const Figure& figure, const FigureRuns& runs);

}  // namespace impact_damper
