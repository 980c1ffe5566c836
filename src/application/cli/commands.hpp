// The program's subcommands: one function for each, and what they are made of.
//
// A command says what it is as data: name, options and what it does with them. Only main.cpp sees the parser,
// CLI11, whose headers take seconds to compile in each file that includes them. To add a command: declare it
// here, list it in main.cpp, add its file to CMakeLists.txt.
#pragma once

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "output.hpp"
#include "progress.hpp"
#include "project_files.hpp"

namespace impact_damper::cli {

struct Option {
  // input: the name of a file or folder that is read; the act gets the place where it is (find_named_file).
  enum class Takes { value, repeated_value, input, nothing };

  std::string name{};  // "--runs", "-o,--output"; of a positional argument without dashes, "FILE"
  std::string type{};  // of the value, "FILE", or the words it is one of, "json|csv"
  std::string help{};
  Takes takes = Takes::value;
  std::string group{};  // its heading in --help; empty: "Options"
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

// `design --dampers`: designs several dampers for a range of amplitudes.
int design_dampers(Arguments& arguments);

// Options that several commands have, and what is given by them.
Option threads_option();
Option scenes_option();  // the folder of the scenes that runs are named after
std::string scenes_folder(Arguments& arguments);

}  // namespace impact_damper::cli
