// `generate`: prints the man page and the shells' completions, from the declared options, so that they always
// agree with --help.
#include <algorithm>
#include <string>
#include <vector>

#include "commands.hpp"
#include "impact_damper/io/provenance.hpp"

namespace impact_damper::cli {
namespace {

// An option with its names separated.
struct Described {
  std::vector<std::string> shorts, longs;  // without dashes; neither for a positional
  std::string positional, type, meaning;
  bool takes_value = false;
};

std::vector<Described> options_of(const Command& command) {
  std::vector<Described> all;
  for (const Option& option : command.options) {
    Described& described = all.emplace_back(
        Described{{}, {}, {}, option.type, option.help, option.takes != Option::Takes::nothing});
    for (const std::string_view name : parts_of(option.name)) {
      if (name.starts_with("--"))
        described.longs.emplace_back(name.substr(2));
      else if (name.starts_with('-'))
        described.shorts.emplace_back(name.substr(1));
      else
        described.positional = name;
    }
  }
  return all;
}

std::vector<std::string> names_of(const Described& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.shorts) names.push_back("-" + name);
  for (const std::string& name : option.longs) names.push_back("--" + name);
  return names;
}

// Returns the words that a value is chosen from, which its type lists: exact|restitution|cem.
std::vector<std::string_view> choices(const Described& option) {
  auto words = parts_of(option.type, '|');
  if (words.size() == 1) words.clear();
  return words;
}

// Returns one line: the text up to the first semicolon.
std::string brief(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return text.substr(0, text.find(';'));
}

// Returns `text` with `before` inserted before each of `characters`.
std::string escaped(const std::string& text, std::string_view characters, const std::string& before) {
  std::string out;
  for (const char c : text) {
    if (characters.find(c) != std::string_view::npos) out += before;
    out += c;
  }
  return out;
}

// Returns `text` in single quotes, for a shell without escapes in them.
std::string single_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string roff(const std::string& text) {
  std::string out;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    out += c == '\\' ? std::string("\\e") : c == '-' ? std::string("\\-") : std::string(1, c);
    if (c == '|') out += "\\:";  // where a list of words may be broken
    begins = c == '\n';
  }
  return out;
}

std::string roff_options(const Command& command) {
  std::string text;
  for (const Described& option : options_of(command)) {
    const std::vector<std::string> names = names_of(option);
    text += ".TP\n.B " + roff(names.empty() ? option.positional : joined(names, ", "));
    if (option.takes_value && !option.type.empty()) text += " \\fI" + roff(option.type) + "\\fP";
    text += '\n';  // in two steps, because g++ 12 warns of one sum without reason
    text += roff(option.meaning) + '\n';
  }
  return text;
}

// Returns the footer as it is printed, line by line.
std::string roff_footer(const Command& command) { return ".PP\n.nf\n" + roff(command.footer) + "\n.fi\n"; }

std::string man_page(const Command& program, const Commands& commands) {
  const std::string& name = program.name;
  std::string text = R"(.TH IMPACT\-DAMPER 1 "" )" +
                     roff('"' + name + ' ' + std::string(provenance().version) + '"') + "\n.nh\n";
  text += ".SH NAME\n" + roff(name) + " \\- " + roff(program.description) + "\n.SH SYNOPSIS\n";
  for (const Command& command : commands) {
    text += ".B " + roff(name + " " + command.name) + "\n";
    for (const Described& option : options_of(command))
      if (!option.positional.empty()) text += "\\fI" + roff(option.positional) + "\\fP\n";
    text += "[\\fIOPTIONS\\fP]\n.br\n";
  }
  text += ".SH OPTIONS\n" + roff_options(program) + roff_footer(program);
  for (const Command& command : commands) {
    text += ".SH " + roff(command.name) + "\n" + roff(command.description) + "\n";
    text += roff_options(command) + roff_footer(command);
  }
  return text;
}

// Returns the script for bash. Where no words of the program fit, readline completes file names (complete -o
// default).
std::string bash_completion(const Command& program, const Commands& commands) {
  std::string names_of_commands, values, words;
  for (const Command& command : commands) {
    names_of_commands += " " + command.name;
    std::string names, first;
    for (const Described& option : options_of(command)) {
      const std::vector<std::string> each = names_of(option);
      for (const std::string& name : each) {
        names += " " + name;
        if (choices(option).empty()) continue;
        values += filled("    {}) words={} ;;\n", single_quoted(command.name + " " + name),
                         single_quoted(joined(choices(option), " ")));
      }
      if (each.empty() && first.empty()) first = joined(choices(option), " ");
    }
    words += filled("    {}) options={}{} ;;\n", command.name, single_quoted(names.substr(1)),
                    first.empty() ? "" : " first=" + single_quoted(first));
  }
  for (const Described& option : options_of(program))
    names_of_commands += " " + joined(names_of(option), " ");
  return filled(R"(# bash completion for impact-damper, by: impact-damper generate bash
_impact_damper() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}
  local words= options= first=
  if [ "$word" = = ]; then
    word=
  elif [ "$before" = = ]; then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  case $command in
{}  esac
  case "$command $before" in
{}    *)
      if [ "$COMP_CWORD" -eq 1 ]; then words={}
      elif [[ $word == -* ]]; then words=$options
      elif [ "$COMP_CWORD" -eq 2 ]; then words=$first
      fi ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}
