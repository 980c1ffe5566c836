// `check`: reads files strictly, and does nothing else with them.
#include <algorithm>
#include <array>
#include <filesystem>

#include "application/reproduction/catalogue.hpp"
#include "application/reproduction/claims.hpp"
#include "application/reproduction/manifest.hpp"
#include "application/reproduction/scene_runs.hpp"
#include "application/sweeps/plan.hpp"
#include "application/sweeps/sweep_table.hpp"
#include "commands.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/responses/response_file.hpp"

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

std::vector<std::string_view> kinds() { return texts_of(readers, &Reader::kind); }

// Returns the index of the reader for a file: by its schema, "impact-damper/run/1"; without one it is a scene
// or, where FILE.json is beside it, the table of a sweep.
std::size_t kind_of(const std::string& file) {
  const std::vector<std::string_view> all = kinds();
  std::error_code none;
  const bool is_json = file.ends_with(".json") || !fs::exists(file + ".json", none);
  std::string schema = is_json ? "//" : "/sweep/";
  if (is_json) {
    JsonDocument document = JsonDocument::parse(file, read_text(file));
    if (ObjectReader root = document.root(); root.is_text("schema")) root.optional("schema", schema);
    if (schema == "//") schema = "/scene/";
  }
  const std::vector<std::string_view> parts = parts_of(schema, '/');
  const auto found = parts.size() == 3 ? std::ranges::find(all, parts[1]) : all.end();
  if (found == all.end())
    throw InputError(
        file, {{"/schema", filled("must be that of a {}, got {}", listed(all, "or"), in_quotes(schema))}});
  return std::size_t(found - all.begin());
}

int check(Arguments& arguments) {
  std::vector<std::string> files = arguments.files("FILE");
  const fs::path scenes = scenes_folder(arguments);
  std::optional<std::size_t> kind;
  // The first argument may be left out; a kind is no name of a file.
  if (const std::string first = arguments.text("KIND").value_or("");
      first.find_first_of("./") != std::string::npos || fs::is_regular_file(first))
    files.insert(files.begin(), find_named_file(first).value_or(first));
  else
    kind = arguments.word("KIND", kinds());
  if (files.empty() && !arguments.given("FILE")) arguments.reject("FILE", "must be given, one or several");
  arguments.finish();

  std::string allowed;
  std::vector<std::string> problems;
  for (const std::string& file : files) {
    try {
      readers[kind ? *kind : kind_of(file)].read(file, scenes);
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
  return {
      .name = "check",
      .description = "Read files strictly and say all that is wrong with them.",
      .options = {{"KIND", joined(kinds(), "|"), "what they are; if left out, each file's schema tells it"},
                  input_option("FILE", "", "one or several"),
                  scenes_option()},
      .footer =
          R"(The same is checked whenever a file is read, but for this: a run or a response must agree with
itself, and a run with the scene that it is named after, if --scenes has one. A file without a schema
is a scene. A sweep is given by its table, CSV, beside which FILE.json must be. Designs and comparisons are not read by any command:
their digest shows whether they are as they were written. data/schema/ holds JSON Schemas.

Examples:
  impact-damper check data/examples/*.json
  impact-damper check scene data/scenes/*.json
  impact-damper check run mine.json)",
      .act = check,
      .takes_more = true};
}

}  // namespace impact_damper::cli
