#include "manual/completions.hpp"

namespace nendo::manual {
namespace {

/// Inside '...' and, for _arguments and _describe, where : [ ] have a meaning.
std::string described(const std::string& text) {
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

/// ":TEXT:_files" or ":TEXT:(a b)".
std::string value_of(const cli::OptionModel& option) {
  std::string choices;
  for (const std::string& choice : option.choices)
    choices += (choices.empty() ? "" : " ") + choice;
  return ':' + option.value + ':' + (choices.empty() ? "_files" : '(' + choices + ')');
}

std::string arguments(const cli::CommandModel& command) {
  std::string text;
  for (const cli::OptionModel& option : command.options) {
    if (option.is_positional()) {
      text += " \\\n    ':" + option.names.front() +
              value_of(option).substr(option.value.size() + 1) + '\'';
      continue;
    }
    for (const std::string& name : option.names) {
      text += " \\\n    '" + std::string(option.repeats ? "*" : "") + name + '[' +
              described(option.summary) + ']' + (option.value.empty() ? "" : value_of(option)) +
              '\'';
    }
  }
  return text;
}

void add_function(const cli::CommandModel& command, const std::string& name, std::string& text) {
  for (const cli::CommandModel& inner : command.commands)
    add_function(inner, name + '_' + inner.name, text);
  text += name + "() {\n";
  if (!command.commands.empty()) {
    text += "  local -a commands=(\n";
    for (const cli::CommandModel& inner : command.commands)
      text += "    '" + inner.name + ':' + described(inner.summary) + "'\n";
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
  text += "  _arguments" + arguments(command) + "\n}\n";
}

} // namespace

std::string zsh_completion(const cli::CommandModel& program) {
  std::string text = "#compdef nendo\n# Made by nendo from its own --help.\n";
  add_function(program, "_nendo", text);
  return text + "_nendo \"$@\"\n";
}

} // namespace nendo::manual
