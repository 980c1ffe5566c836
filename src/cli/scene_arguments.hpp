// What is simulated, as options: the scene, beside or instead of its file, and the engine. Shared by the
// commands that simulate a scene of the user's own.
#pragma once

#include <stdexcept>

#include "arguments.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/files/scene_file.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper::cli {

void add_scene_options(CLI::App& app);
void add_engine_options(CLI::App& app);

// The scene of --scene and the options beside it, which win; what is not admitted is noted in `arguments`.
// Throws InputError and IoError about the file.
SceneFile scene_of(Arguments& arguments);
Engine engine_of(Arguments& arguments);

// simulate(); what the engine itself refuses is said of the options instead of the fields, as a UsageError.
Run simulate_as_asked(const Scene& scene, const Engine& engine, const Record& record);

}  // namespace impact_damper::cli
