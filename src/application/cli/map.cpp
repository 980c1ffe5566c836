// `map`: draws one quantity of a sweep over two numbers of its grid.
#include "application/sweeps/map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <tuple>
#include <utility>

#include "application/sweeps/sweep_table.hpp"
#include "commands.hpp"
#include "drawing.hpp"

namespace impact_damper::cli {
namespace {

// "secondary_mass" -> "secondary mass": gnuplot reads an underscore as the begin of an index.
std::string in_words(std::string_view name) {
  std::string words(name);
  std::ranges::replace(words, '_', ' ');
  return words;
}
// Replaces names of units by symbols: "1/Omega_n" -> "1/Ω_{n}", as gnuplot reads an index.
std::string in_symbols(std::string text) {
  for (const auto& [name, symbol] : {std::pair("Omega_n", "Ω_{n}"), {"epsilon", "ε"}})
    for (std::size_t at; (at = text.find(name)) != std::string::npos;)
      text.replace(at, std::string_view(name).size(), symbol);
  return text;
}

struct Named {
  const Plan& plan;
  const MapQuestion& question;

  const Variable& x() const { return plan.grid[question.x].variable; }
  const Variable& y() const { return plan.grid[question.y].variable; }
  const KeptQuantity& z() const { return plan.quantities[question.z]; }
  std::string_view unit_z() const {
    return unit_of(z().quantity->dimension, plan.scene.in_units.has_value());
  }
  std::string title_z() const {
    std::string title = in_words(z().quantity->name);
    if (z().at)
      title +=
          " " + with_unit(number_text(*z().at), unit_of(*z().quantity->at, plan.scene.in_units.has_value()));
    return title;
  }
  static std::string labelled(const std::string& name, std::string_view unit) {
    return unit.empty() ? name : name + ", in " + std::string(unit);
  }
};

// What must be given, in the words of its problem.
constexpr std::array<std::pair<const char*, const char*>, 3> needed{
    {{"--x", "must be given: a number of the grid"},
     {"--y", "must be given: a number of the grid"},
     {"--z", "must be given: a quantity of the table"}}};

// Returns the index of the name that an option gives; absent, and noted, if it is none of them.
std::optional<std::size_t> index_of(Arguments& arguments, const std::string& option, const std::string& name,
                                    const std::vector<std::string_view>& names, const std::string& what) {
  const auto found = std::ranges::find(names, name);
  if (found != names.end()) return std::size_t(found - names.begin());
  arguments.reject(option, filled("must be {}: {}; got {}{}", what, listed(names, "or"), in_quotes(name),
                                  did_you_mean(name, names)));
  return std::nullopt;
}

std::vector<std::string_view> names_of(const std::vector<GridAxis>& grid) {
  return texts_of(grid, [](const GridAxis& axis) -> std::string_view { return axis.variable.name; });
}

std::optional<std::size_t> axis_of(Arguments& arguments, const std::string& option, const Plan& plan) {
  const std::string name = arguments.texts(option).back();
  const auto index = index_of(arguments, option, name, names_of(plan.grid), "a number of the table's grid");
  if (index && plan.grid[*index].size() < 2)
    arguments.reject(
        option, filled("must have at least two values, {} has one: {}", name, plan.grid[*index].value(0)));
  return index;
}

std::optional<std::size_t> quantity_of(Arguments& arguments, const Plan& plan) {
  std::string name = arguments.texts("--z").back();
  std::vector<std::string> columns;
  for (const KeptQuantity& each : plan.quantities) {
    columns.push_back(each.column());
    if (name == each.text()) name = each.column();
  }
  return index_of(arguments, "--z", name, {columns.begin(), columns.end()}, "a quantity of the table");
}

// Sets each number that is neither x nor y to the value that --where gives, or to its only one.
void fix_the_others(Arguments& arguments, const Plan& plan, MapQuestion& question) {
  std::vector<bool> is_given(plan.grid.size());
  for (const std::string& text : arguments.texts("--where")) {
    const std::size_t equals = std::min(text.find('='), text.size());
    const auto index = index_of(arguments, "--where", text.substr(0, equals), names_of(plan.grid),
                                "NAME=VALUE with a number of the grid");
    if (!index) continue;
    const GridAxis& axis = plan.grid[*index];
    const std::string name(axis.variable.name);
    if (is_given[*index]) arguments.reject("--where", "must give " + name + " once, got " + in_quotes(text));
    is_given[*index] = true;
    if (*index == question.x || *index == question.y) {
      arguments.reject("--where", "must not fix " + name + ", which is an axis of the map");
      continue;
    }
    std::vector<double> values;
    for (std::int64_t i = 0; i < axis.size(); ++i) values.push_back(axis.value(i));
    QuantityReader read{
        .dimension = axis.variable.dimension, .scales = plan.scene.scales, .may_be_bare = true};
    const double value =
        read(std::string_view(text).substr(std::min(equals + 1, text.size()))).value_or(std::nan(""));
    // Accepts the value as it was written: 0.1, where a step of the grid has come to 0.09999999999999999.
    const double rounding = 1e-12 * std::max(std::abs(values.front()), std::abs(values.back()));
    const auto meant =
        std::ranges::min_element(values, {}, [&](double known) { return std::abs(known - value); });
    if (!(std::abs(*meant - value) <= rounding)) {
      std::vector<std::string> known;
      known.reserve(values.size());
      for (const double each : values) known.push_back(number_text(each));
      constexpr std::size_t most = 12;
      if (known.size() > most) {
        known.erase(known.begin() + most, known.end() - 1);
        known[most - 1] = "...";
      }
      arguments.reject("--where", filled("must give {} one of its values: {}; got {}", name,
                                         joined(known, ", "), in_quotes(text)));
      continue;
    }
    question.fixed[*index] = *meant;
  }
  for (std::size_t n = 0; n < plan.grid.size(); ++n) {
    if (n == question.x || n == question.y || is_given[n]) continue;
    const GridAxis& axis = plan.grid[n];
    question.fixed[n] = axis.value(0);
    if (axis.size() > 1)
      arguments.reject("--where", filled("must be given for {}, which has {} values: --where {}={}",
                                         axis.variable.name, axis.size(), axis.variable.name, axis.value(0)));
  }
}

MapQuestion question_of(Arguments& arguments, const Plan& plan) {
  MapQuestion question;
  question.fixed.resize(plan.grid.size());
  const auto x = axis_of(arguments, "--x", plan), y = axis_of(arguments, "--y", plan);
  const auto z = quantity_of(arguments, plan);
  if (x && x == y)
    arguments.reject(
        "--y", "must be another number than --x, got both times " + in_quotes(plan.grid[*x].variable.name));
  question.statistic = arguments.choice("--statistic", all_of<Statistic>, Statistic::median);
  if (!x || !y || !z || x == y) return question;
  question.x = *x, question.y = *y, question.z = *z;
  question.better = plan.quantities[*z].quantity->better;
  if (arguments.given("--best")) question.better = arguments.choice("--best", all_of<Better>, Better::least);
  if (question.statistic == Statistic::worst && !question.better)
    arguments.reject("--best",
                     "must be given: which values of " + plan.quantities[*z].column() + " are the worst?");
  fix_the_others(arguments, plan, question);
  return question;
}

std::vector<std::optional<double>> values_of(const Map& map) {
  std::vector<std::optional<double>> values;
  for (const Cell& cell : map.cells)
    values.push_back(cell.state == CellState::value ? std::optional(cell.value) : std::nullopt);
  return values;
}

std::string point_text(const Named& named, const Map& map, std::size_t ix, std::size_t iy) {
  return filled("{} = {}, {} = {}", named.x().name, with_unit(number_text(map.x.values[ix]), named.x().unit),
                named.y().name, with_unit(number_text(map.y.values[iy]), named.y().unit));
}

// Returns " (+12 %)": the margin (M15.6).
std::string change_text(double from, double to) {
  if (from == 0) return "";
  const double percent = 100 * std::abs((to - from) / from);
  return std::string(to < from ? " (−" : " (+") +
         (percent < 99.5 ? rounded_text(percent, 2) : std::to_string(std::llround(percent))) + " %)";
}

std::string statistic_text(const MapQuestion& question, const Map& map) {
  return map.draws == 1 ? "" : filled("{} of {} draws", name_of(question.statistic), map.draws);
}

void add_block(Table& table, const std::string& name, std::vector<TableColumn> columns,
               std::vector<std::size_t> gaps = {}) {
  if (columns[0].values.empty()) return;
  table.blocks.push_back({.name = name, .notes = {}, .columns = std::move(columns), .gaps = std::move(gaps)});
}

// Adds the cells of one state: their limits, and their values if they have any.
void add_cells(Table& table, const std::string& name, const Map& map, CellState state) {
  std::vector<TableColumn> columns{{"x", "of the point", {}},
                                   {"y", "of the point", {}},
                                   {"from x", "end of its cell", {}},
                                   {"to x", "end of its cell", {}},
                                   {"from y", "end of its cell", {}},
                                   {"to y", "end of its cell", {}},
                                   {"value", "statistic of its draws", {}}};
  if (state != CellState::value) columns.pop_back();
  const std::vector<double> x = map.x.edges(), y = map.y.edges();
  for (std::size_t iy = 0; iy < map.y.values.size(); ++iy)
    for (std::size_t ix = 0; ix < map.x.values.size(); ++ix) {
      const Cell& cell = map.at(ix, iy);
      if (cell.state != state) continue;
      const std::array row{map.x.values[ix], map.y.values[iy], x[ix], x[ix + 1], y[iy],
                           y[iy + 1],        cell.value};
      for (std::size_t c = 0; c < columns.size(); ++c) columns[c].values.push_back(row[c]);
    }
  add_block(table, name, std::move(columns));
}

// Adds contours, with the number of the level on the piece of its contour nearest to the middle of the
// picture.
void add_contours(Table& table, const Map& map) {
  const auto values = values_of(map);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double least = infinity, greatest = -infinity;
  for (const auto& value : values)
    if (value) least = std::min(least, *value), greatest = std::max(greatest, *value);
  const auto from_middle = [](const MapAxis& axis, double value) {
    const double from = axis.place(axis.values.front()), to = axis.place(axis.values.back());
    return std::abs((axis.place(value) - from) / (to - from) - 0.5);
  };
  MapLine all;
  std::vector<TableColumn> labels{
      {"x", "of the label", {}}, {"y", "of the label", {}}, {"level", "of the contour", {}}};
  for (const double level : contour_levels(least, greatest)) {
    const MapLine line = contour(map.x, map.y, values, level);
    if (line.x.empty()) continue;
    std::size_t nearest = 0;
    double distance = INFINITY;
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      const double away = std::max(from_middle(map.x, line.x[i]), from_middle(map.y, line.y[i]));
      if (away < distance) distance = away, nearest = i;
    }
    labels[0].values.push_back(line.x[nearest]);
    labels[1].values.push_back(line.y[nearest]);
    labels[2].values.push_back(level);
    if (!all.x.empty()) all.gaps.push_back(all.x.size());
    for (const std::size_t gap : line.gaps) all.gaps.push_back(all.x.size() + gap);
    all.x.insert(all.x.end(), line.x.begin(), line.x.end());
    all.y.insert(all.y.end(), line.y.begin(), line.y.end());
  }
  add_block(table, "contours", {{"x", "along the contours", all.x}, {"y", "along the contours", all.y}},
            all.gaps);
  add_block(table, "levels", std::move(labels));
}

Drawing drawing_of(const Named& named, const Map& map) {
  const Plan& plan = named.plan;
  const MapQuestion& question = named.question;
  Drawing drawing{"map", "map.gp", named.title_z(), {}};
  Table& table = drawing.table;
  std::string parameters = statistic_text(question, map);
  for (std::size_t n = 0; n < plan.grid.size(); ++n)
    if (n != question.x && n != question.y)
      parameters += (parameters.empty() ? "" : "; ") + in_words(plan.grid[n].variable.name) + " = " +
                    with_unit(number_text(question.fixed[n]), plan.grid[n].variable.unit);
  if (map.best) {
    const auto rounded = [](double value) { return rounded_text(value, 3); };
    parameters += filled("{}best {}, its worst neighbour {}", parameters.empty() ? "" : "; ",
                         with_unit(rounded(map.best->value), named.unit_z()),
                         map.best->worst ? with_unit(rounded(*map.best->worst), named.unit_z()) +
                                               change_text(map.best->value, *map.best->worst)
                                         : "without a value");
  }
  table.header = {"Map: " + drawing.title, "Parameters: " + parameters,
                  "x: " + Named::labelled(in_words(named.x().name), named.x().unit),
                  "y: " + Named::labelled(in_words(named.y().name), named.y().unit),
                  "z: " + Named::labelled(named.title_z(), named.unit_z())};
  for (std::string& line : table.header) line = in_symbols(line);
  drawing.title = in_symbols(drawing.title);
  const auto is_logarithmic = [](const MapAxis& axis) {
    return axis.spacing == Spacing::logarithmic ? 1.0 : 0.0;
  };
  table.blocks.push_back({.name = "logarithmic",
                          .columns = {{"x", "1 if it is", {is_logarithmic(map.x)}},
                                      {"y", "1 if it is", {is_logarithmic(map.y)}}}});
  add_cells(table, "cells", map, CellState::value);
  add_cells(table, "empty", map, CellState::empty);
  add_cells(table, "failed", map, CellState::failed);
  add_contours(table, map);
  for (const auto& [limit, name, what] :
       {std::tuple(Limit::impact_failure, "failure", "impacts fail "),
        std::tuple(Limit::bounce_down_end, "bounce-down", "no bounce-down ")}) {
    const auto found = limit_line(plan, question, map, limit);
    if (!found) continue;
    const std::string side(found->lower_side);
    const std::string where = side == "left" || side == "right" ? "to the " + side + " of it" : side + " it";
    add_block(table, name,
              {{"x", "along the line", found->line.x}, {what + where, "along the line", found->line.y}},
              found->line.gaps);
  }
  if (map.best)
    add_block(table, "best",
              {{"x", "of the best point", {map.x.values[map.best->x]}},
               {"best", "of the best point", {map.y.values[map.best->y]}}});
  return drawing;
}

// Returns remarks on the best point, a line each.
std::string summary_of(const Named& named, const Map& map) {
  const auto z = [&](double value) { return with_unit(number_text(value), named.unit_z()); };
  const auto count = [&](CellState state) { return std::ranges::count(map.cells, state, &Cell::state); };
  std::string text;
  if (map.best) {
    const BestPoint& best = *map.best;
    const std::string statistic = statistic_text(named.question, map);
    text += filled("best: {} = {} at {}{}\n", named.z().column(), z(best.value),
                   point_text(named, map, best.x, best.y), statistic.empty() ? "" : ", " + statistic);
    text += filled("margin: {} at its worst neighbour, {}\n",
                   best.worst ? z(*best.worst) + change_text(best.value, *best.worst) : "no value",
                   point_text(named, map, best.worst_x, best.worst_y));
    if (best.x_is_at_end || best.y_is_at_end)
      text +=
          filled("the best point is at the end of the grid in {}{}{}: there may be better ones beyond\n",
                 best.x_is_at_end ? named.x().name : "", best.x_is_at_end && best.y_is_at_end ? " and " : "",
                 best.y_is_at_end ? named.y().name : "");
  }
  if (const std::string remark = remark_on_walls(named.plan);
      !remark.empty() && named.z().quantity->name == "largest_wall_force")
    text += remark + ".\n";
  return text + filled("points: {} with a value, {} empty, {} failed\n", count(CellState::value),
                       count(CellState::empty), count(CellState::failed));
}

int make_map(Arguments& arguments) {
  const auto file = arguments.required_file("TABLE", "a table that sweep or merge has written"),
             output = arguments.required_file("--output", "the picture is written there, as SVG");
  reject_other_endings(arguments, "--output", output, {Format::svg});
  if (file) arguments.reject_overwriting("--output", output, {*file, *file + ".json"});
  for (const auto& [option, what] : needed)
    if (!arguments.given(option)) arguments.reject(option, what);
  arguments.finish();  // before the table is read, which decides what else is valid
  const SweepDescription description = read_sweep_description(*file);
  const MapQuestion question = question_of(arguments, description.plan);
  arguments.finish();
  prepare_output(output);
  require_gnuplot();
  MapMaker maker(description.plan, question);
  read_sweep_rows(*file, description, [&](std::span<const std::string> row) { maker.add(row); });
  const Map map = maker.finish();
  const Named named{description.plan, question};
  std::vector<double> values;
  for (const Cell& cell : map.cells)
    if (cell.state == CellState::value) values.push_back(cell.value);
  const std::string column = named.z().column();
  if (values.empty())
    throw InputError(*file,
                     {{"", filled("has no point with a value of {}: there is nothing to draw", column)}});
  if (const auto [least, greatest] = std::ranges::minmax(values); least == greatest)
    throw InputError(*file,
                     {{"", filled("has only one value of {}, {}: there is nothing to draw", column, least)}});
  write_output(output, DrawingBoard().draw(drawing_of(named, map)));
  if (!is_standard_output(output)) write_standard_output(summary_of(named, map));
  return 0;
}

}  // namespace

