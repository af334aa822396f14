#include "manual/completions.hpp"

namespace nendo::manual {
namespace {

std::string in_quotes(const std::string& text) {
  std::string out = "'";
  for (const char c : text.substr(0, text.find('\n'))) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + '\'';
}

std::string option_line(const cli::OptionModel& option, const std::string& where) {
  std::string choices;
  for (const std::string& choice : option.choices)
    choices += (choices.empty() ? "" : " ") + choice;
  std::string line = "complete -c nendo" + where;
  for (const std::string& name : option.names) {
    if (name.starts_with("--")) {
      line += " -l " + name.substr(2);
    } else if (name.starts_with('-')) {
      line += " -s " + name.substr(1);
    }
  }
  if (!choices.empty()) {
    line += (option.is_positional() ? " -f -a " : " -x -a ") + in_quotes(choices);
  } else if (!option.is_positional() && !option.value.empty()) {
    line += " -r";
  }
  return line + " -d " + in_quotes(option.summary) + '\n';
}

/// `seen` is a condition: the words before this command's own are there.
void add(const cli::CommandModel& command, const std::string& seen, std::string& text) {
  std::string inner_names;
  for (const cli::CommandModel& inner : command.commands)
    inner_names += ' ' + inner.name;
  const std::string here =
      inner_names.empty() ? seen : seen + "; and not __fish_seen_subcommand_from" + inner_names;
  for (const cli::CommandModel& inner : command.commands) {
    text += "complete -c nendo -n " + in_quotes(here) + " -f -a " + inner.name + " -d " +
            in_quotes(inner.summary) + '\n';
  }
  for (const cli::OptionModel& option : command.options) {
    if (!option.is_positional() || !option.choices.empty())
      text += option_line(option, " -n " + in_quotes(here));
  }
  for (const cli::CommandModel& inner : command.commands)
    add(inner, seen + "; and __fish_seen_subcommand_from " + inner.name, text);
}

} // namespace

std::string fish_completion(const cli::CommandModel& program) {
  std::string text = "# Completion of nendo for fish. Made by nendo from its own --help.\n";
  add(program, "true", text);
  return text;
}

} // namespace nendo::manual
