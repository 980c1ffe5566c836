// `report`: writes a page about one scene of the user's own.
#include <filesystem>
#include <map>

#include "application/report/page.hpp"
#include "commands.hpp"
#include "drawing.hpp"
#include "embedded.hpp"
#include "impact_damper/io/file_output.hpp"
#include "output.hpp"
#include "progress.hpp"
#include "scene_arguments.hpp"

namespace impact_damper::cli {
namespace {

namespace fs = std::filesystem;

std::string page_of(const Findings& findings, const std::vector<Drawing>& drawings,
                    const std::map<std::string, std::string>& svgs) {
  std::map<std::string, std::string_view> parts;
  std::string_view frame;
  for (const EmbeddedFile& file : embedded_files()) {
    if (file.name == "own.html") frame = file.text;
    if (file.name == "page.css" || file.name == "figures.js") parts[std::string(file.name)] = file.text;
  }
  return page_html(findings, drawings, svgs, frame, parts);
}

int report(Arguments& arguments) {
  const SceneFile file = scene_of(arguments, Stops::needed);
  const Engine engine = engine_of(arguments);
  EnsembleOptions ensemble;
  ensemble.members = arguments.whole_number("--members", within(1, 100)).value_or(ensemble.members);
  ensemble.threads = threads_of(arguments);
  const auto output = arguments.file("--output"), figures = arguments.file("--figures");
  const std::string scene_name = arguments.text("--scene").value_or("");
  arguments.reject_overwriting("--output", output, {scene_name});
  reject_other_endings(arguments, "--output", output, {Format::html});
  if (figures && !fs::is_directory(*figures))
    arguments.reject("--figures", "must be an existing folder, got " + in_quotes(*figures));
  const bool without_figures = arguments.flag("--without-figures");
  if (without_figures && figures) arguments.reject("--figures", "must not be given with --without-figures");
  arguments.finish();
  prepare_output(output);
  if (!without_figures) require_gnuplot(", or give --without-figures");
  warn_of_cautions("impact-damper report", file.scene, file.scales);

  const Subject subject{scene_name.empty() ? "a scene" : fs::path(scene_name).stem().string(),
                        file.description, file.scene, file.scales, engine};
  ProgressOnStderr progress("report");
  const Findings findings = saying_options(
      [&] { return examine(subject, ensemble, [&](const std::string& doing) { progress(doing); }); },
      scene_name, file.scales);
  warn_of_early_end("impact-damper report", findings.run, file.scales);
  const std::vector<Drawing> drawings = drawings_of(findings);
  std::map<std::string, std::string> svgs;
  if (!without_figures) {
    DrawingBoard board;
    for (const Drawing& drawing : drawings) {
      progress("drawing figure " + drawing.name);
      svgs[drawing.name] = board.draw(drawing);
    }
  }
  const std::string page = page_of(findings, drawings, svgs);
  if (figures)
    for (const auto& [name, svg] : svgs) write_file(fs::path(*figures) / (name + ".svg"), svg);
  write_output(output, page);
  return 0;
}

}  // namespace

Command report_command() {
  Command command{
      .name = "report",
      .description =
          "Simulate a scene and write a page about it: decay, loss factor, regimes, energy, predictability."};
  command.options = scene_options();
  const Options engine = engine_options();
  command.options.insert(command.options.end(), engine.begin(), engine.end());
  const auto add = [&](const std::string& name, const std::string& type, const std::string& help) {
    command.options.push_back({name, type, help, "Output"});
  };
  add("--members", "N",
      "perturbed initial conditions that are simulated, the scene's own\namong them; 1 to 100, default 16");
  add("--figures", "FOLDER", "write each figure there as well, as SVG");
  command.options.push_back({.name = "--without-figures",
                             .help = "text and tables only, for where there is no gnuplot",
                             .group = "Output",
                             .takes = Option::Takes::nothing});
  add("-o,--output", "FILE", "write the page there instead of to stdout");
  command.options.push_back(threads_option());
  command.footer =
      "The page is one HTML file that needs no other and no network. The scene is that of impact-damper "
      "run;\n"
      "given in kilograms, newtons per metre and millimetres, the page speaks in both. Figures are "
      "drawn\n"
      "by gnuplot, which must be there if there are to be any.\n\n"
      "Examples:\n"
      "  impact-damper report --scene data/examples/mast.json -o mast.html\n"
      "  impact-damper report --mass-ratio 0.05 --x0 3 --until-amplitude 0.05 -o mine.html";
  command.act = report;
  return command;
}

}  // namespace impact_damper::cli
