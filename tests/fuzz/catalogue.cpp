// What is read as a catalogue holds together: every curve has its scene, every figure a name for its files.
#include "application/reproduction/catalogue.hpp"

#include "fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace impact_damper;
  const std::optional<Catalogue> catalogue =
      fuzz::read([&](const std::string& text) { return parse_catalogue("f", text); }, data, size);
  if (!catalogue) return 0;
  for (const Figure& figure : catalogue->figures) {
    fuzz::require(find_figure(*catalogue, figure.number) == &figure);
    fuzz::require(file_stem(figure).find_first_of("/ \n") == std::string::npos);
    for (const std::string& scene : scenes_of(figure)) fuzz::require(find_scene(*catalogue, scene));
  }
  return 0;
}
