// What is read as a manifest holds together: its stamps are stamps, and lead to their figures.
#include "application/reproduction/manifest.hpp"

#include <algorithm>

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace impact_damper;
  const std::optional<Manifest> manifest =
      fuzz::read([&](const std::string& text) { return parse_manifest("f", text); }, data, size);
  if (!manifest) return 0;
  for (const CitedFigure& figure : manifest->figures) {
    const std::optional<Stamp> stamp = parse_stamp(figure.stamp);
    fuzz::require(stamp && stamp->version == manifest->version);
    const auto found = find_stamped(*manifest, stamp->digits);
    fuzz::require(std::ranges::count(found, &figure, &Stamped::figure) > 0);
  }
  return 0;
}
