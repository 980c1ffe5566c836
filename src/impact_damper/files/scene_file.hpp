// Scenes as JSON files: the names of scene_fields, until_time and until_amplitude as keys.
//
//   {"mass_ratio": 0.04, "until_amplitude": 0.01}
//
// Every key may be left out and then has the default of Scene, but one of the two stops must be given.
// An optional "description" says in a sentence what the scene is.
#pragma once

#include <filesystem>
#include <string>

#include "impact_damper/files/json_reader.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper {

inline constexpr FileKind scene_kind{"scene", 1 << 16};

// Throws IoError if `file` cannot be read, InputError naming everything in it that is not admitted.
Scene read_scene(const std::filesystem::path& file);
Scene parse_scene(const std::string& name, const std::string& text);

// The fields of a scene out of an object that may hold others beside them; problems are reported there.
Scene read_scene_fields(ObjectReader& object);

// The scene on one line with every field in the order of Scene, absent stops as null: reads back as equal.
std::string scene_text(const Scene& scene);

}  // namespace impact_damper
