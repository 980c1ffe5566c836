// S6: everything behind the paper's figures, in process and on one core: the eight scenes, and from their
// runs all tables that gnuplot draws, as text. Only files are not touched.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "timing.hpp"

namespace impact_damper::bench {

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

}  // namespace impact_damper::bench
