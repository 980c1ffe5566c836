// What is read as a run is written as one that reads as the same, and what looks at runs stands it.
#include "fuzz.hpp"
#include "impact_damper/analysis/consistency.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/io/run_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace impact_damper;
  // With the digest that its content has: no input would come by it by chance.
  const auto parse = [](const std::string& text) {
    const std::size_t end = text.rfind(seal_begin);
    return parse_run("f", end == std::string::npos ? text : sealed(text.substr(0, end)));
  };
  const std::optional<Run> run = fuzz::read(parse, data, size);
  if (!run) return 0;
  const std::string text = run_text(*run);
  fuzz::require(run_text(parse_run("f", text)) == text);
  try {
    if (run->half_cycles) averaged_loss_factor(*run->half_cycles);
  } catch (const std::invalid_argument&) {  // an amplitude of zero
  }
  if (run->contacts) stuck_contacts(*run);
  inconsistencies_of(*run);
  return 0;
}
