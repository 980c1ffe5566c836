// `scenes` and `figures`: list the scenes that can be run, and the figures of the catalogue, as aligned
// tables.
#include <algorithm>
#include <filesystem>

#include "application/reproduction/catalogue.hpp"
#include "commands.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper::cli {
namespace {

namespace fs = std::filesystem;

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

int list_scenes(Arguments& arguments) {
  const std::string folder = arguments.file("FOLDER").value_or(project_file("data/scenes"));
  arguments.finish();
  std::vector<std::pair<std::string, Scene>> scenes;
  std::vector<std::string> problems;
  for (const fs::path& file : scene_files(folder)) {
    try {
      scenes.emplace_back(file.stem().string(), read_scene(file));
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  }
  if (!problems.empty()) throw InputError(problems);

  Rows rows(1, {"scene"});
  for (const auto& each : scenes) rows.emplace_back(1, each.first);
  for (const SceneField& field : scene_fields) {
    const auto text_of = [&](const Scene& scene) {
      return field.number.of_damper && !has_one_damper(scene) ? "-" : number_text(field.number.in(scene));
    };
    const auto is_absent = [&](const auto& each) { return field.is_absent(field.number.in(each.second)); };
    if (!scenes.empty() && std::ranges::all_of(scenes, is_absent)) continue;
    rows[0].emplace_back(field.name);
    for (std::size_t i = 0; i < scenes.size(); ++i) rows[i + 1].push_back(text_of(scenes[i].second));
  }
  for (const auto& [name, stop] :
       {std::pair("until_time", &Scene::until_time), {"until_amplitude", &Scene::until_amplitude}}) {
    rows[0].emplace_back(name);
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      const std::optional<double>& its = scenes[i].second.*stop;
      rows[i + 1].push_back(its ? number_text(*its) : "-");
    }
  }
  write_standard_output(aligned(rows));
  return 0;
}

int list_figures(Arguments& arguments) {
  const std::string file = arguments.file("CATALOGUE").value_or(project_file("figures/catalogue.json"));
  arguments.finish();
  Rows rows{{"figure", "table", "script", "scenes", "title"}};
  const Catalogue catalogue = read_catalogue(file);
  for (const Figure& figure : catalogue.figures) {
    std::vector<std::string> scenes = scenes_of(figure);
    for (const std::string& name : figure.responses) {
      const std::string& scene = find_response(catalogue.responses, name)->scene;
      if (std::ranges::find(scenes, scene) == scenes.end()) scenes.push_back(scene);
    }
    rows.push_back({figure.number, figure.table == TableKind::drawing ? "-" : file_stem(figure) + ".dat",
                    figure.script, scenes.empty() ? "-" : joined(scenes, ","), figure.title});
  }
  write_standard_output(aligned(rows));
  return 0;
}

}  // namespace

Command scenes_command() {
  return {
      .name = "scenes",
      .description = "List the scenes of a folder, each with its numbers.",
      .options = {input_option("FOLDER", "", "folder of scene files (*.json); default data/scenes")},
      .footer =
          R"(Columns are the keys of a dimensionless scene file; a scene in units is listed as what it makes
(impact-damper run --help). With a list of dampers "-" stands for the numbers that each has.

Examples:
  impact-damper scenes
  impact-damper scenes my/scenes)",
      .act = list_scenes};
}

Command figures_command() {
  return {.name = "figures",
          .description = "List the figures: table, script, scenes and title of each.",
          .options = {input_option("CATALOGUE", "", "default figures/catalogue.json")},
          .footer =
              R"(Tables are made by impact-damper series, pictures by figures/draw; make figures does it all.

Example:
  impact-damper figures)",
          .act = list_figures};
}

}  // namespace impact_damper::cli
