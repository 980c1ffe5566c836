// What is read as a run is written as one that reads as the same, and what looks at runs stands it.
#include "fuzz.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/analysis/regimes.hpp"
#include "impact_damper/files/run_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace impact_damper;
  const std::optional<Run> run =
      fuzz::read([&](const std::string& text) { return parse_run("f", text); }, data, size);
  if (!run) return 0;
  const std::string text = run_text(*run);
  fuzz::require(run_text(parse_run("f", text)) == text);
  try {
    if (run->half_cycles) averaged_loss_factor(*run->half_cycles);
  } catch (const std::invalid_argument&) {  // an amplitude of zero
  }
  if (run->contacts) stuck_contacts(*run);
  return 0;
}
