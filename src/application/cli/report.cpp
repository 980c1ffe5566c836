// `report`: writes a page about one scene of the user's own.
#include <filesystem>

#include "application/report/page.hpp"
#include "commands.hpp"
#include "drawing.hpp"

namespace impact_damper::cli {
namespace {

int report(Arguments& arguments) {
  const SceneFile file = scene_of(arguments, Stops::needed);
  const Engine engine = engine_of(arguments);
  EnsembleOptions ensemble;
  arguments.read("--members", ensemble.members, within(1, 100));
  ensemble.threads = threads_of(arguments);
  const std::string scene_name = scene_name_of(arguments);
  const auto output = output_of(arguments, "--output", {Format::html}, {scene_name});
  const auto figures = figures_folder(arguments);
  const bool without_figures = arguments.flag("--without-figures");
  if (without_figures && figures) arguments.reject("--figures", "must not be given with --without-figures");
  arguments.finish();
  prepare_output(output);
  if (!without_figures) require_gnuplot(", or give --without-figures");
  warn_of_cautions("impact-damper report", file.scene, file.scales);

  Subject subject{scene_name.empty() ? "a scene" : std::filesystem::path(scene_name).stem().string(),
                  file.description, file.scene, file.scales, engine};
  if (file.in_units && file.in_units->gravity) subject.gravity = *file.in_units->gravity;
  ProgressOnStderr progress("report");
  const Findings findings =
      saying_options([&] { return examine(subject, ensemble, std::ref(progress)); }, scene_name, file.scales);
  warn_of_early_end("impact-damper report", findings.run, file.scales);
  const std::vector<Drawing> drawings = drawings_of(findings);
  const Svgs svgs = without_figures ? Svgs{} : drawn(drawings, progress);
  const std::string page =
      page_html(findings, drawings, svgs, embedded_text("own.html"),
                {{"page.css", embedded_text("page.css")}, {"figures.js", embedded_text("figures.js")}});
  if (figures) write_figures(*figures, svgs);
  write_output(output, page);
  return 0;
}

}  // namespace

Command report_command() {
  return {
      .name = "report",
      .description =
          "Simulate a scene and write a page about it: decay, loss factor, regimes, energy, predictability.",
      .options = together(
          {scene_options(),
           engine_options(),
           in_group("Output",
                    {{"--members", "N",
                      "perturbed initial conditions that are simulated, the scene's own\namong them; 1 to "
                      "100, default 16"},
                     {"--figures", "FOLDER", "write each figure there as well, as SVG"},
                     flag_option("--without-figures", "text and tables only, for where there is no gnuplot"),
                     {"-o,--output", "FILE", "write the page there instead of to stdout"}}),
           {threads_option()}}),
      .footer =
          R"(The page is one HTML file that needs no other and no network. The scene is that of impact-damper run;
given in kilograms, newtons per metre and millimetres, the page speaks in both. Figures are drawn
by gnuplot, which must be there if there are to be any.

Examples:
  impact-damper report --scene data/examples/mast.json -o mast.html
  impact-damper report --mass-ratio 0.05 --x0 3 --until-amplitude 0.05 -o mine.html)",
      .act = report};
}

}  // namespace impact_damper::cli
