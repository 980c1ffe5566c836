// `figures`: lists the figures of the catalogue as an aligned table.
#include <algorithm>

#include "application/reproduction/catalogue.hpp"
#include "arguments.hpp"
#include "commands.hpp"
#include "impact_damper/io/file_output.hpp"
#include "project_files.hpp"
#include "text_table.hpp"

namespace impact_damper::cli {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text.empty() ? "-" : text;
}

int list_figures(const std::string& file) {
  std::vector<std::vector<std::string>> rows{{"figure", "table", "script", "scenes", "title"}};
  const Catalogue catalogue = read_catalogue(file);
  for (const Figure& figure : catalogue.figures) {
    const bool drawn_only = figure.table == TableKind::drawing;
    std::vector<std::string> scenes = scenes_of(figure);
    for (const std::string& name : figure.responses) {
      const std::string& scene = find_response(catalogue.responses, name)->scene;
      if (std::ranges::find(scenes, scene) == scenes.end()) scenes.push_back(scene);
    }
    rows.push_back({figure.number, drawn_only ? "-" : file_stem(figure) + ".dat", figure.script,
                    joined(scenes), figure.title});
  }
  write_standard_output(aligned(rows));
  return 0;
}

}  // namespace

Command figures_command() {
  Command command{.name = "figures",
                  .description = "List the figures: table, script, scenes and title of each."};
  command.options = {input_option("CATALOGUE", "", "default figures/catalogue.json")};
  command.footer =
      "Tables are made by impact-damper series, pictures by figures/draw; make figures does it all.\n\n"
      "Example:\n"
      "  impact-damper figures";
  command.act = [](Arguments& arguments) {
    const std::string file = arguments.file("CATALOGUE").value_or(project_file("figures/catalogue.json"));
    arguments.finish();
    return list_figures(file);
  };
  return command;
}

}  // namespace impact_damper::cli
