#pragma once
// A command of the program and what may be said after its name. CLI11 stands behind it in one
// source file, because its headers take longer to compile than any command.

#include <functional>
#include <initializer_list>
#include <string>

#include "cli/command_model.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): theirs
class App;
class Option;
} // namespace CLI

namespace nendo::cli {

/// One option, while it is being described.
class Option {
public:
  explicit Option(CLI::Option& option) noexcept : option_(&option) {}

  Option& required();
  /// The heading of --help under which it stands.
  Option& under(const std::string& heading);
  Option& one_of(std::initializer_list<const char*> words);
  /// Each use of it takes one value, which --help calls `type`; without this, a list takes all that
  /// follow.
  Option& once_each(const std::string& type);

private:
  CLI::Option* option_;
};

/// A command, or the program itself. A copy is the same command.
class Command {
public:
  /// `chosen` takes what on_chosen() was given. Both must outlive this.
  Command(CLI::App& app, std::function<int()>& chosen) noexcept : app_(&app), chosen_(&chosen) {}

  Command add_command(const std::string& name, const std::string& summary);
  /// `value` must outlive parsing; what it holds is the default, shown by --help unless it is empty
  /// or zero. A name without dashes is a positional argument. T: string, double, a whole number, an
  /// optional or a list of strings, as command.cpp instantiates.
  template <class T>
  Option add_option(const std::string& names, T& value, const std::string& summary);
  Option add_flag(const std::string& names, bool& value, const std::string& summary);
  /// -h may then be another option's; --help stays.
  void free_short_help();
  /// The text after the options in --help.
  void set_footer(const std::string& text);
  /// Has `command` run when this one is chosen; what it returns becomes the exit code.
  void on_chosen(std::function<int()> command);
  /// It does nothing by itself: one of its commands must follow.
  void require_command();
  /// It is in no list of commands: not for users.
  void hide();
  /// All that was described so far, as --help says it.
  CommandModel model() const;

private:
  CLI::App* app_;
  std::function<int()>* chosen_;
};

/// Describes the program by `add_commands`, runs what the arguments choose, and returns the exit
/// code. Wrong usage is one line on standard error.
int run_program(int argc, char** argv, const std::string& summary,
                const std::function<void(Command&)>& add_commands);

} // namespace nendo::cli
