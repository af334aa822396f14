#pragma once
// A command of the program, with the arguments that may follow its name. Only one source file uses
// CLI11 for it, because CLI11's headers take longer to compile than any command.

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

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
  /// Puts the option under this heading of --help.
  Option& under(const std::string& heading);
  Option& one_of(std::initializer_list<const char*> words);
  /// Lets each use of the option take one value, which --help calls `type`. Otherwise a list takes
  /// all values that follow.
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
  /// Adds an option. `value` must outlive parsing; what it holds is the default, which --help shows
  /// unless it is empty or zero. A name without dashes is a positional argument. T is string,
  /// double, a whole number, an optional, or a list of strings, as command.cpp instantiates.
  template <class T>
  Option add_option(const std::string& names, T& value, const std::string& summary);
  /// Adds an option whose value is a duration, such as 90s (quantities.hpp), in seconds. T is
  /// double or an optional of it.
  template <class T>
  Option add_duration(const std::string& names, T& seconds, const std::string& summary);
  /// Adds an option whose value is a length, such as 18.5cm, in millimetres. A bare number is
  /// millimetres. T is as for add_duration().
  template <class T>
  Option add_millimetres(const std::string& names, T& length_mm, const std::string& summary);
  /// Adds an option whose value is a short time, such as 1ms, in microseconds, or a rate, such as
  /// 90Hz, in hertz. A bare number is that. T is as for add_duration().
  template <class T>
  Option add_microseconds(const std::string& names, T& time_us, const std::string& summary);
  template <class T>
  Option add_rate(const std::string& names, T& rate_hz, const std::string& summary);
  Option add_flag(const std::string& names, bool& value, const std::string& summary);
  /// Lets another option have -h. --help stays.
  void free_short_help();
  /// Sets the text after the options in --help.
  void set_footer(const std::string& text);
  /// Sets the function that runs when this command is chosen. Its result becomes the exit code.
  void on_chosen(std::function<int()> command);
  /// Requires that one of its commands follows, since this one does nothing by itself.
  void require_command();
  /// Returns the first of these options, by one name of each, that the arguments have; empty: none.
  /// For the function of on_chosen().
  std::string first_given(const std::vector<std::string>& names) const;

private:
  CLI::App* app_;
  std::function<int()>* chosen_;
};

/// Returns everything that `add_commands` describes, as --help shows it.
CommandModel describe_program(const std::string& summary,
                              const std::function<void(Command&)>& add_commands);
/// Describes the program by `add_commands`, runs the command that the arguments choose, and returns
/// the exit code. Wrong usage prints one line on standard error.
int run_program(int argc, char** argv, const std::string& summary,
                const std::function<void(Command&)>& add_commands);

} // namespace nendo::cli
