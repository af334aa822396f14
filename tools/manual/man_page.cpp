#include "manual/man_page.hpp"

#include <algorithm>
#include <cctype>

namespace nendo::manual {
namespace {

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// Returns the text such that roff prints it as it is: with hyphens that can be copied into a
/// shell, and without backslashes or requests at the beginnings of lines.
std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
      out += c;
    }
  }
  return out;
}

std::string bold(const std::string& text) {
  return "\\fB" + plain(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI" + plain(text) + "\\fR";
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

/// Returns a text as paragraphs. Lines that begin with blanks are a table and stay as they are; the
/// others flow.
std::string prose(const std::string& text) {
  std::string out;
  bool table = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    if (line.empty()) continue;
    const bool indented = line.starts_with(' ');
    if (indented != table) out += indented ? ".PP\n.nf\n" : ".fi\n.PP\n";
    table = indented;
    out += plain(line) + '\n';
  }
  return table ? out + ".fi\n" : out;
}

std::string item(const cli::OptionModel& option) {
  std::string text = ".TP\n";
  for (const std::string& name : option.names)
    text += (&name == &option.names.front() ? "" : ", ") +
            (option.is_positional() ? italic(name) : bold(name));
  if (!option.is_positional() && !option.value.empty()) text += ' ' + italic(option.value);
  if (option.repeats) text += " ...";
  text += '\n' + plain(option.summary) + ".\n";
  std::string choices;
  for (const std::string& choice : option.choices)
    choices += (choices.empty() ? "" : ", ") + bold(choice);
  if (!choices.empty()) text += "One of " + choices + ".\n";
  if (!option.default_value.empty()) text += "Default: " + bold(option.default_value) + ".\n";
  if (option.required) text += "Required.\n";
  return text;
}

/// Returns all options by heading, in the order in which the headings first appear.
std::string items(const cli::CommandModel& command) {
  std::vector<std::string> headings;
  for (const cli::OptionModel& option : command.options) {
    if (std::find(headings.begin(), headings.end(), option.heading) == headings.end())
      headings.push_back(option.heading);
  }
  std::string text;
  for (const std::string& heading : headings) {
    if (!heading.empty()) text += ".SS " + plain(heading) + '\n';
    for (const cli::OptionModel& option : command.options) {
      if (option.heading == heading) text += item(option);
    }
  }
  return text;
}

/// Returns the line of usage. `path` has the words before the options: "nendo udev bind".
std::string usage(const std::string& path, const cli::CommandModel& command) {
  std::string text = bold(path) + " [" + italic("OPTIONS") + "]";
  for (const cli::OptionModel& option : command.options) {
    if (!option.is_positional()) continue;
    const std::string word = italic(option.names.front()) + (option.repeats ? "..." : "");
    text += option.required ? ' ' + word : " [" + word + ']';
  }
  if (!command.commands.empty()) text += ' ' + italic("COMMAND");
  return text + '\n';
}

std::string head(const std::string& page, const std::string& summary, const PageOrigin& origin) {
  return ".\\\" nendo-manual made this page from the program's --help.\n.TH " + plain(upper(page)) +
         " 1 " + origin.date + " \"nendo " + origin.version + "\" \"User Commands\"\n.SH NAME\n" +
         plain(page) + " \\- " + plain(summary) + "\n.SH SYNOPSIS\n";
}

/// Returns the section of the exit codes, which the program's summary has below its first line.
std::string exit_status(const cli::CommandModel& program) {
  const std::size_t line = program.summary.find('\n');
  return line == std::string::npos ? std::string{}
                                   : ".SH EXIT STATUS\n" + prose(program.summary.substr(line + 1));
}

} // namespace

std::string program_page(const cli::CommandModel& program, const PageOrigin& origin) {
  std::string summary = first_line(program.summary);
  summary.erase(0, summary.find(": ") + 2); // the name is before it
  while (summary.ends_with('.'))
    summary.pop_back();
  std::string text = head("nendo", summary, origin) + usage("nendo", program) + ".SH COMMANDS\n";
  for (const cli::CommandModel& command : program.commands)
    text += ".TP\n" + bold("nendo-" + command.name) + "(1)\n" + plain(first_line(command.summary)) +
            ".\n";
  text += ".SH OPTIONS\n" + items(program) + exit_status(program) + ".SH SEE ALSO\n";
  for (const cli::CommandModel& command : program.commands) {
    const bool last = &command == &program.commands.back();
    text += ".BR nendo\\-" + command.name + " (1)" + (last ? "\n" : ",\n");
  }
  return text;
}

std::string command_page(const cli::CommandModel& program, const cli::CommandModel& command,
                         const PageOrigin& origin) {
  const std::string path = "nendo " + command.name;
  std::string text =
      head("nendo-" + command.name, first_line(command.summary), origin) + usage(path, command);
  for (const cli::CommandModel& inner : command.commands)
    text += ".br\n" + usage(path + ' ' + inner.name, inner);
  if (!command.footer.empty()) text += ".SH DESCRIPTION\n" + prose(command.footer);
  text += ".SH OPTIONS\n" + items(command);
  if (!command.commands.empty()) text += ".SH COMMANDS\n";
  for (const cli::CommandModel& inner : command.commands) {
    text +=
        ".SS " + plain(path + ' ' + inner.name) + '\n' + plain(first_line(inner.summary)) + ".\n";
    if (inner.footer != command.footer) text += prose(inner.footer); // else inherited
    for (const cli::OptionModel& option : inner.options)
      text += item(option);
  }
  return text + exit_status(program) + ".SH SEE ALSO\n.BR nendo (1)\n";
}

} // namespace nendo::manual
