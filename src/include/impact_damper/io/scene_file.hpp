// Scenes as JSON files: the names of scene_fields, until_time and until_amplitude as keys,
//
//   {"mass_ratio": 0.04, "until_amplitude": 0.01}
//
// or, in kilograms, newtons per metre and millimetres, those of unit_fields,
//
//   {"mass": 40, "stiffness": 1e6, "secondary_mass": 1.6, "clearance": 2, "initial_displacement": 12,
//    "until_millimetres": 0.02}
//
// never both in one file, except restitution and damping_ratio, which mean the same in both. A key that is
// left out has the default of Scene or SceneInUnits. One of the two stops must be given, and in units mass,
// stiffness or natural_frequency, secondary_mass and clearance. An optional "description" says in a sentence what the scene is. A
// file may have at most 1 MiB (scene_kind); a text given to parse_scene() may be longer.
//
// Several dampers are a list of objects, "dampers", whose keys are those of scene_damper_fields or of the
// unit_fields of a damper, in place of the keys of one damper beside the scene's own:
//
//   {"dampers": [{"mass_ratio": 0.02}, {"mass_ratio": 0.01, "clearance": 0.3}], "until_time": 100}
//
// A wall and the primary spring may have laws of their own (WallLaw, SpringLaw), with lengths in mm, speeds
// in mm/s, forces in N and `cubic` in N/mm^3 where the scene is in units; a restitution may be an array of
// pairs of speed and e:
//
//   {"wall": {"law": "power", "exponent": 1.5, "speed": 1}, "spring": {"cubic": 0.1}, "until_time": 100}
//   {"wall": {"law": "table", "pairs": [[0, 0], [0.01, 50], [0.02, 300]]},
//    "spring": {"law": "table", "file": "spring.csv"}, "until_time": 100}
//
// A table's file is a CSV file of two columns beside that of the scene; a run has its numbers.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// Enough for most_dampers, each number with all its digits.
inline constexpr FileKind scene_kind{"scene", 1 << 20};
inline constexpr FileKind table_kind{"table of pairs", 1 << 16};

struct SceneFile {
  Scene scene;                   // dimensionless, also of a scene in units
  std::optional<Scales> scales;  // of a scene in units
  std::string description;
  std::optional<SceneInUnits> in_units;  // the given values, if they were in units
};

// Reads a scene. Throws IoError if `file` cannot be read, InputError, with a line for each of the first 50
// problems in it. These lines begin with the name of the file, or with `name`.
SceneFile read_scene_file(const std::filesystem::path& file);
SceneFile parse_scene_file(const std::string& name, const std::string& text);
// Return its scene alone.
Scene read_scene(const std::filesystem::path& file);
Scene parse_scene(const std::string& name, const std::string& text);

// Returns the scene as JSON on one line, every field in the order of Scene, absent stops as null, a
// list of dampers in place of the numbers of one. It reads back as an equal scene. Throws NumericalError if a
// number is not finite.
std::string scene_text(const Scene& scene);

}  // namespace impact_damper
