// The program's subcommands: one function and one file each.
//
// A command adds itself to the program and says what to do once its arguments are parsed: return 0, or 1
// if a check failed; throw UsageError (exit code 2), InputError (3), NumericalError (4), IoError (5).
// To add one: declare it here, list it in main.cpp, add its file to CMakeLists.txt.
#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace impact_damper::cli {

struct Command {
  CLI::App* arguments = nullptr;
  std::function<int()> act;
};

Command check_command(CLI::App& program);
Command cite_command(CLI::App& program);
Command figures_command(CLI::App& program);
Command generate_command(CLI::App& program);
Command report_command(CLI::App& program);
Command run_command(CLI::App& program);
Command scenes_command(CLI::App& program);
Command verify_command(CLI::App& program);
Command series_command(CLI::App& program);

}  // namespace impact_damper::cli
