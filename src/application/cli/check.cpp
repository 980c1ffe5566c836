// `check`: reads files strictly, and does nothing else with them.
#include <array>
#include <filesystem>

#include "application/reproduction/catalogue.hpp"
#include "application/reproduction/claims.hpp"
#include "application/reproduction/manifest.hpp"
#include "application/reproduction/scene_runs.hpp"
#include "application/sweeps/plan_file.hpp"
#include "application/sweeps/sweep_table.hpp"
#include "arguments.hpp"
#include "commands.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/responses/response_file.hpp"
#include "project_files.hpp"
#include "scene_arguments.hpp"

namespace impact_damper::cli {
namespace {

namespace fs = std::filesystem;

// Checks a run; one named after a scene of that folder is compared with it, too.
void check_run(const fs::path& file, const fs::path& scenes) {
  const Run run = read_run(file);
  require_consistent(run, file);
  if (const fs::path scene = scenes / file.filename(); fs::is_regular_file(scene))
    require_scene(run, file, scene);
}

void check_scene(const std::string& file) {
  const SceneFile scene = read_scene_file(file);
  warn_of_cautions(file, scene.scene, scene.scales);
}

// Checks a table, all rows, and the file beside it. CSV only, as `map` reads it.
void check_sweep(const std::string& table) {
  read_sweep_rows(table, read_sweep_description(table), [](std::span<const std::string>) {});
}

// Checks by its digest that every byte of a file that no command reads is as it was written.
void check_digest(const std::string& file, std::string_view kind) {
  constexpr std::size_t most_bytes = 1 << 24;
  const std::string schema = "impact-damper/" + std::string(kind) + "/1";
  SealedDocument document = SealedDocument::read(file, FileKind{kind, most_bytes});
  ObjectReader root = document.root();
  if (root.require("schema")) root.word("schema", {schema});
  root.keys();
  document.finish(root);
}

struct Reader {
  std::string_view kind;
  void (*read)(const std::string& file, const fs::path& scenes);
};
constexpr std::array<Reader, 10> readers{
    {{"scene", [](const std::string& file, const fs::path&) { check_scene(file); }},
     {"run", [](const std::string& file, const fs::path& scenes) { check_run(file, scenes); }},
     {"response",
      [](const std::string& file, const fs::path&) { require_consistent(read_response(file), file); }},
     {"plan", [](const std::string& file, const fs::path&) { read_plan(file, find_named_file); }},
     {"sweep", [](const std::string& file, const fs::path&) { check_sweep(file); }},
     {"design", [](const std::string& file, const fs::path&) { check_digest(file, "design"); }},
     {"comparison", [](const std::string& file, const fs::path&) { check_digest(file, "comparison"); }},
     {"catalogue", [](const std::string& file, const fs::path&) { read_catalogue(file); }},
     {"claims", [](const std::string& file, const fs::path&) { read_claims(file); }},
     {"manifest", [](const std::string& file, const fs::path&) { read_manifest(file); }}}};

// Returns the files, which are no option with many values: that would take "[]" for an empty list.
std::vector<std::string> files_of(Arguments& arguments) {
  std::vector<std::string> files;
  if (const auto first = arguments.file("FILE")) files.push_back(*first);
  for (const std::string& more : arguments.more()) {
    if (more.starts_with('-')) throw UsageError({Problem{"", "unknown argument " + in_quotes(more)}});
    files.push_back(more);
  }
  return files;
}

int check(Arguments& arguments) {
  const std::vector<std::string> files = files_of(arguments);
  const fs::path scenes = arguments.file("--scenes").value_or(project_file("data/scenes"));
  std::vector<std::string_view> kinds;
  kinds.reserve(readers.size());
  for (const Reader& reader : readers) kinds.push_back(reader.kind);
  if (!arguments.given("KIND")) arguments.reject("KIND", "must be given: " + listed(kinds, "or"));
  const std::optional<std::size_t> kind = arguments.word("KIND", kinds);
  if (arguments.given("KIND") && !arguments.given("FILE"))
    arguments.reject("FILE", "must be given, one or several");
  arguments.finish();

  std::string allowed;
  std::vector<std::string> problems;
  for (const std::string& file : files) {
    try {
      readers[*kind].read(file, scenes);
      allowed += file + ": valid\n";
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  }
  if (!problems.empty()) throw InputError(problems);
  write_standard_output(allowed);
  return 0;
}

}  // namespace

Command check_command() {
  Command command{.name = "check", .description = "Read files strictly and say all that is wrong with them."};
  command.options = {
      {"KIND", "scene|run|response|plan|sweep|design|comparison|catalogue|claims|manifest", "what they are"},
      input_option("FILE", "", "one or several"),
      scenes_option()};
  command.takes_more = true;
  command.footer =
      "The same is checked whenever a file is read, but for this: a run or a response must agree with\n"
      "itself, and a run with the scene that it is named after, if --scenes has one. A sweep is given by\n"
      "its table, CSV, beside which FILE.json must be. Designs and comparisons are not read by any command:\n"
      "their digest shows whether they are as they were written. data/schema/ holds JSON Schemas.\n\n"
      "Examples:\n"
      "  impact-damper check scene data/scenes/*.json\n"
      "  impact-damper check run mine.json";
  command.act = check;
  return command;
}

}  // namespace impact_damper::cli
