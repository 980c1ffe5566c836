// What is read as a measured record has finite samples in the order of time, and its reduction is rejected or
// finite.
#include <algorithm>
#include <cmath>

#include "application/measured/decay_fit.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace impact_damper;
  const auto is_finite = [](double each) { return std::isfinite(each); };
  const auto record =
      fuzz::read([](const std::string& text) { return parse_measured_record("f", text); }, data, size);
  if (!record) return 0;
  fuzz::require(record->time.size() >= least_samples && record->time.size() == record->value.size());
  fuzz::require(std::ranges::all_of(record->time, is_finite) &&
                std::ranges::all_of(record->value, is_finite));
  fuzz::require(std::ranges::adjacent_find(record->time, std::ranges::greater_equal()) == record->time.end());
  const auto reduction = fuzz::read([&](const std::string&) { return reduced("f", *record); }, data, size);
  if (!reduction) return 0;
  for (const auto* each : {&reduction->time, &reduction->amplitude, &reduction->error})
    fuzz::require(std::ranges::all_of(*each, is_finite));
  fuzz::require(is_finite(reduction->frequency) && reduction->frequency > 0 && is_finite(reduction->noise));
  for (const LossBin& bin : loss_bins(*reduction))
    fuzz::require(is_finite(bin.loss) && bin.loss > 0 && is_finite(bin.error) && bin.lower > 0);
  return 0;
}
