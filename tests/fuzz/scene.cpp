// What is read as a scene is written as one that reads as the same; what is not is rejected in words.
#include "fuzz.hpp"
#include "impact_damper/io/scene_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace impact_damper;
  const std::optional<Scene> scene =
      fuzz::read([&](const std::string& text) { return parse_scene("f", text); }, data, size);
  if (scene) fuzz::require(parse_scene("f", scene_text(*scene)) == *scene);
  return 0;
}