complete -o default -F _impact_damper impact-damper
)",
                words, values, single_quoted(names_of_commands.substr(1)));
}

std::string zsh_completion(const Command& program, const Commands& commands) {
  // _arguments interprets brackets and colons; the text is in single quotes.
  const auto described = [](const std::string& text) { return escaped(brief(text), "[]:\\", "\\"); };
  std::string described_commands, cases;
  for (const Command& command : commands) {
    described_commands +=
        "    " + single_quoted(command.name + ":" + escaped(command.description, ":\\", "\\")) + "\n";
    cases += "    " + command.name + ")\n      _arguments";
    const auto add = [&cases](const std::string& argument) {
      cases += " \\\n        " + single_quoted(argument);
    };
    for (const Described& option : options_of(command)) {
      const std::vector<std::string_view> words = choices(option);
      std::string value = option.type == "FOLDER" ? "_files -/" : "_files";
      if (!words.empty()) value = "(" + joined(words, " ") + ")";
      const std::string plain = "[" + described(option.meaning) + "]";
      const std::string valued = filled("{}:{}:{}", plain, escaped(option.type, ":\\", "\\"), value);
      for (const std::string& name : names_of(option)) {
        const char* const before_value = name.starts_with("--") ? "=" : "+";
        add("*" + name + (option.takes_value ? before_value + valued : plain));
      }
      if (!option.positional.empty() && !words.empty()) add("1:" + option.positional + ":" + value);
    }
    add("*:file:_files");
    cases += " ;;\n";
  }
  std::string own;
  for (const Described& option : options_of(program))
    for (const std::string& name : names_of(option))
      own += " " + single_quoted(filled("{}[{}]", name, described(option.meaning)));
  return filled(R"(#compdef impact-damper
# zsh completion for impact-damper, by: impact-damper generate zsh
_impact_damper() {
  local context state state_descr line curcontext=$curcontext
  typeset -A opt_args
  local -a commands=(
{}  )
  _arguments -C{} '1: :->command' '*:: :->rest'
  case $state in
    command) _describe command commands; return ;;
    rest) ;;
    *) return ;;
  esac
  case $line[1] in
{}  esac
}
if [ "$funcstack[1]" = _impact-damper ]; then
  _impact_damper "$@"
else
  compdef _impact_damper impact-damper
fi
)",
                described_commands, own, cases);
}

std::string fish_completion(const Command& program, const Commands& commands) {
  const auto fish_quoted = [](const std::string& text) { return "'" + escaped(text, "'\\", "\\") + "'"; };
  const auto line = [&](const std::string& when, const Described& option) {
    std::string text = "complete -c impact-damper -n " + fish_quoted(when);
    for (const std::string& name : option.shorts) text += " -s " + name;
    for (const std::string& name : option.longs) text += " -l " + name;
    const std::vector<std::string_view> words = choices(option);
    if (!words.empty())
      text += " -x -a " + fish_quoted(joined(words, " "));
    else if (option.takes_value)
      text += " -r";
    return text + " -d " + fish_quoted(brief(option.meaning)) + "\n";
  };
  std::string text = "# fish completion for impact-damper, by: impact-damper generate fish\n";
  for (const Described& option : options_of(program)) text += line("__fish_use_subcommand", option);
  for (const Command& command : commands) {
    const std::string name = command.name;
    text += "complete -c impact-damper -n __fish_use_subcommand -f -a " + name + " -d " +
            fish_quoted(command.description) + "\n";
    for (const Described& option : options_of(command))
      if (option.positional.empty() || !choices(option).empty())
        text += line("__fish_seen_subcommand_from " + name, option);
  }
  return text;
}

int generate(const Command& program, const Commands& commands, Arguments& arguments) {
  const std::optional<std::size_t> kind = arguments.required_word("KIND", {"man", "bash", "zsh", "fish"});
  arguments.finish();
  write_standard_output(*kind == 0   ? man_page(program, commands)
                        : *kind == 1 ? bash_completion(program, commands)
                        : *kind == 2 ? zsh_completion(program, commands)
                                     : fish_completion(program, commands));
  return 0;
}

}  // namespace

Command generate_command(const Command& program, const Commands& commands) {
  return {.name = "generate",
          .description = "Print the man page, or a shell's completions, of this program.",
          .options = {{"KIND", "man|bash|zsh|fish", "man, bash, zsh or fish"}},
          .footer = R"(make install puts all four in place.

Examples:
  impact-damper generate man | man -l -
  . <(impact-damper generate bash))",
          .act = [&](Arguments& arguments) { return generate(program, commands, arguments); }};
}

}  // namespace impact_damper::cli
