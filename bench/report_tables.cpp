#include <algorithm>
#include <cmath>

#include "impact_damper/base/number_text.hpp"
#include "report.hpp"

namespace impact_damper::bench {
namespace {

// A line for the title of a figure: on what machine, and what a reference operation is there.
std::string parameters(const Findings& found) {
  return found.processor + "; a reference operation, one of a chain of sincos calls, is " +
         number_text(std::round(found.reference_operation.median * 1e10) / 10) + " ns";
}

std::string block_name(std::string name) {
  std::ranges::replace(name, ' ', '-');
  return name;
}

void add_row(std::string& text, std::initializer_list<double> numbers) {
  for (const double number : numbers) text += number_text(number) + " ";
  text.back() = '\n';
}

}  // namespace

std::string time_error_table(const Findings& found) {
  std::string text =
      "# Run time beside error, drawn by bench/time_error.gp.\n"
      "# error: largest difference of a half-cycle amplitude from the reference, by epsilon; S5: of the loss "
      "factor's curve from the ensemble's, relative, root mean square\n"
      "# time, lower, upper: median and quartiles of a run, in reference operations\n"
      "# setting: tolerance or time step; 0 where there is none\n"
      "# Parameters: " +
      parameters(found) + "\n";
  for (const Curve& curve : found.curves) {
    std::string rows;
    for (const Point& point : curve.points) {
      if (!point.error) continue;
      const Spread& time = point.timing.reference_operations;
      add_row(rows, {*point.error, time.median, time.lower, time.upper, point.setting});
    }
    if (rows.empty()) continue;
    text += "\n\n# " + block_name(curve.scene + "-" + curve.contender) +
            "\nerror time lower upper setting\n" + rows;
  }
  for (const Reference& reference : found.references) {
    if (!reference.loss_curve) continue;
    text += "\n\n# " + reference.scene +
            (reference.walls == Walls::compliant ? "-scatter" : "-scatter-rigid") + "\nlower median upper\n";
    add_row(text, {reference.loss_curve->lower, reference.loss_curve->scatter, reference.loss_curve->upper});
  }
  return text;
}

std::string sweep_table(const Findings& found) {
  std::string text =
      "# What an impact costs, drawn by bench/cost.gp.\n"
      "# cost, lower, upper: median and quartiles, in reference operations; residual: of the energy balance, "
      "relative, at "
      "least "
      "2^-53\n"
      "# Parameters: " +
      parameters(found) + "\n";
  for (const Sweep& sweep : found.sweeps) {
    text += "\n\n# " + sweep.engine + "-" + sweep.against + "\n# " + sweep.what +
            "\nat cost lower upper residual impacts\n";
    for (const SweepPoint& point : sweep.points) {
      const double n = double(point.impacts);
      const Spread& time = point.timing.reference_operations;
      add_row(text, {point.at, time.median / n, time.lower / n, time.upper / n,
                     std::max(point.residual, 0x1p-53), n});
    }
  }
  return text;
}

}  // namespace impact_damper::bench
