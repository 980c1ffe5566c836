// What is read as claims can be judged, each by a measure that is known.
#include "application/reproduction/claims.hpp"

#include <algorithm>
#include <limits>

#include "application/reproduction/measures.hpp"
#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace impact_damper;
  const auto file =
      fuzz::read([&](const std::string& text) { return parse_claims("f", text); }, data, size);
  if (!file) return 0;
  for (const Claim& claim : file->claims) {
    fuzz::require(std::ranges::count(measures(), claim.measure.name, &Measure::name) == 1);
    fuzz::require(judge(claim, std::numeric_limits<double>::quiet_NaN()) == Verdict::not_reproduced);
    const std::optional<double>& least = claim.allowed.printed.least;
    if (least) fuzz::require(judge(claim, *least) != Verdict::not_reproduced);
  }
  return 0;
}
