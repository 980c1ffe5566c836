#include "application/sweeps/map.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

MapAxis axis_of(const GridAxis& grid) {
  MapAxis axis;
  axis.spacing = grid.values.empty() ? grid.spacing : Spacing::linear;
  for (std::int64_t i = 0; i < grid.size(); ++i) axis.values.push_back(grid.value(i));
  std::ranges::sort(axis.values);
  axis.values.erase(std::unique(axis.values.begin(), axis.values.end()), axis.values.end());
  return axis;
}

// Returns the index of a value. The axis has it, as its table was written from the same plan.
std::size_t index_of(const MapAxis& axis, double value) {
  return std::size_t(std::ranges::lower_bound(axis.values, value) - axis.values.begin());
}

double statistic_of(const std::vector<double>& values, Statistic statistic, std::optional<Better> better) {
  switch (statistic) {
    case Statistic::median:
      return spread_of(values).median;
    case Statistic::worst: {
      const Spread spread = spread_of(values);
      return better == Better::least ? spread.high : spread.low;
    }
    case Statistic::mean: {
      double sum = 0;
      for (const double value : values) sum += value;
      return sum / double(values.size());
    }
  }
  return 0;
}

bool is_better(double a, double b, Better better) { return better == Better::least ? a < b : a > b; }

std::optional<BestPoint> best_of(const Map& map, Better better) {
  std::optional<BestPoint> best;
  const std::size_t nx = map.x.values.size(), ny = map.y.values.size();
  for (std::size_t iy = 0; iy < ny; ++iy)
    for (std::size_t ix = 0; ix < nx; ++ix) {
      const Cell& cell = map.at(ix, iy);
      if (cell.state != CellState::value || (best && !is_better(cell.value, best->value, better))) continue;
      best = BestPoint{};
      best->x = ix, best->y = iy, best->value = cell.value;
    }
  if (!best) return best;
  best->x_is_at_end = best->x == 0 || best->x + 1 == nx;
  best->y_is_at_end = best->y == 0 || best->y + 1 == ny;
  bool is_first = true;
  for (std::size_t iy = best->y - (best->y > 0); iy <= std::min(best->y + 1, ny - 1); ++iy)
    for (std::size_t ix = best->x - (best->x > 0); ix <= std::min(best->x + 1, nx - 1); ++ix) {
      if (ix == best->x && iy == best->y) continue;
      const Cell& cell = map.at(ix, iy);
      const bool has_value = cell.state == CellState::value;
      const bool is_worse = best->worst && (!has_value || is_better(*best->worst, cell.value, better));
      if (!is_first && !is_worse) continue;
      is_first = false;
      best->worst_x = ix;
      best->worst_y = iy;
      best->worst = has_value ? std::optional(cell.value) : std::nullopt;
    }
  return best;
}

// Returns the amplitude that a limit is compared with, in units of the clearance (M15.8).
double compared_amplitude(const KeptQuantity& quantity, const PlannedRun& run) {
  if (quantity.at && *quantity.quantity->at == Dimension::length)
    return *quantity.at / scale_of(Dimension::length, run.scales);
  return std::sqrt(run.scene.x0 * run.scene.x0 + run.scene.v0 * run.scene.v0);
}

// Largest restitution for which theory.hpp finds the amplitude at which bounce-down ends.
constexpr double highest_restitution = 0.95;

std::optional<double> limit_of(Limit limit, double restitution) {
  const bool exists = limit == Limit::impact_failure ? restitution < 1 : restitution <= highest_restitution;
  if (!exists) return std::nullopt;
  return limit == Limit::impact_failure ? fold_amplitude(restitution) : bounce_down_end(restitution);
}

}  // namespace

double MapAxis::place(double value) const {
  return spacing == Spacing::logarithmic ? logarithm(value) : value;
}
double MapAxis::value_at(double place) const {
  return spacing == Spacing::logarithmic ? exponential(place) : place;
}

std::vector<double> MapAxis::edges() const {
  if (values.size() < 2) throw InvalidArguments(std::vector<Problem>{{"values", "must be at least two"}});
  const std::size_t last = values.size() - 1;
  std::vector<double> edges;
  const auto halfway = [&](std::size_t i) { return (place(values[i]) + place(values[i + 1])) / 2; };
  edges.push_back(value_at(2 * place(values[0]) - halfway(0)));
  for (std::size_t i = 0; i < last; ++i) edges.push_back(value_at(halfway(i)));
  edges.push_back(value_at(2 * place(values[last]) - halfway(last - 1)));
  return edges;
}

MapMaker::MapMaker(const Plan& plan, const MapQuestion& question) : plan_(plan), question_(question) {
  map_.x = axis_of(plan.grid[question.x]);
  map_.y = axis_of(plan.grid[question.y]);
  map_.draws = plan.samples ? plan.samples->count : 1;
  draws_.resize(map_.x.values.size() * map_.y.values.size());
}

void MapMaker::add(std::span<const std::string> row) {
  const auto number = [&](std::size_t grid) { return parse_number(row[1 + grid]).value_or(0); };
  for (std::size_t n = 0; n < plan_.grid.size(); ++n)
    if (n != question_.x && n != question_.y && number(n) != question_.fixed[n]) return;
  Draws& draws = draws_[index_of(map_.y, number(question_.y)) * map_.x.values.size() +
                        index_of(map_.x, number(question_.x))];
  const std::optional<double> value = parse_number(row[1 + varied_names(plan_).size() + question_.z]);
  if (row[row.size() - 2] != "done")
    ++draws.failed;
  else if (!value)
    ++draws.empty;
  else
    draws.values.push_back(*value);
}

