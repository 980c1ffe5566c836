// The program: passes the command line to one subcommand and turns errors into one line for each problem on
// stderr and an exit code.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <new>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "impact_damper/base/floating_point.hpp"
#include "impact_damper/io/provenance.hpp"

namespace {

using namespace impact_damper;

enum Exit { done = 0, check_failed = 1, usage = 2, bad_input = 3, numerical_failure = 4, input_output = 5 };

// Prints the problems, each after `head`, and returns `code`. Those of files begin with the file's name and
// need no head.
int fail(Exit code, const std::string& head, const std::vector<std::string>& problems) {
  for (const std::string& problem : problems) std::cerr << head + problem + '\n';
  return code;
}

// Returns the unknown arguments, each with the option or subcommand that may be meant.
std::vector<Problem> unknown_arguments(const CLI::App& program, const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  if (&program == &command) {
    for (const CLI::App* each : program.get_subcommands({})) names.push_back(each->get_name());
  }
  const std::vector<std::string_view> known(names.begin(), names.end());
  std::vector<Problem> problems;
  bool value_follows = false;
  for (const std::string& argument : program.remaining(true)) {
    // What follows an unknown option is its value, if it is neither an option nor missing.
    const bool is_option = argument.size() > 1 && argument[0] == '-' && !parse_number(argument);
    if (std::exchange(value_follows, is_option && argument.find('=') == std::string::npos) && !is_option)
      continue;
    const std::string name = argument.substr(0, argument.find('='));
    const bool stands_behind = std::find(known.begin(), known.end(), name) != known.end();  // a bare "--"
    const std::string meant = stands_behind ? "" : did_you_mean(name, known);
    std::error_code unknown;
    const bool is_scene = meant.empty() && !is_option &&
                          std::count(known.begin(), known.end(), "--scene") > 0 &&
                          std::filesystem::is_regular_file(argument, unknown);
    problems.push_back({"", "unknown argument " + in_quotes(argument) +
                                (is_scene ? ", did you mean --scene " + cut(argument) + "?" : meant)});
  }
  return problems;
}

// Returns the arguments, last first as the parser takes them; "help" and "help run" are "--help" and "run
// --help".
std::vector<std::string> arguments_of(const CLI::App& program, int count, char** given) {
  std::vector<std::string> arguments(given + std::min(count, 1), given + count);
  if (!arguments.empty() && arguments[0] == "help") {
    arguments.erase(arguments.begin());
    const std::vector<const CLI::App*> commands = program.get_subcommands({});
    const bool is_known =
        arguments.empty() || std::any_of(commands.begin(), commands.end(), [&](const CLI::App* command) {
          return command->get_name() == arguments[0];
        });
    if (is_known) arguments.emplace_back("--help");
  }
  std::reverse(arguments.begin(), arguments.end());
  return arguments;
}

// Returns the long name of an option, or the name of an argument; the parser has none for what its help
// hides.
std::string name_of(const CLI::Option& option) {
  const std::vector<std::string>& names = option.get_lnames();
  return names.empty() ? option.get_name() : "--" + names.front();
}

// Returns what the parser found for one subcommand.
cli::Arguments found_for(const CLI::App& parsed, const cli::Command& command) {
  std::map<std::string, std::vector<std::string>> options;
  for (const CLI::Option* option : parsed.get_options()) options[name_of(*option)] = option->results();
  std::vector<std::string> more = parsed.remaining();
  const auto find = [](std::vector<std::string>& names) {
    for (std::string& name : names) name = cli::find_named_file(name).value_or(name);
  };
  for (const cli::Option& option : command.options)
    if (option.takes == cli::Option::Takes::input) find(options.at(option.name));
  find(more);
  return {std::move(options), std::move(more)};
}

// Returns the options without a value that took the option after them for it (--x0 --y0 1).
std::vector<Problem> swallowed_options(const CLI::App& command) {
  const std::vector<const CLI::Option*> options = command.get_options();
  const auto is_option = [&](const std::string& value) {
    const std::string name = value.substr(0, value.find('='));
    return name.starts_with('-') &&
           std::any_of(options.begin(), options.end(),
                       [&](const CLI::Option* option) { return option->check_name(name); });
  };
  std::vector<Problem> problems;
  for (const CLI::Option* option : options) {
    for (const std::string& value : option->results())
      if (is_option(value))
        problems.push_back({name_of(*option), "needs a value, got the option " + cut(value)});
  }
  return problems;
}

// Returns the text above the subcommands.
cli::Command whole_program() {
  return {.name = "impact-damper",
          .description =
              "The impact damped simple harmonic oscillator: simulate it, and hold the results against the "
              "paper.",
          .options = {cli::flag_option("-h,--help", "Print this help message and exit"),
                      cli::flag_option("-v,--version", "Display program version information and exit")},
          .footer = R"(impact-damper SUBCOMMAND --help, or help SUBCOMMAND, says more about each.

The project's own files (data/..., figures/...) are looked for in the current folder, then where the
program was installed, PREFIX/share/impact-damper, then in the source folder in whose build/src it is.

What a command writes has the ending of its format (.json, .csv, .dat, .html, .svg, .md, .h5) or none.
As the name of a file to write, - is standard output, in place of what else is printed there.

Exit codes: 0 done, 1 a check failed, 2 the command line is not valid, 3 an input file's content is
not valid, 4 numerical failure, 5 a file cannot be read or written, 130 interrupted.)"};
}

void add_options(CLI::App& app, const cli::Command& command) {
  for (const cli::Option& each : command.options) {
    if (each.name == "-h,--help" || each.name == "-v,--version") continue;  // the parser's own
    CLI::Option* const option = each.takes == cli::Option::Takes::nothing
                                    ? app.add_flag(each.name, each.help)
                                    : app.add_option(each.name, each.help);
    if (each.takes != cli::Option::Takes::nothing) option->type_name(each.type);
    if (each.takes == cli::Option::Takes::repeated_value) option->expected(1)->take_all();
    if (!each.in_help) option->group("");
    if (each.in_help && !each.group.empty()) option->group(each.group);
  }
  app.footer(command.footer);
  app.allow_extras(command.takes_more);
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): without memory for a message there is none
int main(int argc, char** argv) {
  cli::end_cleanly();
  const cli::Command about = whole_program();
  cli::Commands commands{cli::run_command(),    cli::report_command(),  cli::response_command(),
                         cli::design_command(), cli::sweep_command(),   cli::merge_command(),
                         cli::map_command(),    cli::compare_command(), cli::scenes_command(),
                         cli::verify_command(), cli::series_command(),  cli::figures_command(),
                         cli::check_command(),  cli::cite_command()};
  commands.push_back(cli::generate_command(about, commands));
  for (cli::Command& command : commands)
    command.options.insert(command.options.begin(), about.options.front());

  CLI::App program{about.description, about.name};
  program.set_help_flag(about.options[0].name, about.options[0].help);
  program.set_version_flag(about.options[1].name, about.name + " " + std::string(provenance().version) +
                                                      " (" + std::string(provenance().commit) + ")");
  program.get_formatter()->column_width(36);
  program.require_subcommand(0, 1);
  program.footer(about.footer);
  for (const cli::Command& command : commands)
    add_options(*program.add_subcommand(command.name, command.description), command);

  const auto head = [&] {
    const auto parsed = program.get_subcommands();
    return program.get_name() + (parsed.empty() ? "" : ' ' + parsed.front()->get_name()) + ": ";
  };
  const auto command_of = [&]() -> const CLI::App& {
    const auto parsed = program.get_subcommands();
    return parsed.empty() ? program : *parsed.front();
  };

  try {
    try {
      program.parse(arguments_of(program, argc, argv));
    } catch (const CLI::Success& asked_for_help_or_version) {
      std::ostringstream text;
      const int code = program.exit(asked_for_help_or_version, text);
      write_standard_output(text.str());
      return code;
    }
    const std::vector<Problem> swallowed = swallowed_options(command_of());
    if (!swallowed.empty()) throw cli::UsageError(swallowed);
    for (const cli::Command& command : commands) {
      if (command_of().get_name() != command.name) continue;
      require_arithmetic();  // tables and verdicts are computed as well, without an engine
      cli::Arguments arguments = found_for(command_of(), command);
      return command.act(arguments);
    }
    throw cli::UsageError({Problem{"", "a subcommand must be given, see impact-damper --help"}});
  } catch (const CLI::ExtrasError&) {
    const std::vector<Problem> swallowed = swallowed_options(command_of());
    return fail(usage, head(),
                lines_of(swallowed.empty() ? unknown_arguments(program, command_of()) : swallowed));
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string text = error.what(), option = text.substr(0, text.find(':'));
    const bool missing = text.find("missing") != std::string::npos;
    return fail(usage, head(),
                {option + (missing ? ": needs a value, none is given" : ": is given more than once")});
  } catch (const CLI::ParseError& error) {
    return fail(usage, head(), {error.what()});
  } catch (const InvalidArguments& error) {
    return fail(usage, head(), lines_of(error.problems()));
  } catch (const InputError& error) {
    return fail(bad_input, {}, error.problems());
  } catch (const IoError& error) {
    return fail(input_output, {}, {error.what()});
  } catch (const std::invalid_argument& error) {
    return fail(usage, head(), {error.what()});
  } catch (const std::bad_alloc&) {
    return fail(numerical_failure, head(), {"out of memory"});
  } catch (const std::exception& error) {
    return fail(numerical_failure, head(), {error.what()});
  }
}
