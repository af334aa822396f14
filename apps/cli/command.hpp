#pragma once
// A command of the program, with the arguments that may follow its name. Only one source file uses
// CLI11 for it, because CLI11's headers take longer to compile than any command.

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

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
  /// Returns the same command, which puts further options under this heading of --help.
  Command under(const std::string& heading) const;
  /// Adds an option. `value` must outlive parsing; what it holds is the default, which --help shows
  /// unless it is empty or zero. A name without dashes is a positional argument. T is string,
  /// double, a whole number, an optional, or a list of strings, as command.cpp instantiates.
  template <class T>
  Option add_option(const std::string& names, T& value, const std::string& summary);
  /// Adds an option whose value is a number with a unit (quantities.hpp), or without: then it is in
  /// seconds, such as 90s, in millimetres, such as 18.5cm, in microseconds, such as 1ms, or in
  /// hertz, such as 90Hz. T is double or an optional of it.
  template <class T>
  Option add_duration(const std::string& names, T& seconds, const std::string& summary) {
    return add_quantity(names, seconds, summary, Unit::s);
  }
  template <class T>
  Option add_millimetres(const std::string& names, T& length_mm, const std::string& summary) {
    return add_quantity(names, length_mm, summary, Unit::mm);
  }
  template <class T>
  Option add_microseconds(const std::string& names, T& time_us, const std::string& summary) {
    return add_quantity(names, time_us, summary, Unit::us);
  }
  template <class T>
  Option add_rate(const std::string& names, T& rate_hz, const std::string& summary) {
    return add_quantity(names, rate_hz, summary, Unit::hz);
  }
  Option add_flag(const std::string& names, bool& value, const std::string& summary);
  /// Lets another option have -h. --help stays.
  void free_short_help();
  /// Sets the text after the options in --help.
  void set_footer(const std::string& text);
  /// Sets the function that runs when this command is chosen. It returns the exit code, or an
  /// error, which is then reported.
  void on_chosen(std::function<int()> command);
  void on_chosen(std::function<Result<void>()> command);
  /// Requires that one of its commands follows, since this one does nothing by itself.
  void require_command();
  /// Returns the first of these options, by one name of each, that the arguments have; empty: none.
  /// For the function of on_chosen().
  std::string first_given(const std::vector<std::string>& names) const;

private:
  enum class Unit : std::uint8_t { s, mm, us, hz };
  template <class T>
  Option add_quantity(const std::string& names, T& value, const std::string& summary, Unit unit);

  Option described(CLI::Option& option) const;

  CLI::App* app_;
  std::function<int()>* chosen_;
  std::string heading_; ///< empty: "Options"
};

/// Returns everything that `add_commands` describes, as --help shows it.
CommandModel describe_program(const std::string& summary,
                              const std::function<void(Command&)>& add_commands);
/// Describes the program by `add_commands`, runs the command that the arguments choose, and returns
/// the exit code. Wrong usage prints one line on standard error.
int run_program(int argc, char** argv, const std::string& summary,
                const std::function<void(Command&)>& add_commands);

} // namespace nendo::cli