Command map_command() {
  return {
      .name = "map",
      .description =
          "Draw a quantity of a sweep's table over two numbers of its grid, and tell the best point.",
      .options = {input_option(
                      "TABLE", "FILE",
                      "the table of a sweep, as CSV; FILE.json, which says what it holds, must be beside it"),
                  {"--x", "NAME", "the number of the grid along the horizontal axis"},
                  {"--y", "NAME", "the one along the vertical axis"},
                  {"--z", "NAME", "the quantity: its column, time_to_amplitude_6"},
                  repeated_option("--where", "NAME=VALUE",
                                  "of each other number of the grid, which of its values is drawn"),
                  {"--statistic", "median|mean|worst",
                   "what is drawn of several draws of one point; default median"},
                  {"--best", "least|greatest",
                   "which values are best; default by the quantity, none of some"},
                  {"-o,--output", "FILE", "the picture, FILE.svg"}},
      .footer =
          R"(A point of which a draw has no such quantity is marked as empty, one of which a draw did not end as
asked for as failed. The margin is the worst of the points one step of the grid away from the best.
Lines show where the amplitude is that of impact failure, or of the end of bounce-down. gnuplot must be
there.

Example:
  impact-damper map map.csv --x clearance --y secondary_mass --z time_to_amplitude_6 -o map.svg)",
      .act = make_map};
}

}  // namespace impact_damper::cli
