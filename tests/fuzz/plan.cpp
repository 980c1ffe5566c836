// What is read as a plan is written as one that reads as the same, and has runs.
#include "application/sweeps/plan_file.hpp"
#include "fuzz.hpp"
#include "impact_damper/io/json_writer.hpp"

namespace {

std::string text_of(const impact_damper::Plan& plan) {
  impact_damper::JsonWriter out("plan");
  out.open_object(impact_damper::JsonWriter::Layout::one_line);
  write_plan_fields(out, plan);
  out.close();
  return out.finish();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace impact_damper;
  try {
    const std::optional<Plan> plan =
        fuzz::read([](const std::string& text) { return parse_plan("f", text); }, data, size);
    if (!plan) return 0;
    const std::string text = text_of(*plan);
    fuzz::require(text_of(parse_plan("f", text)) == text);
    const std::int64_t runs = runs_of(*plan);
    fuzz::require(runs >= 1 && runs <= most_runs);
    for (const std::int64_t i : {std::int64_t(0), runs / 2, runs - 1})
      fuzz::require(run_of(*plan, i).values.size() == varied_names(*plan).size());
  } catch (const IoError&) {  // of a scene_file that is not there
  }
  return 0;
}
