// A map: one quantity of a sweep over two numbers of its grid, the best point, how much worse its neighbours
// are, contours, and where impacts fail and bounce-down ends (docs/mathematics.md, chapter 15).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "application/sweeps/plan.hpp"
#include "impact_damper/base/enumeration.hpp"

namespace impact_damper {

// What is shown of the draws of one point of the grid.
enum class Statistic { median, mean, worst };

struct MapQuestion {
  std::size_t x = 0, y = 1;  // indices in Plan::grid, different
  std::size_t z = 0;         // index in Plan::quantities
  // For each other number of the grid the value at which the map is taken; as long as the grid.
  std::vector<double> fixed;
  Statistic statistic = Statistic::median;
  std::optional<Better> better;  // which values are better; needed for the worst draw and for the best point
};

// The values of a number of the grid, ascending, each once.
struct MapAxis {
  std::vector<double> values;
  Spacing spacing = Spacing::linear;  // logarithmic if the plan's axis is

  // Returns `value` itself, or its logarithm on a logarithmic axis.
  double place(double value) const;
  double value_at(double place) const;
  // Returns the limits of the cells, one more than there are values: halfway between two places, and as far
  // beyond the first and the last. Throws InvalidArguments with fewer than two values.
  std::vector<double> edges() const;
};

enum class CellState {
  value,
  empty,  // a draw has no such quantity
  failed  // a draw did not end as asked for: column "end"
};
struct Cell {
  CellState state = CellState::empty;
  double value = 0;
};

struct BestPoint {
  std::size_t x = 0, y = 0;  // indices in the axes
  double value = 0;
  // The worst of the up to eight points one step from it (M15.6). A point without a value is the worst:
  // `worst` is then absent.
  std::size_t worst_x = 0, worst_y = 0;
  std::optional<double> worst;
  bool x_is_at_end = false, y_is_at_end = false;  // of its axis: there may be better ones beyond
};

struct Map {
  MapAxis x, y;
  std::int64_t draws = 1;   // of each point
  std::vector<Cell> cells;  // x varies fastest
  std::optional<BestPoint> best;

  const Cell& at(std::size_t ix, std::size_t iy) const { return cells[iy * x.values.size() + ix]; }
};

// Collects the rows of a table. `plan` must outlive it.
class MapMaker {
 public:
  MapMaker(const Plan& plan, const MapQuestion& question);
  void add(std::span<const std::string> row);  // the cells of a row in the order of the plan's columns
  Map finish() const;

 private:
  struct Draws {
    std::vector<double> values;
    std::int64_t empty = 0, failed = 0;
  };
  const Plan& plan_;
  MapQuestion question_;
  Map map_;
  std::vector<Draws> draws_;
};

// A line through a picture: points, interrupted before those in `gaps`, ascending.
struct MapLine {
  std::vector<double> x, y;
  std::vector<std::size_t> gaps;
};
// Returns the line on which `values`, at the points of the axes with x fastest, pass `level`: by linear
// interpolation in the places of the axes (M15.7), within squares of four points that all have a value.
MapLine contour(const MapAxis& x, const MapAxis& y, const std::vector<std::optional<double>>& values,
                double level);
// Returns about eight levels at round steps between the least and the greatest value.
std::vector<double> contour_levels(double least, double greatest);

// Lines on which an amplitude is that of impact failure, or of the end of bounce-down (M15.8).
enum class Limit { impact_failure, bounce_down_end };
struct LimitLine {
  MapLine line;
  // "left", "right", "below" or "above": the side on which the amplitude is below the limit, towards which
  // amplitude / limit falls most on the average.
  std::string_view lower_side;
};
// Absent if the limit depends on neither of the two numbers, if it is nowhere in the picture, or if the
// motion is under a force.
std::optional<LimitLine> limit_line(const Plan& plan, const MapQuestion& question, const Map& map,
                                    Limit limit);

}  // namespace impact_damper
