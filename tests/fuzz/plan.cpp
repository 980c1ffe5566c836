// What is read as a plan is written as one that reads as the same, and has runs.
#include "application/sweeps/plan.hpp"

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace impact_damper;
  try {
    const std::optional<Plan> plan =
        fuzz::read([](const std::string& text) { return parse_plan("f", text); }, data, size);
    if (!plan) return 0;
    const std::string text = plan_text(*plan);
    fuzz::require(plan_text(parse_plan("f", text)) == text);
    const std::int64_t runs = runs_of(*plan);
    fuzz::require(runs >= 1 && runs <= most_runs);
    for (const std::int64_t i : {std::int64_t(0), runs / 2, runs - 1})
      fuzz::require(run_of(*plan, i).values.size() == varied_names(*plan).size());
  } catch (const IoError&) {  // of a scene_file that is not there
  }
  return 0;
}
