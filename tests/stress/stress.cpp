// The stress program: what an engine must stand, and how fast it is when it does not matter.
//
//   impact-damper-stress [--brief] [--only SUBJECT] [--seed N] FOLDER
//
// Writes FOLDER/stress.md and stress.json (the table, and every miss with what repeats it), and the tables
// that are drawn; prints the first. Subjects: central-differences, random, aimed, dampers, sensitivity; all
// of them without --only. --brief: the same with smaller counts. --seed: this random scene only (or, with
// --only aimed, this grazing one; with --only dampers, this list). Exit code 1 if anything was missed.
// Nothing written depends on the number of threads or on time, but for FOLDER/slowest.txt.
#include "stress.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/file_output.hpp"

namespace stress {
namespace {

std::string printed(const char* format, int digits, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, digits, value);
  return text;
}

std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

// Markdown: the table, then every miss. The same as JSON.
std::string markdown(const std::vector<Check>& checks) {
  std::string text = "| subject | what | cases | worst | allowed | misses |\n|---|---|---|---|---|---|\n";
  for (const Check& check : checks) {
    text += "| " + check.subject + " | " + cell(check.what) + " | " + std::to_string(check.cases) + " | " +
            cell(check.measured) + " | " + cell(check.allowed) + " | " +
            (check.missed == 0 ? "none" : "**" + std::to_string(check.missed) + "**") + " |\n";
  }
  for (const Check& check : checks) {
    if (check.missed == 0) continue;
    text += "\nMissed: " + check.subject + ", " + check.what + "\n\n";
    for (const std::string& miss : check.misses) text += "    " + miss + "\n";
    if (check.misses.size() < static_cast<std::size_t>(check.missed)) text += "    ...\n";
  }
  return text;
}

std::string json(const std::vector<Check>& checks) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Check& check : checks)
    all.push_back({{"subject", check.subject},
                   {"what", check.what},
                   {"cases", check.cases},
                   {"measured", check.measured},
                   {"allowed", check.allowed},
                   {"missed", check.missed},
                   {"misses", check.misses}});
  return nlohmann::ordered_json{{"schema", "impact-damper/stress/1"}, {"checks", all}}.dump(1) + "\n";
}

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
  std::cerr << "impact-damper-stress: " << what
            << "\nusage: impact-damper-stress [--brief] [--only SUBJECT] [--seed N] FOLDER\n";
  return 2;
}

int run(const std::vector<std::string>& arguments) {
  Options options;
  std::string only;
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
    } else if (word == "--seed") {
      const std::optional<std::int64_t> number = impact_damper::parse_integer(arguments[++i]);
      if (!number || *number < 1) return usage(word + ": must be a whole number >= 1, got " + arguments[i]);
      options.seed = static_cast<std::uint64_t>(*number);
    } else {
      return usage("unknown option " + word);
    }
  }
  if (options.folder.empty()) return usage("FOLDER must be given");
  options.scene_folder = SCENES_FOLDER;
  options.scenes = options.brief ? 10'000 : 1'000'000;
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

std::string rounded(double value, int digits) { return printed("%.*g", digits, value); }
std::string full(double value) { return printed("%.*g", 17, value); }

void Check::add(const Check& part) {
  cases += part.cases;
  missed += part.missed;
  for (const std::string& each : part.misses)
    if (misses.size() < most_misses) misses.push_back(each);
}

void say(const std::string& what) { std::fprintf(stderr, "stress: %s\n", what.c_str()); }

double seconds() {
  static const auto start = std::chrono::steady_clock::now();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Progress::tell(std::int64_t done, std::int64_t all, const std::string& more) {
  const double now = seconds();
  if (last_ < 0) last_ = now;
  if (now - last_ < 2) return;
  last_ = now;
  std::fprintf(stderr, "stress: %s: %lld of %lld%s%s\n", what_.c_str(), static_cast<long long>(done),
               static_cast<long long>(all), more.empty() ? "" : ", ", more.c_str());
}

}  // namespace stress

int main(int count, char** arguments) {
  try {
    return stress::run({arguments + 1, arguments + count});
  } catch (const std::exception& error) {
    std::cerr << "impact-damper-stress: " << error.what() << '\n';
    return 5;
  }
}
