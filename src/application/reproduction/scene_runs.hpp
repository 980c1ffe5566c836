// Runs of the project's scenes, FOLDER/SCENE.json each, and the other members of their ensembles beside them:
// functions that read them and check that they are what they should be.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "application/reproduction/catalogue.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Throws InputError, naming `file`, unless the run agrees with itself (consistency.hpp).
void require_consistent(const Run& run, const std::filesystem::path& file);
// The same for a response (response_file.hpp).
void require_consistent(const Response& response, const std::filesystem::path& file);

// Throws InputError, naming both files, unless the run is one of the scene in `scene_file`, number by number.
// Throws what reading `scene_file` throws.
void require_scene(const Run& run, const std::filesystem::path& file,
                   const std::filesystem::path& scene_file);

// Throws InputError, naming both files, unless both runs are of the same engine with the same options, except
// those that follow from the scene where they are not given: the time step and the latest time.
void require_same_engine(const Run& run, const std::filesystem::path& file, const Run& other,
                         const std::filesystem::path& other_file);

// An ensemble (analysis/ensemble.hpp) is kept as the run file of the scene itself, its first member, and a
// folder of run files beside it for the others, from 2 on: `run_file` FOLDER/SCENE.json has the members
// FOLDER/SCENE.members/02.json, 03.json ...
inline constexpr std::int64_t most_members = 100;
std::filesystem::path member_file(const std::filesystem::path& run_file, std::int64_t member);

// Returns what a member of an ensemble records: what its scene's run does, except the history and the energy
// balance, which nothing uses.
Record record_of_member(Record record);

// Reads the other members of the ensemble whose first is `first`, the run in `run_file`, with the threads of
// the options. Each must agree with itself, be of its own release and of the engine of `first` with its
// options. Throws IoError, naming the command that makes it, if a file is missing, and InputError.
std::vector<Run> read_members(const Run& first, const std::filesystem::path& run_file,
                              const EnsembleOptions& options = {});

// The folders of runs and of their scenes.
struct SceneRuns {
  std::filesystem::path runs, scenes;

  std::filesystem::path file_of(const std::string& scene) const { return runs / (scene + ".json"); }
  // Reads the run of that scene, which must be consistent and of the scene in the other folder. Throws
  // IoError, naming the command that makes it if it is missing, or InputError.
  Run read(const std::string& scene) const;
  // Reads a further run, which must be consistent, of its scene with its changes, and by its engine or else
  // that of the scene's run, which is then read as well. Throws the same.
  Run read(const CatalogueRun& wanted) const;
  // Reads a response, which must be consistent and what the catalogue asks for. Throws the same; no run is
  // read.
  Response read(const CatalogueResponse& wanted) const;
};

}  // namespace impact_damper
