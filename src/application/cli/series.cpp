// `series`: makes the tables that the figures draw from the run files of a folder.
#include "application/reproduction/series.hpp"

#include <filesystem>

#include "application/reproduction/catalogue.hpp"
#include "application/reproduction/scene_runs.hpp"
#include "application/sweeps/plan.hpp"
#include "commands.hpp"

namespace impact_damper::cli {
namespace {

namespace fs = std::filesystem;

// Returns the figures named, or all that have a table, in the order of the catalogue.
std::vector<const Figure*> chosen(const Catalogue& catalogue, Arguments& arguments) {
  std::vector<const Figure*> figures;
  std::vector<std::string_view> numbers;
  for (const Figure& figure : catalogue.figures) {
    if (figure.table == TableKind::drawing) continue;
    figures.push_back(&figure);
    numbers.push_back(figure.number);
  }
  const std::vector<std::string> names = arguments.texts("--figure");
  if (names.empty()) return figures;
  figures.clear();
  for (const std::string& name : names) {
    const Figure* figure = find_figure(catalogue, name);
    if (figure && figure->table != TableKind::drawing) {
      figures.push_back(figure);
    } else {
      arguments.reject("--figure", filled("must be a figure with a table ({}), got {}", joined(numbers, ", "),
                                          in_quotes(name)));
    }
  }
  return figures;
}

// What figures draw, as far as it was read.
struct Inputs {
  const SceneRuns& folders;
  const fs::path catalogue_file;
  const Catalogue& catalogue;
  const Threads threads;
  FigureRuns runs{}, further{};
  FigureResponses responses{};
  FigureSweeps sweeps{};

  // Reads what the figure draws: runs with the members of the ensembles that it shows, responses, and the
  // sweep of the plan beside the catalogue. The runs of scenes must be of one engine, whatever figure they
  // were read for. Reports problems of a file under the figure's name.
  void read_for(const Figure& figure) {
    try {
      read(figure);
    } catch (const InputError& error) {
      std::vector<std::string> problems = error.problems();
      for (std::string& problem : problems) problem = filled("figure {}: {}", figure.number, problem);
      throw InputError(problems);
    } catch (const IoError& error) {
      throw IoError(filled("figure {}: {}", figure.number, error.what()));
    }
  }

 private:
  void read(const Figure& figure) {
    for (const std::string& scene : scenes_of(figure)) {
      if (!runs.contains(scene)) {
        const FigureRun source{folders.file_of(scene), folders.read(scene)};
        if (!runs.empty()) {
          const FigureRun& first = runs.begin()->second;
          require_same_engine(source.run, source.file, first.run, first.file);
        }
        runs[scene] = source;
      }
      read_others(runs[scene], members_shown(figure, scene));
    }
    for (const std::string& name : runs_of(figure)) {
      if (!further.contains(name))
        further[name] = {folders.file_of(name), folders.read(*find_run(catalogue.runs, name))};
      read_others(further[name], catalogue.members);
    }
    for (const std::string& name : figure.responses)
      if (!responses.contains(name))
        responses[name] = {folders.file_of(name), folders.read(*find_response(catalogue.responses, name))};
    if (!figure.plan.empty())
      sweeps[figure.plan] =
          read_sweep_table(folders.runs / (sweep_stem(figure) + ".csv"),
                           read_plan(catalogue_file.parent_path() / figure.plan, find_named_file));
  }

