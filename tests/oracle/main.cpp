// The program of the oracle.
//
//   impact-damper-oracle [--dampers one|several] [--kind KIND] [--engine ENGINE] [--seed N] [--count M]
//                        [--components no|yes] [--threads N] [--results FILE]
//   impact-damper-oracle [--engine ENGINE] [--scene FILE] [the scene options of `impact-damper run`]
//
// The first form compares the scenes of seeds N to N + M - 1 with the oracle: KIND random or round, ENGINE
// exact, restitution or cem, all of both if not given; of several dampers KIND aimed, too, and ENGINE exact
// or restitution. With components the scenes have friction, weight and drag, of several dampers for cem, too.
// It prints every scene that differs, with what runs it, and a table; FILE gets the same as a section of a
// Markdown page. The second form prints the oracle's own run of one scene, one event a line, and where the
// engine differs. Exit code 1 if anything differs, 2: usage.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>

#include "compare.hpp"
#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "scenes.hpp"

namespace oracle {
namespace {

using namespace impact_damper;

// Of the compared time of what was asked for, at least: a comparison that compares nothing is noticed.
constexpr double least_share = 0.5;

struct Options {
  bool several = false, components = false;
  std::vector<std::string> kinds{"random", "round", "aimed"}, engines{"exact", "restitution", "cem"};
  std::int64_t first = 1, count = 100;
  Threads threads = 2;
  std::string results;
  bool one = false;
  Scene scene;
};

Engine engine_named(const std::string& name) {
  if (name == Restitution::name) return Restitution{};
  if (name == Cem::name) return Cem{.locate = true};
  return Exact{};
}

Scene without_components(const std::string& kind, bool rigid, bool several, std::uint64_t seed) {
  if (!several) return kind == "random" ? random_scene(seed, rigid) : round_scene(seed, rigid);
  if (kind == "random") return rigid ? random_list(seed) : random_compliant_list(seed);
  if (kind == "round") return rigid ? round_list(seed) : round_compliant_list(seed);
  return rigid ? aimed_list(seed) : aimed_compliant_list(seed);
}

Scene scene_of(const std::string& kind, const std::string& engine, const Options& options,
               std::uint64_t seed) {
  Scene scene = without_components(kind, engine == Restitution::name, options.several, seed);
  if (options.components) scene = with_components(scene, seed, kind == "round");
  return engine == Cem::name ? within_steps(scene) : scene;
}

std::string rounded(double number, int digits = 2) {
  char out[32];
  std::snprintf(out, sizeof out, "%.*g", digits, number);
  return out;
}

struct Row {
  std::string kind, engine;
  std::int64_t scenes = 0, failed = 0, numbers = 0, impacts = 0, whole = 0, together = 0;
  double share = 0, worst = 0;
  std::string worst_what;
  std::vector<std::string> failures;
};

Row compare_all(const std::string& kind, const std::string& engine, const Options& options) {
  std::vector<Comparison> all(static_cast<std::size_t>(options.count));
  const auto scene = [&](std::int64_t i) {
    return scene_of(kind, engine, options, static_cast<std::uint64_t>(options.first + i));
  };
  for_each_index(options.count, options.threads, [&](std::int64_t i) {
    all[static_cast<std::size_t>(i)] = compare(scene(i), engine_named(engine), {.as_list = options.several});
  });
  Row row{.kind = kind, .engine = engine, .scenes = options.count, .worst_what = {}, .failures = {}};
  for (std::int64_t i = 0; i < options.count; ++i) {
    const Comparison& each = all[static_cast<std::size_t>(i)];
    const std::string seed = std::to_string(options.first + i);
    row.numbers += each.numbers;
    row.impacts += each.impacts;
    row.together += each.joint_impacts + each.joint_contacts;
    row.whole += each.until == each.asked;
    row.share += each.until / each.asked / double(options.count);
    if (each.differences.empty()) {
      if (each.worst > row.worst) row.worst = each.worst, row.worst_what = each.worst_what + ", seed " + seed;
      continue;
    }
    ++row.failed;
    Scene failed = scene(i);
    failed.until_time = each.until;
    std::string text = "seed " + seed + ": " + engine + " " +
                       (options.several ? scene_text(failed) : options_of(failed) + "\n");
    for (std::size_t n = 0; n < std::min<std::size_t>(each.differences.size(), 4); ++n)
      text += "    " + each.differences[n] + "\n";
    if (each.differences.size() > 4)
      text += "    and " + std::to_string(each.differences.size() - 4) + " more\n";
    row.failures.push_back(text);
  }
  return row;
}

std::string table(const std::vector<Row>& rows, const Options& options) {
  std::string text =
      "Seeds " + std::to_string(options.first) + " to " + std::to_string(options.first + options.count - 1) +
      " of each kind.\n\n" +
      "| scenes | engine | number | whole | share of time | numbers | impacts | worst error, predicted "
      "ones | which | differ |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows)
    text += "| " + row.kind + (options.components ? " with components" : "") +
            (options.several ? ", several dampers | " : " | ") + row.engine + " | " +
            std::to_string(row.scenes) + " | " + std::to_string(row.whole) + " | " + rounded(row.share, 3) +
            " | " + std::to_string(row.numbers) + " | " + std::to_string(row.impacts) +
            (options.several ? ", together " + std::to_string(row.together) : "") + " | " +
            rounded(row.worst) + " | " + row.worst_what + " | " +
            (row.failed == 0 ? "none" : "**" + std::to_string(row.failed) + "**") + " |\n";
  return text;
}

int usage(const std::string& what) {
  std::cerr << "impact-damper-oracle: " << what
            << "\nusage: impact-damper-oracle [--dampers one|several] [--kind random|round|aimed] "
               "[--engine exact|restitution|cem] [--components no|yes] [--seed N] [--count N] "
               "[--threads N] [--results FILE]\n"
               "       impact-damper-oracle [--engine ENGINE] [--scene FILE] [scene options of "
               "impact-damper run]\n";
  return 2;
}

int compare_many(const Options& options) {
  std::vector<Row> rows;
  bool missed = false;
  for (const std::string& kind : options.kinds)
    for (const std::string& engine : options.engines) {
      if (options.several ? engine == Cem::name && !options.components : kind == "aimed") continue;
      rows.push_back(compare_all(kind, engine, options));
      const Row& row = rows.back();
      for (const std::string& failure : row.failures) std::cout << kind << ' ' << failure;
      if (row.share < least_share) std::cout << kind << ' ' << engine << ": too little was compared\n";
      missed = missed || row.failed > 0 || row.share < least_share;
      std::cout.flush();
    }
  if (rows.empty()) return usage("no such scenes with this engine");
  const std::string text = table(rows, options);
  std::cout << text;
  if (!options.results.empty()) {
    std::string section = text;
    for (const Row& row : rows)
      for (std::size_t i = 0; i < std::min<std::size_t>(row.failures.size(), 20); ++i)
        section += "\n    " + row.kind + ' ' + row.failures[i];
    write_file(options.results, section);
  }
  return missed ? 1 : 0;
}

int show_one(const Options& options) {
  const std::string& engine = options.engines.front();
  Question question;
  question.scene = options.scene;
  question.walls = engine == Restitution::name ? Walls::rigid : Walls::compliant;
  question.most_steps = question.most_impacts = 100'000;
  std::cout << lines_of(answer_to(question));
  if (!options.scene.until_time) return 0;
  const Comparison result = compare(options.scene, engine_named(engine));
  std::cout << engine << ": " << result.numbers << " numbers, " << result.impacts
            << " impacts compared up to " << rounded(result.until, 17)
            << (result.ended_by.empty() ? "" : " (" + result.ended_by + ")") << ", largest error "
            << rounded(result.worst) << " predicted ones: " << result.worst_what << '\n';
  for (const std::string& difference : result.differences) std::cout << difference << '\n';
  return result.differences.empty() ? 0 : 1;
}

int run(const std::vector<std::string>& words) {
  Options options;
  for (std::size_t i = 0; i < words.size(); i += 2) {
    const std::string& word = words[i];
    if (i + 1 == words.size()) return usage(word + ": needs a value");
    const std::string& value = words[i + 1];
    std::string field = word.substr(std::min<std::size_t>(2, word.size()));
    std::replace(field.begin(), field.end(), '-', '_');
    const auto one_of = [&](std::vector<std::string>& target) {
      if (std::find(target.begin(), target.end(), value) == target.end()) return false;
      target = {value};
      return true;
    };
    const std::optional<std::int64_t> whole = parse_integer(value);
    const std::optional<double> number = parse_number(value);
    Scene& scene = options.scene;
    const auto known = std::find_if(scene_fields.begin(), scene_fields.end(),
                                    [&](const SceneField& each) { return each.name == field; });
    if (word == "--kind" ? !one_of(options.kinds) : word == "--engine" && !one_of(options.engines))
      return usage(word + ": unknown " + value);
    if (word == "--kind" || word == "--engine") continue;
    if (word == "--dampers" && (value == "one" || value == "several")) {
      options.several = value == "several";
    } else if (word == "--components" && (value == "no" || value == "yes")) {
      options.components = value == "yes";
    } else if (word == "--seed" && whole) {
      options.first = *whole;
    } else if (word == "--count" && whole) {
      options.count = *whole;
    } else if (word == "--threads" && whole) {
      options.threads = whole;
    } else if (word == "--results") {
      options.results = value;
    } else if (word == "--scene") {
      scene = read_scene(value), options.one = true;
    } else if (word == "--until-time" && number) {
      scene.until_time = number, options.one = true;
    } else if (word == "--until-amplitude" && number) {
      scene.until_amplitude = number, options.one = true;
    } else if (known != scene_fields.end() && number) {
      known->number.in(scene) = *number, options.one = true;
    } else {
      return usage("unknown option or value: " + word + " " + value);
    }
  }
  if (!options.one) return compare_many(options);
  for (const Problem& problem : problems_of(options.scene))
    return usage(problem.field + ": " + problem.message);
  return show_one(options);
}

}  // namespace
}  // namespace oracle

int main(int count, char** arguments) {
  try {
    return oracle::run({arguments + 1, arguments + count});
  } catch (const std::exception& error) {
    std::cerr << "impact-damper-oracle: " << error.what() << '\n';
    return 5;
  }
}
