// What the bench measures beside the curves of time_error.hpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "timing.hpp"

namespace impact_damper::bench {

// How often a decay asks for memory. Linked into the bench program only: it replaces global operator new.
struct Allocations {
  std::string engine;
  std::int64_t impacts = 0;
  std::int64_t quiet = 0;     // calls of operator new in a whole decay, nothing kept: what is not for columns
  std::int64_t recorded = 0;  // the same with all half cycles recorded
};
// The decay from 6 to 0.03. Throws std::logic_error if an allocation of the recorder's is not counted: the
// replacement would not be in force.
std::vector<Allocations> count_allocations();

// How much longer a decay from 6 to 0.5 takes with so little of a component that it hardly changes what
// happens: for an event, which is the beginning or end of a contact, a stop or a release of the secondary
// mass, and for an impact. Friction adds events: the mass stops after each impact.
struct ComponentCost {
  std::string engine, component;
  double bound = 0;              // of the ratio for an event
  Spread per_event, per_impact;  // of repeats taken in turn
};
std::vector<ComponentCost> measure_components(int repeats);

// S6: everything behind the paper's figures, in process and on one core: the eight scenes, and from their
// runs all tables that gnuplot draws, as text. Only files are not touched.
struct FigureSet {
  Timing timing;
  struct Part {
    std::string name;
    double share = 0;  // of the time
  };
  std::vector<Part> parts;
  std::int64_t scenes = 0, tables = 0, bytes = 0;
};

// `source` is the project's folder: its catalogue of figures and its scenes are read beforehand.
FigureSet measure_figure_set(const std::filesystem::path& source, int repeats);

// The elementary functions beside the C library's: time and error.
struct FunctionCost {
  std::string name, arguments;
  // Seconds of a call in a chain in which each waits for the one before: with the product and the sum by
  // which it does.
  Spread own, library;
  Spread ratio;  // of repeats taken in turn
  // The largest of the chain's arguments, in units of the last place, by the C library's long double.
  double own_error = 0, library_error = 0;
};
std::vector<FunctionCost> measure_functions(int repeats);

// What a sweep (docs/sweeps.md) needs for a run, beside what the engine alone needs for it, on one thread and
// on two. Rows only, which are what takes time: a share's digests and the disk are not in it.
struct ManyRuns {
  std::string kept;       // "times and counts"
  double bound = 0;       // minutes that a million decays may take on two threads
  std::int64_t runs = 0;  // of a repeat
  int repeats = 0;
  // Seconds by the clock on the wall: the engine alone and the rows, on one thread; the rows on two.
  Spread engine, one, two;
  // Of repeats taken in turn, as parts of the engine's time: the analysis of the runs that the quantities ask
  // for, by itself; and what one thread's rows take beside engine and analysis.
  Spread analysis, overhead;
  Spread ratio;  // one thread's by two threads'

  double million_minutes() const { return two.median / double(runs) * 1e6 / 60; }
};
std::vector<ManyRuns> measure_many_runs(int repeats);

// What a second processor brings: an ensemble of decays on two threads against one, by the clock on the wall.
// How much it could bring differs from machine to machine and from minute to minute, where a processor is
// half a core or somebody else's, too: two ensembles side by side, each on a thread of its own, share nothing
// else. The repeats that count are those next to which these got 1.9 cores, if they are nine or more.
struct Speedup {
  std::int64_t members = 0;
  Spread one, two;      // seconds
  Spread ratio;         // of repeats taken in turn
  Spread side_by_side;  // twice the work in the time of two ensembles at once, by that of one
  int repeats = 0, on_two_cores = 0;
};
Speedup measure_speedup(int repeats);

// What an impact costs, everything included, against the number of impacts, the wall's stiffness and the
// restitution; the residual of the energy balance beside it.
struct SweepPoint {
  double at = 0;  // number of impacts asked for, k or e
  std::int64_t impacts = 0, half_cycles = 0;
  Timing timing;        // of the whole run, half cycles observed and not kept
  double residual = 0;  // of the energy balance of the same run once more, relative

  double cost() const { return timing.reference_operations.median / double(impacts); }
};

struct Sweep {
  std::string engine;
  std::string against;  // "impacts", "stiffness", "restitution"
  std::string what;     // in words
  std::vector<SweepPoint> points;
};

//   impacts      e = 1, released at x0 = 6, stopped after 1e2, 1e3, ... 1e7 impacts
//   stiffness    the decay from 6 to 0.5 with e = 0.6, k = 1e2, 1e3, ... 1e10 (exact only)
//   restitution  the same with e = 0, 0.1, ... 0.9, 0.99, 20000 impacts at most
// At 0.5 no e has its impact failure yet: half cycles without an impact cost time too.
// `told` hears what is measured next.
std::vector<Sweep> measure_sweeps(double most_impacts, const std::function<void(const std::string&)>& told);

}  // namespace impact_damper::bench
