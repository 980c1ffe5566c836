// The program's subcommands: one function for each, and what they are made of.
//
// A command says what it is as data: name, options and what it does with them. Only main.cpp sees the parser,
// CLI11, whose headers take seconds to compile in each file that includes them. To add a command: declare it
// here, list it in main.cpp, add its file to CMakeLists.txt.
#pragma once

#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arguments.hpp"
#include "files.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/run.hpp"
#include "progress.hpp"

namespace impact_damper::cli {

struct Option {
  // input: the name of a file or folder that is read; the act gets the place where it is (find_named_file).
  enum class Takes { value, repeated_value, input, nothing };

  std::string name{};  // "--runs", "-o,--output"; of a positional argument without dashes, "FILE"
  std::string type{};  // of the value, "FILE", or the words it is one of, "json|csv"
  std::string help{};
  Takes takes = Takes::value;
  std::string group{};  // its heading in --help; empty: "Options"
  bool in_help = true;  // false: only the man page and the completions list it
};
using Options = std::vector<Option>;
inline Option input_option(const std::string& name, const std::string& type, const std::string& help) {
  return {name, type, help, Option::Takes::input};
}
inline Option repeated_option(const std::string& name, const std::string& type, const std::string& help) {
  return {name, type, help, Option::Takes::repeated_value};
}
inline Option flag_option(const std::string& name, const std::string& help) {
  return {name, {}, help, Option::Takes::nothing};
}

// Returns the options under this heading.
inline Options in_group(const std::string& heading, Options options) {
  for (Option& option : options) option.group = heading;
  return options;
}
// Returns the options of all these lists.
inline Options together(std::initializer_list<Options> lists) {
  Options all;
  for (const Options& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

struct Command {
  std::string name{}, description{};
  Options options{};
  std::string footer{};  // below the options in --help
  // Returns 0, or 1 if a check failed. Throws UsageError (exit code 2), InputError (3), NumericalError (4),
  // IoError (5).
  std::function<int(Arguments&)> act{};
  bool takes_more = false;  // more inputs after the named arguments: Arguments::files()
};

using Commands = std::vector<Command>;

Command check_command();
Command cite_command();
Command compare_command();
Command design_command();
Command figures_command();
// `program`: the text above the subcommands. Both must live as long as the command.
Command generate_command(const Command& program, const Commands& commands);
Command map_command();
Command merge_command();
Command report_command();
Command response_command();
Command run_command();
Command scenes_command();
Command series_command();
Command sweep_command();
Command verify_command();

// Options that several commands have, and what is given by them.
Option threads_option();
Option scenes_option();  // the folder of the scenes that runs are named after
std::string scenes_folder(Arguments& arguments);

// --- What is simulated: the scene, beside or instead of its file, and the engine --------------------------

// Reads the scene of --scene and the options beside it, which take precedence; problems are noted in
// `arguments`. Throws InputError and IoError about the file. Beside a scene in units the options are those of
// its keys, too, and numbers have a unit; they change `in_units` and what is made of it. Options for the
// numbers of one damper are rejected beside a list of several. Stops::ignored: a command that does not use a
// scene's stops neither offers them nor reads those of the file. `own`: keys whose names the command's own
// options have.
enum class Stops { needed, ignored };
using Keys = std::vector<std::string_view>;
SceneFile scene_of(Arguments& arguments, Stops stops = Stops::needed, const Keys& own = {});
// Returns the text of --scene, "" without one.
std::string scene_name_of(const Arguments& arguments);
// Throw InputError about its file where a command that is for one damper, or for one without laws of its own,
// is given another scene.
void require_one_damper(const Scene& scene, const std::string& scene_file);
void require_one_linear_damper(const Scene& scene, const std::string& scene_file);
Engine engine_of(Arguments& arguments, const std::vector<Engine>& engines = default_engines());

// Return the options that scene_of() and engine_of() read.
Options scene_options(Stops stops = Stops::needed, const Keys& own = {});
Options engine_options(const std::vector<Engine>& engines = default_engines());

// Returns whether --si asks for CSV in SI. Rejects it for JSON, `what` is called so, and for a dimensionless
// scene.
bool in_si(Arguments& arguments, Format format, const SceneFile& scene, const std::string& what);

// Prints a line on stderr, "COMMAND: warning: TEXT".
void warn(const std::string& command, const std::string& text);
// Prints such a line for each of cautions_of() the scene.
void warn_of_cautions(const std::string& command, const Scene& scene, const std::optional<Scales>& scales);
// Prints one for a run that was ended by one of its budgets and not by the stops of its scene: which
// budget, how far the run got, and the option that raises it.
void warn_of_early_end(const std::string& command, const Run& run, const std::optional<Scales>& scales);

// Throws problems of simulate(), which name fields, as a UsageError that names the options; as an InputError
// where they are about a list of dampers, which only a scene file has. For a scene in units they add by what
// lengths are divided.
[[noreturn]] void reject_as_options(std::vector<Problem> problems, const std::string& scene_file,
                                    const std::optional<Scales>& scales);
// The same where only some fields have an option, which `options` has with the field; those of the scene are
// problems of --scene.
[[noreturn]] void reject_as_options(
    const std::vector<Problem>& problems,
    std::initializer_list<std::pair<std::string_view, std::string_view>> options);
template <class Simulate>
auto saying_options(Simulate&& simulate_something, const std::string& scene_file = {},
                    const std::optional<Scales>& scales = {}) {
  try {
    return simulate_something();
  } catch (const InvalidArguments& error) {
    reject_as_options(error.problems(), scene_file, scales);
  }
}

}  // namespace impact_damper::cli
