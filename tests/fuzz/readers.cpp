// What libFuzzer gives to each reader of files: `fuzz_readers --reader=NAME`, in the build of the preset
// count (run), whose objects have the fuzzer's coverage, too. What a reader makes of an input holds together.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "application/measured/decay_fit.hpp"
#include "application/reproduction/catalogue.hpp"
#include "application/reproduction/claims.hpp"
#include "application/reproduction/manifest.hpp"
#include "application/reproduction/measures.hpp"
#include "application/sweeps/plan.hpp"
#include "impact_damper/analysis/consistency.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"

using namespace impact_damper;

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

// What `parse(arguments...)` returns; absent if it rejects them, which it may with InputError only, in lines
// of their own that begin with the file's name.
template <typename Parse, typename... Arguments>
auto accepted(Parse parse, const Arguments&... arguments)
    -> std::optional<decltype(parse("f", arguments...))> {
  try {
    return parse("f", arguments...);
  } catch (const InputError& error) {
    require(!error.problems().empty() && error.problems().size() <= 60);
    for (const std::string& problem : error.problems())
      require(problem.starts_with("f: ") && problem.find_first_of("\n\r\x1b") == std::string::npos);
    return std::nullopt;
  }
}

bool is_finite(double value) { return std::isfinite(value); }

// A scene is written as one that reads as the same.
void read_scene_text(const std::string& text) {
  if (const auto scene = accepted(parse_scene, text)) require(parse_scene("f", scene_text(*scene)) == *scene);
}

// A run is written as one that reads as the same, and what looks at runs stands it.
void read_run_text(const std::string& text) {
  // With the digest that its content has: no input would come by it by chance.
  const std::size_t end = text.rfind(seal_begin);
  const auto run = accepted(parse_run, end == std::string::npos ? text : sealed(text.substr(0, end)));
  if (!run) return;
  const std::string written = run_text(*run);
  require(run_text(parse_run("f", written)) == written);
  try {
    if (run->half_cycles) averaged_loss_factor(*run->half_cycles);
  } catch (const std::invalid_argument&) {  // an amplitude of zero
  }
  if (run->contacts) stuck_contacts(*run);
  inconsistencies_of(*run);
}

// A plan is written as one that reads as the same, and has runs.
void read_plan_text(const std::string& text) {
  try {
    const auto plan = accepted(parse_plan, text);
    if (!plan) return;
    const std::string written = plan_text(*plan);
    require(plan_text(parse_plan("f", written)) == written);
    const std::int64_t runs = runs_of(*plan);
    require(runs >= 1 && runs <= most_runs);
    for (const std::int64_t i : {std::int64_t(0), runs / 2, runs - 1})
      require(run_of(*plan, i).values.size() == varied_names(*plan).size());
  } catch (const IoError&) {  // of a scene_file that is not there
  }
}

// Every curve of a catalogue has its scene, every figure a name for its files.
void read_catalogue_text(const std::string& text) {
  const auto catalogue = accepted(parse_catalogue, text);
  if (!catalogue) return;
  for (const Figure& figure : catalogue->figures) {
    require(find_figure(*catalogue, figure.number) == &figure);
    require(file_stem(figure).find_first_of("/ \n") == std::string::npos);
    for (const std::string& scene : scenes_of(figure)) require(find_scene(*catalogue, scene));
  }
}

// Claims can be judged, each by a measure that is known.
void read_claims_text(const std::string& text) {
  const auto file = accepted(parse_claims, text);
  if (!file) return;
  for (const Claim& claim : file->claims) {
    require(std::ranges::count(measures(), claim.measure.name, &Measure::name) == 1);
    const Verdict missed = claim.source == Source::ours ? Verdict::does_not_hold : Verdict::not_reproduced;
    require(judge(claim, std::numeric_limits<double>::quiet_NaN()) == missed);
    const std::optional<double>& least = claim.allowed.printed.least;
    if (least) require(judge(claim, *least) != missed);
  }
}

// The stamps of a manifest are stamps, and lead to their figures.
void read_manifest_text(const std::string& text) {
  const auto manifest = accepted(parse_manifest, text);
  if (!manifest) return;
  for (const CitedFigure& figure : manifest->figures) {
    const std::optional<Stamp> stamp = parse_stamp(figure.stamp);
    require(stamp && stamp->version == manifest->version);
    const auto found = find_stamped(*manifest, stamp->digits);
    require(std::ranges::count(found, &figure, &Stamped::figure) > 0);
  }
}

// A measured record has finite samples in the order of time, and its reduction is rejected or finite.
void read_record_text(const std::string& text) {
  const auto record = accepted(parse_measured_record, text);
  if (!record) return;
  require(record->time.size() >= least_samples && record->time.size() == record->value.size());
  require(std::ranges::all_of(record->time, is_finite) && std::ranges::all_of(record->value, is_finite));
  require(std::ranges::adjacent_find(record->time, std::ranges::greater_equal()) == record->time.end());
  const auto reduction = accepted(reduced, *record, ReductionOptions{});
  if (!reduction) return;
  for (const auto* each : {&reduction->time, &reduction->amplitude, &reduction->error})
    require(std::ranges::all_of(*each, is_finite));
  require(is_finite(reduction->frequency) && reduction->frequency > 0 && is_finite(reduction->noise));
  for (const LossBin& bin : loss_bins(*reduction))
    require(is_finite(bin.loss) && bin.loss > 0 && is_finite(bin.error) && bin.lower > 0);
}

// A number is finite, is what the C library makes of it, and is written so that it reads back as the same
// bits. A fuzzer's other inputs are bits of a number, which has to stand the same.
void read_number_text(const std::string& text) {
  const auto stands = [](double value) {
    const std::optional<double> again = parse_number(number_text(value));
    require(again && std::bit_cast<std::uint64_t>(*again) == std::bit_cast<std::uint64_t>(value));
  };
  if (const std::optional<double> value = parse_number(text)) {
    require(is_finite(*value) && std::strtod(text.c_str(), nullptr) == *value);
    stands(*value);
  }
  if (const std::optional<std::int64_t> value = parse_integer(text)) {
    std::string again;
    append_number(again, *value);
    require(parse_integer(again) == value);
  }
  if (double value = 0; text.size() == sizeof value) {
    std::memcpy(&value, text.data(), sizeof value);
    if (is_finite(value)) stands(value);
  }
}

const std::map<std::string_view, void (*)(const std::string&)> readers = {{"catalogue", read_catalogue_text},
                                                                          {"claims", read_claims_text},
                                                                          {"manifest", read_manifest_text},
                                                                          {"number", read_number_text},
                                                                          {"plan", read_plan_text},
                                                                          {"record", read_record_text},
                                                                          {"run", read_run_text},
                                                                          {"scene", read_scene_text}};
void (*reader)(const std::string&) = nullptr;

}  // namespace

// libFuzzer leaves options that begin with -- alone.
extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  constexpr std::string_view option = "--reader=";
  for (const std::string_view word : std::vector<std::string_view>(*arguments, *arguments + *count))
    if (word.starts_with(option)) reader = readers.at(word.substr(option.size()));
  require(reader);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  reader(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
