#include "manual/completions.hpp"

namespace nendo::manual {
namespace {

/// What the script is made of, gathered from all commands.
struct Cases {
  std::string paths;  ///< "nendo udev"|"nendo udev bind"
  std::string values; ///< which words follow an option
  std::string words;  ///< which words belong to a command
};

std::string quoted(const std::string& text) {
  return '"' + text + '"';
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : " ") + word;
  return text;
}

void gather(const cli::CommandModel& command, const std::string& path, Cases& cases) {
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
      patterns += (patterns.empty() ? "" : "|") + quoted(path + ' ' + name);
    }
    if (option.value.empty()) continue;
    cases.values += "    " + patterns + ") words=" + quoted(joined(option.choices)) + " ;;\n";
  }
  for (const cli::CommandModel& inner : command.commands) {
    others.push_back(inner.name);
    const std::string inner_path = path + ' ' + inner.name;
    cases.paths += (cases.paths.empty() ? "" : "|") + quoted(inner_path);
    gather(inner, inner_path, cases);
  }
  cases.words += "    " + quoted(path) + ") options=" + quoted(joined(options)) +
                 " words=" + quoted(joined(others)) + " ;;\n";
}

} // namespace

std::string bash_completion(const cli::CommandModel& program) {
  Cases cases;
  gather(program, "nendo", cases);
  // Where nothing fits, complete -o default gives file names.
  return "# Completion of nendo for bash. Made by nendo from its own --help.\n"
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

} // namespace nendo::manual
