// How often the intervals of fit_decay hold the truth: records by the plain integration, of masts whose
// restitution, damping and clearance are drawn at random, with noise, offset and drift, fitted from the one
// scene file.
//
//   coverage RECORDS SEED [LOW HIGH]
//
// Prints a row for each record and parameter, then the share for each parameter. Exit code 1 if the share of
// all intervals is not from LOW to HIGH.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "application/measured/decay_fit.hpp"
#include "impact_damper/analysis/parallel.hpp"
#include "made_records.hpp"

using namespace impact_damper;

int main(int count, char** words) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const int records = count > 1 ? std::atoi(words[1]) : 40;
  const unsigned seed = count > 2 ? unsigned(std::atoi(words[2])) : 1;
  const double low = count > 4 ? std::atof(words[3]) : 0, high = count > 4 ? std::atof(words[4]) : 1;
  const std::vector<FitParameter> parameters = FitOptions{}.parameters;
  struct Row {
    SceneInUnits truth;
    FitResult result;
  };
  std::vector<Row> rows(static_cast<std::size_t>(records));
  for_each_index(records, {}, [&](std::int64_t i) {
    std::mt19937 random(seed * 1000 + unsigned(i));
    const auto between = [&](double from, double to) {
      return std::uniform_real_distribution<double>(from, to)(random);
    };
    Row& row = rows[std::size_t(i)];
    row.truth = made::mast();
    row.truth.damper().restitution = between(0.4, 0.75);
    row.truth.damping_ratio = between(0.0005, 0.005);
    row.truth.damper().clearance = between(7, 14);
    row.truth.initial_displacement = between(40, 70);
    const Reduction reduction = reduced(
        "made", made::measured(row.truth, {.noise = 0.05, .offset = 1, .drift = 1, .seed = unsigned(i)}), 3);
    FitOptions options;
    options.threads = 1;
    row.result = fit_decay(made::mast(), Restitution{}, reduction, loss_bins(reduction), options,
                           [](const std::string&) {});
  });
  int held = 0, all = 0, unlike = 0;
  std::vector<int> held_by(parameters.size()), open(parameters.size());
  for (const Row& row : rows) {
    if (!row.result.fit) {
      std::printf("no fit: %s\n", row.result.problem.c_str());
      all += int(parameters.size());
      continue;
    }
    const DecayFit& fit = *row.result.fit;
    unlike += fit.normal_deviate > most_normal_deviate;
    for (std::size_t j = 0; j < fit.parameters.size(); ++j) {
      const FittedParameter& each = fit.parameters[j];
      const double truth = value_of(row.truth, each.parameter);
      const bool holds = each.low <= truth && truth <= each.high;
      ++all, held += holds, held_by[j] += holds, open[j] += each.open_below || each.open_above;
      std::printf("%-14s %8.4g in %8.4g to %8.4g best %8.4g %s%s  chi2 %.3g of %d\n",
                  std::string(name_of(each.parameter)).c_str(), truth, each.low, each.high, each.best,
                  holds ? "" : "MISSED", each.open_below || each.open_above ? " open" : "", fit.chi_square,
                  int(fit.degrees));
    }
  }
  for (std::size_t j = 0; j < parameters.size(); ++j)
    std::printf("%s: %d of %d hold the truth, %d of them open\n", std::string(name_of(parameters[j])).c_str(),
                held_by[j], records, open[j]);
  std::printf("all: %d of %d, %.1f %%; %d records unlike every decay\n", held, all, 100.0 * held / all,
              unlike);
  const double share = double(held) / all;
  return share >= low && share <= high ? 0 : 1;
}
