#include "manual/completions.hpp"

#include "cli/figures.hpp"

namespace nendo::manual {
namespace {

/// The parts of the script, gathered from all commands.
struct BashCases {
  std::string paths;  ///< "nendo udev"|"nendo udev bind"
  std::string values; ///< the words that may follow an option
  std::string words;  ///< the words that belong to a command
};

std::string bash_quoted(const std::string& text) {
  return '"' + text + '"';
}

void gather_bash_cases(const cli::CommandModel& command, const std::string& path,
                       BashCases& cases) {
  std::vector<std::string> options;
  std::vector<std::string> others;
  for (const cli::OptionModel& option : command.options) {
    if (option.is_positional()) {
      others.insert(others.end(), option.choices.begin(), option.choices.end());
      continue;
    }
    std::string patterns;
    for (const std::string& name : option.names) {
      options.push_back(name);
      patterns += (patterns.empty() ? "" : "|") + bash_quoted(path + ' ' + name);
    }
    if (option.value.empty()) continue;
    cases.values +=
        "    " + patterns + ") words=" + bash_quoted(cli::joined(option.choices, " ")) + " ;;\n";
  }
  for (const cli::CommandModel& inner : command.commands) {
    others.push_back(inner.name);
    const std::string inner_path = path + ' ' + inner.name;
    cases.paths += (cases.paths.empty() ? "" : "|") + bash_quoted(inner_path);
    gather_bash_cases(inner, inner_path, cases);
  }
  cases.words += "    " + bash_quoted(path) +
                 ") options=" + bash_quoted(cli::joined(options, " ")) +
                 " words=" + bash_quoted(cli::joined(others, " ")) + " ;;\n";
}

/// Returns the first line of a text, escaped for single quotes and for _arguments and _describe, to
/// which : [ ] have a meaning.
std::string zsh_escaped(const std::string& text) {
  std::string out;
  for (const char c : text.substr(0, text.find('\n'))) {
    if (c == '\'') {
      out += "'\\''";
    } else {
      if (c == ':' || c == '[' || c == ']' || c == '\\') out += '\\';
      out += c;
    }
  }
  return out;
}

/// Returns ":TEXT:_files" or ":TEXT:(a b)".
std::string zsh_value(const cli::OptionModel& option) {
  return ':' + option.value + ':' +
         (option.choices.empty() ? "_files" : '(' + cli::joined(option.choices, " ") + ')');
}

std::string zsh_arguments(const cli::CommandModel& command) {
  std::string text;
  for (const cli::OptionModel& option : command.options) {
    if (option.is_positional()) {
      text += " \\\n    ':" + option.names.front() +
              zsh_value(option).substr(option.value.size() + 1) + '\'';
      continue;
    }
    for (const std::string& name : option.names) {
      text += " \\\n    '" + std::string(option.repeats ? "*" : "") + name + '[' +
              zsh_escaped(option.summary) + ']' + (option.value.empty() ? "" : zsh_value(option)) +
              '\'';
    }
  }
  return text;
}

void add_zsh_function(const cli::CommandModel& command, const std::string& name,
                      std::string& text) {
  for (const cli::CommandModel& inner : command.commands)
    add_zsh_function(inner, name + '_' + inner.name, text);
  text += name + "() {\n";
  if (!command.commands.empty()) {
    text += "  local -a commands=(\n";
    for (const cli::CommandModel& inner : command.commands)
      text += "    '" + inner.name + ':' + zsh_escaped(inner.summary) + "'\n";
    text += "  )\n"
            "  if ((CURRENT > 2)) && [[ -n ${commands[(r)$words[2]:*]} ]]; then\n"
            "    local inner=" +
            name +
            "_$words[2]\n"
            "    shift words\n"
            "    ((CURRENT--))\n"
            "    $inner\n"
            "    return\n"
            "  fi\n"
            "  [[ $words[CURRENT] == -* ]] || _describe command commands\n";
  }
  text += "  _arguments" + zsh_arguments(command) + "\n}\n";
}

std::string fish_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text.substr(0, text.find('\n'))) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + '\'';
}

std::string option_line(const cli::OptionModel& option, const std::string& where) {
  std::string line = "complete -c nendo" + where;
  for (const std::string& name : option.names) {
    if (name.starts_with("--")) {
      line += " -l " + name.substr(2);
    } else if (name.starts_with('-')) {
      line += " -s " + name.substr(1);
    }
  }
  if (!option.choices.empty()) {
    line += (option.is_positional() ? " -f -a " : " -x -a ") +
            fish_quoted(cli::joined(option.choices, " "));
  } else if (!option.is_positional() && !option.value.empty()) {
    line += " -r";
  }
  return line + " -d " + fish_quoted(option.summary) + '\n';
}

/// `seen` is the condition that the words before this command's own are there.
void add_fish_lines(const cli::CommandModel& command, const std::string& seen, std::string& text) {
  std::string inner_names;
  for (const cli::CommandModel& inner : command.commands)
    inner_names += ' ' + inner.name;
  const std::string here =
      inner_names.empty() ? seen : seen + "; and not __fish_seen_subcommand_from" + inner_names;
  for (const cli::CommandModel& inner : command.commands) {
    text += "complete -c nendo -n " + fish_quoted(here) + " -f -a " + inner.name + " -d " +
            fish_quoted(inner.summary) + '\n';
  }
  for (const cli::OptionModel& option : command.options) {
    if (!option.is_positional() || !option.choices.empty())
      text += option_line(option, " -n " + fish_quoted(here));
  }
  for (const cli::CommandModel& inner : command.commands)
    add_fish_lines(inner, seen + "; and __fish_seen_subcommand_from " + inner.name, text);
}

} // namespace

std::string bash_completion(const cli::CommandModel& program) {
  BashCases cases;
  gather_bash_cases(program, "nendo", cases);
  // Where nothing fits, complete -o default gives file names.
  return "# Completion of nendo for bash, which nendo-manual made from the program's --help.\n"
         "_nendo() {\n"
         "  local now=${COMP_WORDS[COMP_CWORD]} path=nendo options= words= at\n"
         "  for ((at = 1; at < COMP_CWORD; ++at)); do\n"
         "    case \"$path ${COMP_WORDS[at]}\" in\n"
         "    " +
         cases.paths +
         ") path+=\" ${COMP_WORDS[at]}\" ;;\n"
         "    esac\n"
         "  done\n"
         "  case \"$path ${COMP_WORDS[COMP_CWORD-1]}\" in\n" +
         cases.values +
         "  *)\n"
         "    case $path in\n" +
         cases.words +
         "    esac\n"
         "    [[ $now != -* ]] || words=$options\n"
         "    ;;\n"
         "  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$now\")\n"
         "}\n"
         "complete -o default -F _nendo nendo\n";
}

std::string zsh_completion(const cli::CommandModel& program) {
  std::string text = "#compdef nendo\n# Completion of nendo for zsh, which nendo-manual made from "
                     "the program's --help.\n";
  add_zsh_function(program, "_nendo", text);
  return text + "_nendo \"$@\"\n";
}

std::string fish_completion(const cli::CommandModel& program) {
  std::string text =
      "# Completion of nendo for fish, which nendo-manual made from the program's --help.\n";
  add_fish_lines(program, "true", text);
  return text;
}

} // namespace nendo::manual
