#include "project_files.hpp"

#include <algorithm>
#include <array>
#include <system_error>

#include "application/reproduction/scene_runs.hpp"

namespace impact_damper::cli {

namespace fs = std::filesystem;

std::string project_file(const std::string& name) {
  std::error_code none;
  if (fs::exists(name, none)) return name;
  const fs::path program = fs::read_symlink("/proc/self/exe", none);
  if (none) return name;
  const fs::path folder = program.parent_path();
  for (const fs::path& place :
       std::array{folder.parent_path() / "share/impact-damper", folder.parent_path().parent_path()}) {
    if (fs::exists(place / name, none)) return (place / name).string();
  }
  return name;
}

std::optional<std::string> find_named_file(const std::string& name) {
  std::error_code none;
  const std::string found = project_file(name);
  const bool is_of_project = name.starts_with("data/") || name.starts_with("figures/");
  return is_of_project && fs::exists(found, none) ? std::optional(found) : std::nullopt;
}

void add_ensemble(std::vector<fs::path>& files, const fs::path& run) {
  files.push_back(run);
  for (std::int64_t member = 2; member <= most_members; ++member) files.push_back(member_file(run, member));
}

std::string_view embedded_text(std::string_view name) {
  return std::ranges::find(embedded_files(), name, &EmbeddedFile::name)->text;
}

}  // namespace impact_damper::cli
