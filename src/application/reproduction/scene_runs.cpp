#include "application/reproduction/scene_runs.hpp"

#include <algorithm>
#include <system_error>

#include "impact_damper/analysis/consistency.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/engine_options.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {
namespace {

namespace fs = std::filesystem;

std::string text_of(const std::optional<double>& number) { return number ? number_text(*number) : "none"; }

Engine without_defaults_by_scene(Engine engine) {
  for_each_option(engine, [](const OptionInfo& option, auto& value) {
    if constexpr (std::is_same_v<decltype(value), std::optional<double>&>)
      if (option.in_every_file) value.reset();
  });
  return engine;
}

// `source` names the origin of the scene that is needed.
void require_scene(const Run& run, const fs::path& file, const Scene& scene, const std::string& source) {
  std::vector<Problem> problems;
  const auto compare = [&](std::string_view name, std::optional<double> wanted, std::optional<double> given) {
    if (wanted == given) return;
    problems.push_back({"/scene/" + std::string(name), "must be " + text_of(wanted) + " as in " + source +
                                                           ", got " + text_of(given) +
                                                           ": a run of another scene"});
  };
  const bool one = has_one_damper(scene) && has_one_damper(run.scene);
  for (const SceneField& field : scene_fields)
    if (one || field.number.own) compare(field.name, field.number.in(scene), field.number.in(run.scene));
  if (!one && scene.dampers != run.scene.dampers)
    problems.push_back({"/scene/dampers", "must be as in " + source + ": a run of another scene"});
  compare("until_time", scene.until_time, run.scene.until_time);
  compare("until_amplitude", scene.until_amplitude, run.scene.until_amplitude);
  if (!problems.empty()) throw InputError(file.string(), problems);
}

// `source` names the origin of the engine that is needed.
void require_engine(const Run& run, const fs::path& file, const Engine& engine, const std::string& source) {
  if (without_defaults_by_scene(run.engine) == without_defaults_by_scene(engine)) return;
  throw InputError(file.string(),
                   {{"/engine", "must be that of " + source + ", " + std::string(name_of(engine)) +
                                    ", with its options, got " + std::string(name_of(run.engine)) +
                                    ": runs of several engines are not put together"}});
}

Run read_run_of_one_damper(const fs::path& file) {
  Run run = read_run(file);
  if (!has_one_damper(run.scene))
    throw InputError(file.string(), {{"/scene/dampers", problem_of_several().message}});
  return run;
}

// Reads a file. If it is missing, the error names the command that makes it.
template <class Content>
Content read_or_name_command(Content (*read)(const fs::path&), const fs::path& file,
                             const std::string& command) {
  try {
    return read(file);
  } catch (const IoError& error) {
    std::error_code ignored;
    if (fs::exists(file, ignored)) throw;
    throw IoError(std::string(error.what()) + "; made by: " + command);
  }
}

void reject(std::vector<Problem> problems, const char* head, const fs::path& file) {
  for (Problem& problem : problems) problem.message.insert(0, head);
  if (!problems.empty()) throw InputError(file.string(), problems);
}

}  // namespace

void require_consistent(const Run& run, const fs::path& file) {
  reject(inconsistencies_of(run), "contradicts the rest of the run: ", file);
}

void require_consistent(const Response& response, const fs::path& file) {
  reject(inconsistencies_of(response), "contradicts the rest of the response: ", file);
}

void require_scene(const Run& run, const std::filesystem::path& file,
                   const std::filesystem::path& scene_file) {
  require_scene(run, file, read_scene(scene_file), scene_file.string());
}

void require_same_engine(const Run& run, const std::filesystem::path& file, const Run& other,
                         const std::filesystem::path& other_file) {
  require_engine(run, file, other.engine, other_file.string());
}

fs::path member_file(const fs::path& run_file, std::int64_t member) {
  fs::path folder = run_file;
  if (folder.extension() == ".json") folder.replace_extension();
  folder += ".members";
  std::string name(member < 10 ? "0" : "");
  name += std::to_string(member);
  name += ".json";
  return folder / name;
}

Record record_of_member(Record record) {
  record.energy = false;
  record.history.clear();
  record.history_below.clear();
  return record;
}

std::vector<Run> read_members(const Run& first, const fs::path& run_file, const EnsembleOptions& options) {
  const std::vector<Scene> scenes = ensemble_of(first.scene, options);
  std::vector<Run> others(scenes.size() - 1);
  for_each_index(static_cast<std::int64_t>(others.size()), options.threads, [&](std::int64_t i) {
    const std::int64_t member = i + 2;
    const std::string number = std::to_string(member);
    const fs::path file = member_file(run_file, member);
    Run& run = others[static_cast<std::size_t>(i)];
    run = read_or_name_command(read_run, file,
                               "impact-damper run --members " + std::to_string(options.members) + " -o " +
                                   run_file.string() + ", with the other options that made that run");
    require_scene(run, file, scenes[static_cast<std::size_t>(member - 1)],
                  "member " + number + " of the ensemble of " + run_file.string());
    if (run.engine != first.engine)
      throw InputError(
          file.string(),
          {{"/engine", "must be that of " + run_file.string() +
                           ", with its options: the members of an ensemble are runs of one engine"}});
    require_consistent(run, file);
  });
  return others;
}

Run SceneRuns::read(const std::string& scene) const {
  const fs::path file = file_of(scene), scene_file = scenes / (scene + ".json");
  Run run = read_or_name_command(read_run_of_one_damper, file,
                                 "impact-damper run --scene " + scene_file.string() + " -o " + file.string() +
                                     ", with --record, --engine and --members as needed");
  require_scene(run, file, scene_file);
  require_consistent(run, file);
  return run;
}

Run SceneRuns::read(const CatalogueRun& wanted) const {
  const fs::path file = file_of(wanted.name), scene_file = scenes / (wanted.scene + ".json");
  Run run =
      read_or_name_command(read_run, file,
                           "impact-damper run --scene " + scene_file.string() + " -o " + file.string() +
                               ", with what run " + wanted.name + " of the catalogue sets, and --members");
  const std::string source = "run " + wanted.name + " of the catalogue";
  require_scene(run, file, changed_scene(wanted, read_scene(scene_file)), source);
  if (wanted.engine)
    require_engine(run, file, *wanted.engine, source);
  else
    require_same_engine(run, file, read(wanted.scene), file_of(wanted.scene));
  require_consistent(run, file);
  return run;
}

Response SceneRuns::read(const CatalogueResponse& wanted) const {
  const fs::path file = file_of(wanted.name), scene_file = scenes / (wanted.scene + ".json");
  const Response asked = asked_for(wanted, read_scene(scene_file));
  Response response = read_or_name_command(
      read_response, file,
      "impact-damper response " + std::string(kind_of(asked)) + " --scene " + scene_file.string() + " -o " +
          file.string() + ", with what response " + wanted.name + " of the catalogue sets and varies");
  const auto parts = asked_of(asked), given = asked_of(response);
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < std::max(parts.size(), given.size()); ++i) {
    const bool surplus = i >= parts.size(), missing = i >= given.size();
    if (!surplus && !missing && parts[i] == given[i]) continue;
    problems.push_back({surplus ? given[i].first : parts[i].first,
                        "must be " + (surplus ? "none" : parts[i].second) + " as in response " + wanted.name +
                            " of the catalogue, got " + (missing ? "none" : given[i].second)});
    if (i == 0 || surplus || missing || parts[i].first != given[i].first) break;  // another kind
  }
  if (!problems.empty()) throw InputError(file.string(), problems);
  require_consistent(response, file);
  return response;
}

}  // namespace impact_damper
