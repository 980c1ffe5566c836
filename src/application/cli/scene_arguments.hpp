// Options for what is simulated: the scene, beside or instead of its file, and the engine. Shared by the
// commands that simulate a scene of the user's own.
#pragma once

#include "commands.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper::cli {

// Reads the scene of --scene and the options beside it, which take precedence; problems are noted in
// `arguments`. Throws InputError and IoError about the file. Options for the numbers of one damper are
// rejected beside a list of several. Stops::ignored: a command that does not use a scene's stops neither
// offers them nor reads those of the file.
enum class Stops { needed, ignored };
SceneFile scene_of(Arguments& arguments, Stops stops = Stops::needed);
// Returns the text of --scene, "" without one.
std::string scene_name_of(const Arguments& arguments);
// Throws InputError about its file where a command that is for one damper is given several.
void require_one_damper(const Scene& scene, const std::string& scene_file);
// Rejects the options beside --scene, in commands that change a scene in units by its own numbers.
void reject_options_beside_units(Arguments& arguments, const SceneFile& scene, const std::string& instead);
Engine engine_of(Arguments& arguments, const std::vector<Engine>& engines = default_engines());

// Return the options that scene_of() and engine_of() read.
Options scene_options(Stops stops = Stops::needed);
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
