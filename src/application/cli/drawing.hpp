// Figures drawn by gnuplot, from tables in memory to SVG in memory, with the program's own copies of the
// scripts.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "application/report/drawings.hpp"
#include "arguments.hpp"
#include "progress.hpp"

namespace impact_damper::cli {

// For use before a long computation: throws IoError if there is no gnuplot in PATH, with advice on what to
// install, or what else to do.
void require_gnuplot(std::string_view otherwise = "");

// A folder in the system's folder for temporary files, with what figures/draw needs. It is removed with this
// object, and when the program is interrupted. There may be one at a time.
class DrawingBoard {
 public:
  DrawingBoard();
  ~DrawingBoard();
  DrawingBoard(const DrawingBoard&) = delete;
  DrawingBoard& operator=(const DrawingBoard&) = delete;

  // Returns the drawing as SVG. Throws IoError if there is no space for it, NumericalError if gnuplot fails.
  std::string draw(const Drawing& drawing);

 private:
  std::filesystem::path folder_;
};

// Returns the folder of --figures, for figures as SVG. Rejects one that does not exist.
std::optional<std::string> figures_folder(Arguments& arguments);

using Svgs = std::map<std::string, std::string>;  // by the names of drawings
Svgs drawn(const std::vector<Drawing>& drawings, ProgressOnStderr& progress);
void write_figures(const std::string& folder, const Svgs& svgs);

// For a signal handler that ends the process: ends the drawing under way and removes the board's folder.
void remove_drawing_board() noexcept;

}  // namespace impact_damper::cli
