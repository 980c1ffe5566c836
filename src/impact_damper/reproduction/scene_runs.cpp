#include "impact_damper/reproduction/scene_runs.hpp"

#include "impact_damper/analysis/consistency.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {
namespace {

std::string text_of(const std::optional<double>& number) { return number ? number_text(*number) : "none"; }

Engine without_defaults_by_scene(Engine engine) {
  for_each_option(engine, [](const OptionInfo& option, auto& value) {
    if constexpr (std::is_same_v<decltype(value), std::optional<double>&>)
      if (option.in_every_file) value.reset();
  });
  return engine;
}

}  // namespace

void require_consistent(const Run& run, const std::filesystem::path& file) {
  std::vector<Problem> problems = inconsistencies_of(run);
  for (Problem& problem : problems) problem.message.insert(0, "contradicts the rest of the run: ");
  if (!problems.empty()) throw InputError(file.string(), problems);
}

void require_scene(const Run& run, const std::filesystem::path& file,
                   const std::filesystem::path& scene_file) {
  const Scene scene = read_scene(scene_file);
  std::vector<Problem> problems;
  const auto compare = [&](std::string_view name, std::optional<double> wanted, std::optional<double> given) {
    if (wanted == given) return;
    problems.push_back({"/scene/" + std::string(name), "must be " + text_of(wanted) + " as in " +
                                                           scene_file.string() + ", got " + text_of(given) +
                                                           ": a run of another scene"});
  };
  for (const SceneField& field : scene_fields)
    compare(field.name, scene.*field.member, run.scene.*field.member);
  compare("until_time", scene.until_time, run.scene.until_time);
  compare("until_amplitude", scene.until_amplitude, run.scene.until_amplitude);
  if (!problems.empty()) throw InputError(file.string(), problems);
}

void require_same_engine(const Run& run, const std::filesystem::path& file, const Run& other,
                         const std::filesystem::path& other_file) {
  if (without_defaults_by_scene(run.engine) == without_defaults_by_scene(other.engine)) return;
  throw InputError(
      file.string(),
      {{"/engine", "must be that of " + other_file.string() + ", " + std::string(name_of(other.engine)) +
                       ", with its options, got " + std::string(name_of(run.engine)) +
                       ": runs of several engines are not put together"}});
}

Run SceneRuns::read(const std::string& scene) const {
  const std::filesystem::path file = file_of(scene);
  Run run = read_run(file);
  require_scene(run, file, scenes / (scene + ".json"));
  require_consistent(run, file);
  return run;
}

}  // namespace impact_damper
