// The stress program: what an engine must stand, and how fast it is when it does not matter.
//
//   impact-damper-stress [--brief] [--only SUBJECT] [--seed N] [--scenes N] [--threads N] FOLDER
//
// Writes FOLDER/stress.md and stress.json (the table, and every miss with what repeats it), and the tables
// that are drawn; prints the first. Subjects: central-differences, random, aimed, dampers, sensitivity; all
// of them without --only. --brief: the same with smaller counts. --seed: this random scene only (or, with
// --only aimed, this grazing one; with --only dampers, this list). Exit code 1 if anything was missed.
// Nothing written depends on the number of threads or on time, but for FOLDER/slowest.txt.
#include "stress.hpp"

#include <array>
#include <cstdio>
#include <functional>
#include <iostream>
#include <string>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/file_output.hpp"

namespace stress {
namespace {

struct Subject {
  const char* name;
  std::vector<Check> (*run)(const Options&);
  bool seeded;
};
constexpr std::array<Subject, 5> subjects{{{"central-differences", central_differences, false},
                                           {"random", random_scenes_of_all_kinds, true},
                                           {"aimed", aimed_scenes, true},
                                           {"dampers", several_dampers, true},
                                           {"sensitivity", sensitivity, false}}};

int usage(const std::string& what) {
  std::cerr
      << "impact-damper-stress: " << what
      << "\nusage: impact-damper-stress [--brief] [--only SUBJECT] [--seed N] [--scenes N] [--threads N] "
         "FOLDER\n";
  return 2;
}

int run(const std::vector<std::string>& arguments) {
  Options options;
  std::string only;
  std::optional<std::int64_t> scenes;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    if (word == "--brief") {
      options.brief = true;
    } else if (!word.starts_with("--")) {
      if (!options.folder.empty()) return usage("one FOLDER only, got " + word + " too");
      options.folder = word;
    } else if (i + 1 == arguments.size()) {
      return usage(word + ": needs a value");
    } else if (word == "--only") {
      only = arguments[++i];
    } else {
      const std::optional<std::int64_t> number = impact_damper::parse_integer(arguments[++i]);
      if (!number || *number < 1) return usage(word + ": must be a whole number >= 1, got " + arguments[i]);
      if (word == "--seed") {
        options.seed = static_cast<std::uint64_t>(*number);
      } else if (word == "--scenes") {
        scenes = number;
      } else if (word == "--threads") {
        options.threads = number;
      } else {
        return usage("unknown option " + word);
      }
    }
  }
  if (options.folder.empty()) return usage("FOLDER must be given");
  options.scene_folder = SCENES_FOLDER;
  options.scenes = scenes.value_or(options.brief ? 10'000 : 1'000'000);
  if (options.seed && only.empty()) only = "random";

  std::filesystem::create_directories(options.folder);
  std::vector<Check> checks;
  bool known = only.empty();
  for (const Subject& subject : subjects) {
    if (!only.empty() && only != subject.name) continue;
    known = true;
    if (options.seed && !subject.seeded) return usage(only + " has no seeds");
    try {
      for (const Check& check : subject.run(options)) checks.push_back(check);
    } catch (const std::exception& error) {
      Check check{
          .subject = subject.name, .what = "runs to its end", .measured = {}, .allowed = {}, .cases = 1};
      check.miss(error.what());
      checks.push_back(check);
    }
  }
  if (!known)
    return usage("--only: must be central-differences, random, aimed, dampers or sensitivity, got " + only);
  const std::string table = markdown(checks);
  impact_damper::write_file(options.folder / "stress.md", table);
  impact_damper::write_file(options.folder / "stress.json", json(checks));
  std::cout << table;
  std::int64_t missed = 0;
  for (const Check& check : checks) missed += check.missed;
  std::cerr << "stress: " << (missed == 0 ? "nothing missed" : std::to_string(missed) + " missed") << '\n';
  return missed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace stress

int main(int count, char** arguments) {
  try {
    return stress::run({arguments + 1, arguments + count});
  } catch (const std::exception& error) {
    std::cerr << "impact-damper-stress: " << error.what() << '\n';
    return 5;
  }
}
