// The program of the oracle for several dampers.
//
//   impact-damper-several [--walls rigid|compliant] [--kind random|round|aimed] [--seed N] [--count M]
//   [--begin-tolerance T] [--growth G]
//                         [--scene FILE] [--failures K] [--verbose 1]
//
// compares the scenes of seeds N to N + M - 1, of all kinds if none is given, or the scene of FILE, with
// what the restitution engine, or with compliant walls the exact one, makes of them. Prints the first scene
// that differs, with all that does, and a line of totals. Exit code 0: all agrees; 1: a scene differs, or
// less than half of the time could be compared; 2: usage.
#include <algorithm>
#include <cstdio>
#include <iostream>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "print.hpp"
#include "several_compare.hpp"
#include "several_scenes.hpp"

namespace several {
namespace {

using namespace impact_damper;

struct Options {
  std::vector<std::string> kinds{"random", "round", "aimed"};
  std::int64_t first = 1, count = 100;
  std::optional<Scene> scene;
  std::int64_t most_failures = 1;
  bool verbose = false;
  Tolerances tolerances;
};

void show(const std::string& name, const Scene& scene, const Comparison& result) {
  std::cout << name << ", compared until " << oracle::text(result.until, 17) << ":\n" << text_of(scene);
  for (std::size_t n = 0; n < std::min<std::size_t>(result.differences.size(), 6); ++n)
    std::cout << "    " << result.differences[n] << '\n';
  if (result.differences.size() > 6) std::cout << "    and " << result.differences.size() - 6 << " more\n";
  std::cout.flush();
}

Scene scene_of(const std::string& kind, Walls walls, std::uint64_t seed) {
  const bool rigid = walls == Walls::rigid;
  if (kind == "random") return rigid ? random_scene(seed) : random_compliant_scene(seed);
  if (kind == "round") return rigid ? round_scene(seed) : round_compliant_scene(seed);
  return rigid ? aimed_scene(seed) : aimed_compliant_scene(seed);
}

int compare_all(const Options& options) {
  std::int64_t failures = 0;
  bool little = false;
  for (const std::string& kind : options.kinds) {
    Comparison sum;
    std::int64_t scenes = 0, whole = 0;
    double share = 0;
    for (std::int64_t i = 0; i < options.count && failures < options.most_failures; ++i) {
      const auto seed = std::uint64_t(options.first + i);
      const Scene scene = scene_of(kind, options.tolerances.walls, seed);
      const Comparison result = compare(scene, options.tolerances);
      if (options.verbose && !result.ended_by.empty())
        std::cout << kind << " seed " << seed << ": compared until " << oracle::text(result.until, 8)
                  << " of " << oracle::text(result.asked, 8) << ", " << result.ended_by << '\n';
      ++scenes;
      whole += result.until == result.asked;
      share += result.until / result.asked;
      sum.numbers += result.numbers, sum.impacts += result.impacts, sum.contacts += result.contacts;
      sum.joint_impacts += result.joint_impacts, sum.joint_contacts += result.joint_contacts;
      if (!result.differences.empty()) {
        ++failures;
        show(kind + " seed " + std::to_string(seed), scene, result);
        continue;
      }
      sum.largest = std::max(sum.largest, result.largest);
      if (result.worst > sum.worst)
        sum.worst = result.worst, sum.worst_what = result.worst_what + ", seed " + std::to_string(seed);
    }
    if (scenes == 0) continue;
    std::printf(
        "%s: %ld scenes, %ld of them whole, %.3f of the time, %ld numbers, %ld impacts (%ld at one instant "
        "with "
        "another), %ld contacts (%ld together with another); largest error %.2g, %.3g of the predicted one "
        "at "
        "worst (%s)\n",
        kind.c_str(), long(scenes), long(whole), share / double(scenes), long(sum.numbers), long(sum.impacts),
        long(sum.joint_impacts), long(sum.contacts), long(sum.joint_contacts), sum.largest, sum.worst,
        sum.worst_what.c_str());
    std::fflush(stdout);
    if (!(share >= 0.5 * double(scenes))) {
      std::cout << kind << ": less than half of the time was compared\n";
      little = true;
    }
  }
  return failures > 0 || little ? 1 : 0;
}

int compare_one(const Options& options) {
  const Comparison result = compare(*options.scene, options.tolerances);
  show("scene", *options.scene, result);
  if (!result.ended_by.empty()) std::cout << "ended by " << result.ended_by << '\n';
  return result.differences.empty() ? 0 : 1;
}

int usage(const std::string& what) {
  std::cerr
      << "impact-damper-several: " << what
      << "\nusage: impact-damper-several [--walls rigid|compliant] [--kind random|round|aimed] [--seed N] "
         "[--count M] [--failures K]"
         " [--begin-tolerance T] [--growth G] [--scene FILE]\n";
  return 2;
}

int run(const std::vector<std::string>& words) {
  Options options;
  for (std::size_t i = 0; i < words.size(); i += 2) {
    const std::string& word = words[i];
    if (i + 1 == words.size()) return usage(word + ": needs a value");
    const std::string& value = words[i + 1];
    const std::optional<std::int64_t> whole = parse_integer(value);
    const std::optional<double> number = parse_number(value);
    if (word == "--kind" && (value == "random" || value == "round" || value == "aimed"))
      options.kinds = {value};
    else if (word == "--walls" && (value == "rigid" || value == "compliant"))
      options.tolerances.walls = value == "rigid" ? Walls::rigid : Walls::compliant;
    else if (word == "--seed" && whole)
      options.first = *whole;
    else if (word == "--count" && whole && *whole > 0)
      options.count = *whole;
    else if (word == "--failures" && whole && *whole > 0)
      options.most_failures = *whole;
    else if (word == "--begin-tolerance" && number && *number > 0)
      options.tolerances.begin = *number;
    else if (word == "--growth" && number && *number > 0)
      options.tolerances.growth = *number;
    else if (word == "--verbose" && whole)
      options.verbose = *whole != 0;
    else if (word == "--scene")
      options.scene = read_scene(value);
    else
      return usage("unknown option or value: " + word + " " + value);
  }
  if (!options.scene) return compare_all(options);
  if (options.scene->dampers.empty() || !options.scene->until_time)
    return usage("the scene needs `dampers` and `until_time`");
  return compare_one(options);
}

}  // namespace
}  // namespace several

int main(int count, char** arguments) {
  try {
    return several::run({arguments + 1, arguments + count});
  } catch (const std::exception& error) {
    std::cerr << "impact-damper-several: " << error.what() << '\n';
    return 5;
  }
}
