#pragma once
// A command of the program, with its arguments. Only one source file includes CLI11, because its
// headers take longer to compile than any command.

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
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
  /// Each use of the option takes one value, named `type` in --help. By default, a list takes all
  /// values that follow.
  Option& once_each(const std::string& type);

private:
  CLI::Option* option_;
};

/// A command, or the program itself. Copies refer to the same command.
class Command {
public:
  /// on_chosen() sets `chosen`. Both must outlive this.
  Command(CLI::App& app, std::function<int()>& chosen) noexcept : app_(&app), chosen_(&chosen) {}

  Command add_command(const std::string& name, const std::string& summary);
  /// Returns the same command; its further options appear under this heading of --help.
  Command under(const std::string& heading) const;
  /// Adds an option. `value` must outlive parsing; its initial value is the default, which --help
  /// shows unless it is empty or zero. A name without dashes is a positional argument. T is string,
  /// double, an integer, an optional, or a list of strings, as command.cpp instantiates.
  template <class T>
  Option add_option(const std::string& names, T& value, const std::string& summary);
  /// Add an option for a number with a unit (quantities.hpp), such as 90s, 18.5cm, 1ms or 90Hz. A
  /// bare number is in seconds, millimetres, microseconds or hertz. T is double or an optional of
  /// it.
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
  /// Makes -h available for another option. --help stays.
  void free_short_help();
  /// Sets the text after the options in --help.
  void set_footer(const std::string& text);
  /// Sets the function that runs when this command is chosen. It returns the exit code, or an error
  /// to report.
  void on_chosen(std::function<int()> command);
  void on_chosen(std::function<Result<void>()> command);
  /// Does the same with a function of the command's options. Makes them, and returns them for the
  /// descriptions of their options.
  template <class Options, class Run>
  Options& on_chosen(Run run) {
    auto options = std::make_shared<Options>();
    on_chosen([options, run] { return run(*options); });
    return *options;
  }
  /// Requires one of its subcommands.
  void require_command();
  /// Returns the first of these options, each by one name, that was given; empty: none. For the
  /// function of on_chosen().
  std::string first_given(const std::vector<std::string>& names) const;
  /// Returns whether any option or argument was given. For the same function.
  bool has_arguments() const;

private:
  enum class Unit : std::uint8_t { s, mm, us, hz };
  template <class T>
  Option add_quantity(const std::string& names, T& value, const std::string& summary, Unit unit);

  Option described(CLI::Option& option) const;

  CLI::App* app_;
  std::function<int()>* chosen_;
  std::string heading_; ///< empty: "Options"
};

/// Returns the description that `add_commands` makes, as in --help.
CommandModel describe_program(const std::string& summary,
                              const std::function<void(Command&)>& add_commands);
/// Describes the program by `add_commands`, runs the chosen command, and returns the exit code. A
/// usage error prints one line on standard error.
int run_program(int argc, char** argv, const std::string& summary,
                const std::function<void(Command&)>& add_commands);

} // namespace nendo::cli