Map MapMaker::finish() const {
  Map map = map_;
  for (const Draws& draws : draws_) {
    Cell& cell = map.cells.emplace_back();
    cell.state = draws.failed                              ? CellState::failed
                 : draws.empty > 0 || draws.values.empty() ? CellState::empty
                                                           : CellState::value;
    if (cell.state == CellState::value)
      cell.value = statistic_of(draws.values, question_.statistic, question_.better);
  }
  if (question_.better) map.best = best_of(map, *question_.better);
  return map;
}

MapLine contour(const MapAxis& x, const MapAxis& y, const std::vector<std::optional<double>>& values,
                double level) {
  MapLine line;
  const std::size_t nx = x.values.size(), ny = y.values.size();
  struct Corner {
    double x, y, above;
  };
  const auto passes = [](const Corner& a, const Corner& b) { return (a.above >= 0) != (b.above >= 0); };
  const auto add = [&](const Corner& a, const Corner& b) {
    const double part = a.above / (a.above - b.above);
    line.x.push_back(x.value_at(a.x + (b.x - a.x) * part));
    line.y.push_back(y.value_at(a.y + (b.y - a.y) * part));
  };
  for (std::size_t iy = 0; iy + 1 < ny; ++iy)
    for (std::size_t ix = 0; ix + 1 < nx; ++ix) {
      std::vector<Corner> corners;  // around the square
      for (const auto& [dx, dy] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
        const std::size_t cx = ix + std::size_t(dx), cy = iy + std::size_t(dy);
        if (const auto& value = values[cy * nx + cx])
          corners.push_back({x.place(x.values[cx]), y.place(y.values[cy]), *value - level});
      }
      if (corners.size() < 4) continue;
      // The sides that the line crosses: none, two or four. Of four, each pair cuts off a corner whose sign
      // differs from that in the middle of the square.
      std::vector<std::size_t> sides;
      for (std::size_t i = 0; i < 4; ++i)
        if (passes(corners[i], corners[(i + 1) % 4])) sides.push_back(i);
      if (sides.size() == 4) {
        double middle = 0;
        for (const Corner& corner : corners) middle += corner.above;
        if ((middle >= 0) != (corners[0].above >= 0)) sides = {3, 0, 1, 2};
      }
      for (std::size_t i = 0; i < sides.size(); ++i) {
        if (i % 2 == 0 && !line.x.empty()) line.gaps.push_back(line.x.size());
        add(corners[sides[i]], corners[(sides[i] + 1) % 4]);
      }
    }
  return line;
}

std::vector<double> contour_levels(double least, double greatest) {
  constexpr double most_levels = 8;
  // The step is the smallest of 1, 2, 5, 10, ... times a power of ten that gives at most most_levels.
  const double wanted = (greatest - least) / most_levels;
  double step = 1;
  while (step > wanted) step /= 10;
  while (step * 10 <= wanted) step *= 10;
  for (const double factor : {1.0, 2.0, 5.0, 10.0})
    if (factor * step >= wanted) {
      step *= factor;
      break;
    }
  std::vector<double> levels;
  const double below = std::floor(least / step);
  for (int n = 1; (below + n) * step < greatest; ++n) levels.push_back((below + n) * step);
  return levels;
}

std::optional<LimitLine> limit_line(const Plan& plan, const MapQuestion& question, const Map& map,
                                    Limit limit) {
  const KeptQuantity& quantity = plan.quantities[question.z];
  if (quantity.quantity->experiment != Experiment::run) return std::nullopt;
  // A fine grid over the picture, on which the logarithm of amplitude / limit is smooth.
  constexpr std::size_t parts = 64;
  const auto divided = [](const MapAxis& axis) {
    MapAxis fine{.values = {}, .spacing = axis.spacing};
    const std::vector<double> edges = axis.edges();
    const double from = axis.place(edges.front()), to = axis.place(edges.back());
    for (std::size_t i = 0; i <= parts; ++i)
      fine.values.push_back(axis.value_at(from + (to - from) * double(i) / double(parts)));
    return fine;
  };
  const MapAxis x = divided(map.x), y = divided(map.y);
  std::map<double, std::optional<double>> limits;  // by restitution: finding one takes long
  std::vector<double> grid = question.fixed;
  std::vector<std::optional<double>> above;
  for (const double at_y : y.values)
    for (const double at_x : x.values) {
      grid[question.x] = at_x;
      grid[question.y] = at_y;
      const PlannedRun run = run_of(plan, grid);
      auto& value = above.emplace_back();
      if (!run.problems.empty()) continue;
      if (run.scene.force_amplitude != 0) return std::nullopt;
      const auto [known, is_new] = limits.try_emplace(run.scene.damper().restitution);
      if (is_new) known->second = limit_of(limit, run.scene.damper().restitution);
      const double amplitude = compared_amplitude(quantity, run);
      if (known->second && amplitude > 0) value = logarithm(amplitude / *known->second);
    }
  LimitLine found{contour(x, y, above, 0), {}};
  if (found.line.x.empty()) return std::nullopt;
  double rises_x = 0, rises_y = 0;  // from one end to the other, sums
  for (std::size_t i = 0; i <= parts; ++i) {
    const auto rise = [](const std::optional<double>& from, const std::optional<double>& to) {
      return from && to ? *to - *from : 0;
    };
    for (std::size_t j = 0; j < parts; ++j) {
      rises_x += rise(above[i * (parts + 1) + j], above[i * (parts + 1) + j + 1]);
      rises_y += rise(above[j * (parts + 1) + i], above[(j + 1) * (parts + 1) + i]);
    }
  }
  found.lower_side = absolute(rises_x) >= absolute(rises_y) ? (rises_x > 0 ? "left" : "right")
                                                            : (rises_y > 0 ? "below" : "above");
  return found;
}

}  // namespace impact_damper
