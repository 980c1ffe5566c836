#include "impact_damper/files/scene_file.hpp"

#include "impact_damper/files/number_text.hpp"

namespace impact_damper {
namespace {

Scene read_whole(JsonDocument document) {
  ObjectReader object = document.root();
  std::string description;
  object.optional("description", description);
  const Scene scene = read_scene_fields(object);
  document.finish();
  return scene;
}

}  // namespace

Scene read_scene_fields(ObjectReader& object) {
  Scene scene;
  for (const SceneField& field : scene_fields) object.optional(field.name, scene.*field.member);
  const bool time_is_read = object.optional("until_time", scene.until_time);
  const bool amplitude_is_read = object.optional("until_amplitude", scene.until_amplitude);
  for (const Problem& problem : problems_of(scene)) {
    // A stop that was given but could not be read is not missing as well.
    const bool given = problem.field == "until_time" && !(time_is_read && amplitude_is_read);
    if (!given) object.refuse(problem.field, problem.message);
  }
  return scene;
}

Scene read_scene(const std::filesystem::path& file) {
  return read_whole(JsonDocument::read(file, scene_kind));
}

Scene parse_scene(const std::string& name, const std::string& text) {
  return read_whole(JsonDocument::parse(name, text));
}

std::string scene_text(const Scene& scene) {
  std::string text = "{";
  const auto field = [&](std::string_view name, const std::optional<double>& value) {
    if (text.size() > 1) text += ", ";
    text += '"' + std::string(name) + "\": " + (value ? number_text(*value) : "null");
  };
  for (const SceneField& each : scene_fields) field(each.name, scene.*each.member);
  field("until_time", scene.until_time);
  field("until_amplitude", scene.until_amplitude);
  return text + '}';
}

}  // namespace impact_damper
