// The subjects of the stress program, one file each.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"
#include "report.hpp"

namespace stress {

struct Options {
  bool brief = false;                 // the same with smaller counts
  std::optional<std::uint64_t> seed;  // this case only, told in full
  std::int64_t scenes = 0;            // how many random ones
  impact_damper::Threads threads;
  std::filesystem::path folder;        // for tables that are drawn
  std::filesystem::path scene_folder;  // the scenes of the figures
};

std::vector<Check> central_differences(const Options& options);
std::vector<Check> random_scenes_of_all_kinds(const Options& options);
std::vector<Check> aimed_scenes(const Options& options);
std::vector<Check> several_dampers(const Options& options);
std::vector<Check> sensitivity(const Options& options);

}  // namespace stress
