// Runs that stand for the project's scenes, FOLDER/SCENE.json each: read, and held against what they stand
// for.
#pragma once

#include <filesystem>
#include <string>

#include "impact_damper/run.hpp"

namespace impact_damper {

// Throws InputError, naming `file`, unless the run agrees with itself (consistency.hpp).
void require_consistent(const Run& run, const std::filesystem::path& file);

// Throws InputError, naming both files, unless the run is one of the scene in `scene_file`, number by number.
// Throws what reading that throws.
void require_scene(const Run& run, const std::filesystem::path& file,
                   const std::filesystem::path& scene_file);

// Throws InputError, naming both files, unless both runs are of the same engine with the same options, but
// for those that follow from the scene where they are not given: the time step and the latest time.
void require_same_engine(const Run& run, const std::filesystem::path& file, const Run& other,
                         const std::filesystem::path& other_file);

// Where runs and the scenes that they are of are kept.
struct SceneRuns {
  std::filesystem::path runs, scenes;

  std::filesystem::path file_of(const std::string& scene) const { return runs / (scene + ".json"); }
  // The run of that scene, consistent and of the scene in the other folder. Throws IoError or InputError.
  Run read(const std::string& scene) const;
};

}  // namespace impact_damper
