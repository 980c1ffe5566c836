// `scenes`: lists the scenes that can be run as an aligned table.
#include <algorithm>
#include <filesystem>

#include "arguments.hpp"
#include "commands.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "project_files.hpp"
#include "text_table.hpp"

namespace impact_damper::cli {
namespace {

namespace fs = std::filesystem;
using Row = std::vector<std::string>;

std::vector<fs::path> scene_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".json") files.push_back(entry->path());
  }
  if (error) throw IoError(folder.string() + ": cannot be read: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

int list_scenes(const fs::path& folder) {
  Row titles{"scene"};
  for (const SceneField& field : scene_fields) titles.emplace_back(field.name);
  titles.insert(titles.end(), {"until_time", "until_amplitude"});
  std::vector<Row> rows{titles};
  std::vector<std::string> problems;
  for (const fs::path& file : scene_files(folder)) {
    try {
      const Scene scene = read_scene(file);
      Row row{file.stem().string()};
      for (const SceneField& field : scene_fields)
        row.push_back(field.number.of_damper && !has_one_damper(scene) ? "-"
                                                                       : number_text(field.number.in(scene)));
      for (const auto& stop : {scene.until_time, scene.until_amplitude}) {
        row.push_back(stop ? number_text(*stop) : "-");
      }
      rows.push_back(row);
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  }
  if (!problems.empty()) throw InputError(problems);
  write_standard_output(aligned(rows));
  return 0;
}

}  // namespace

Command scenes_command() {
  Command command{.name = "scenes", .description = "List the scenes of a folder, each with its numbers."};
  command.options = {input_option("FOLDER", "", "folder of scene files (*.json); default data/scenes")};
  command.footer =
      "Columns are the keys of a dimensionless scene file; a scene in units is listed as what it makes\n"
      "(impact-damper run --help). With a list of dampers \"-\" stands for the numbers that each has.\n\n"
      "Examples:\n"
      "  impact-damper scenes\n"
      "  impact-damper scenes my/scenes";
  command.act = [](Arguments& arguments) {
    const std::string folder = arguments.file("FOLDER").value_or(project_file("data/scenes"));
    arguments.finish();
    return list_scenes(folder);
  };
  return command;
}

}  // namespace impact_damper::cli