  void read_others(FigureRun& source, std::int64_t members) const {
    if (members > std::int64_t(source.others.size()) + 1)
      source.others = read_members(source.run, source.file, {.members = members, .threads = threads});
  }
};

int make_tables(Arguments& arguments) {
  const fs::path runs_folder = arguments.file("--runs").value_or("");
  if (!arguments.given("--runs")) arguments.reject("--runs", "must be given: the folder of run files");
  const SceneRuns folders{runs_folder, scenes_folder(arguments)};
  const auto output = arguments.file("--output");
  const Format format = format_of(arguments, output, {Format::gnuplot, Format::csv});
  const Threads threads = threads_of(arguments);
  const std::string catalogue_file =
      arguments.file("--catalogue").value_or(project_file("figures/catalogue.json"));
  const Catalogue catalogue = read_catalogue(catalogue_file);
  const std::vector<const Figure*> figures = chosen(catalogue, arguments);
  const bool on_standard_output = !output || is_standard_output(output);
  const bool into_folder = !on_standard_output && fs::is_directory(*output);
  if (!into_folder && figures.size() != 1) {
    arguments.reject("--output", filled("must be an existing folder if more than one table is made, got {}",
                                        output ? in_quotes(*output) : "none"));
  }
  std::vector<fs::path> inputs{catalogue_file};
  for (const CatalogueScene& scene : catalogue.scenes) add_ensemble(inputs, folders.file_of(scene.name));
  for (const CatalogueRun& run : catalogue.runs) add_ensemble(inputs, folders.file_of(run.name));
  for (const CatalogueResponse& response : catalogue.responses)
    inputs.push_back(folders.file_of(response.name));
  for (const Figure* figure : figures) {
    if (figure->plan.empty()) continue;
    inputs.push_back(fs::path(catalogue_file).parent_path() / figure->plan);
    inputs.push_back(runs_folder / (sweep_stem(*figure) + ".csv"));
  }
  arguments.reject_overwriting("--output", output, inputs);
  arguments.finish();

  const auto place_of = [&](const Figure& figure) {
    return into_folder ? fs::path(*output) / (file_stem(figure) + (format == Format::csv ? ".csv" : ".dat"))
                       : fs::path(*output);
  };
  if (!on_standard_output) {
    for (const Figure* figure : figures) require_writable(place_of(*figure));
  }

  Inputs read{folders, catalogue_file, catalogue, threads};
  std::size_t made = 0;
  for (const Figure* figure : figures) {
    if (!on_standard_output) {
      if_interrupted_say(filled("{} of {} tables are left; {}", figures.size() - made++, figures.size(),
                                left_as_it_was(place_of(*figure))));
    }
    read.read_for(*figure);
    const bool draws_further = !runs_of(*figure).empty();
    const Table table =
        figure_table(*figure, draws_further ? read.further : read.runs, read.responses, read.sweeps);
    const std::string text = format == Format::csv ? to_csv(table) : to_text(table);
    write_output(on_standard_output ? output : place_of(*figure).string(), text);
  }
  return 0;
}

}  // namespace

Command series_command() {
  return {
      .name = "series",
      .description = "Make from run files the tables that figures draw.",
      .options =
          {input_option("--catalogue", "FILE", "which figure draws what; default figures/catalogue.json"),
           input_option("--runs", "FOLDER",
                        "folder of the runs, must be given: SCENE.json of each scene, with\nthe members of "
                        "the ensembles that figures show (run --members),\nNAME.json of each further run and "
                        "response and NAME.csv of each\nsweep that they draw"),
           scenes_option(),
           repeated_option("--figure", "NUMBER",
                           "only the table of the catalogue's figure NUMBER; may be repeated;\ndefault all"),
           {"-o,--output", "PLACE", "file, or folder for figNN.dat or figNN.csv; default standard output"},
           {"--format", "NAME", "gnuplot (default), what the figures are drawn from, or csv"},
           {"--threads", "N",
            "how many read at once; default one for each processor, same tables\nwith any"}},
      .footer =
          R"(Tables are text: a commented header with columns, scaling, scenes and script, then blocks of numbers.
With --format csv the same numbers are tidy CSV (RFC 4180, lines end with LF) under
block,curve,x,y,low,high: a row for each x of each curve; low and high are the ends of an interval, an
empty cell is no number, a row without numbers interrupts the line.
A run that is missing, too short, altered, of another scene or of another engine than the others is
rejected with the figure's and the file's name.

Examples:
  impact-damper series --runs build/runs/exact --figure 8
  impact-damper series --runs build/runs/exact -o build/series/exact
  impact-damper series --runs build/runs/exact --figure 8 --format csv -o fig08.csv)",
      .act = make_tables};
}

}  // namespace impact_damper::cli
