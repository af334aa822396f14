#include "cli/command.hpp"

#include <cstdint>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <nendo/base/result.hpp>
#include <nendo/base/text.hpp>
#include <nendo/version.hpp>

#include "cli/cli.hpp"
#include "cli/nearest_word.hpp"
#include "cli/quantities.hpp"
#include "cli/standard_output.hpp"

namespace nendo::cli {
namespace {

/// Returns whether a value is empty or zero. --help does not show it as a default then.
template <class T>
bool is_blank(const T& value) {
  if constexpr (std::is_arithmetic_v<T>) {
    return value == T{};
  } else if constexpr (requires { value.has_value(); }) {
    return !value.has_value();
  } else {
    return value.empty();
  }
}

// CLI11 reads a whole number as strtoull does, to which -3 is 18446744073709551613.
std::string not_negative(const std::string& text) {
  return text.find('-') == std::string::npos ? "" : text + ": use a whole number, 0 or above";
}

std::string short_text(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

std::optional<double> millimetres_of(std::string_view text) noexcept {
  if (const auto length_m = to_metres(text)) return 1e3 * *length_m;
  return number_of(text);
}

/// A number with a unit, or without: then it has the unit that --help shows.
struct Quantity {
  std::optional<double> (*read)(std::string_view text) noexcept;
  std::string_view words; ///< what may be typed
  const char* type;
  const char* unit; ///< of the default
};

template <class T>
CLI::Option* add_quantity(CLI::App& app, const std::string& names, T& value,
                          const std::string& summary, const Quantity& quantity) {
  const auto take = [&value, read = quantity.read](const std::string& text) {
    value = *read(text); // the check has passed
  };
  CLI::Option* option = app.add_option_function<std::string>(names, take, summary);
  option->check([quantity](const std::string& text) {
    return quantity.read(text) ? std::string() : text + ": use " + std::string(quantity.words);
  });
  option->type_name(quantity.type);
  if constexpr (std::is_same_v<T, double>) {
    if (!is_blank(value)) option->default_str(short_text(value) + quantity.unit);
  }
  return option;
}

/// Returns the words in a type like "TEXT:{left,right}", as CLI11 writes the choices of one_of().
std::vector<std::string> choices_in(const std::string& type) {
  std::vector<std::string> choices;
  const std::size_t open = type.find('{');
  if (open == std::string::npos) return choices;
  std::istringstream words(type.substr(open + 1, type.find('}') - open - 1));
  for (std::string word; std::getline(words, word, ',');)
    choices.push_back(word);
  return choices;
}

OptionModel nameless_model_of(const CLI::Option& option) {
  OptionModel model;
  if (option.get_type_size() != 0) {
    const std::string type = option.get_type_name();
    model.value = type.substr(0, type.find(':'));
    model.choices = choices_in(type);
    model.default_value = option.get_default_str();
    model.required = option.get_required();
    model.repeats = option.get_expected_max() == CLI::detail::expected_max_vector_size;
  }
  model.summary = option.get_description();
  if (option.get_group() != "Options") model.heading = option.get_group();
  return model;
}

/// Adds the model of an option. An option that may also be given by its place alone becomes two, as
/// in --help.
void add_models_of(const CLI::Option& option, std::vector<OptionModel>& models) {
  OptionModel model = nameless_model_of(option);
  if (option.get_positional()) {
    models.push_back(model);
    models.back().names.push_back(option.get_name(true));
  }
  for (const std::string& name : option.get_snames())
    model.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames())
    model.names.push_back("--" + name);
  if (!model.names.empty()) models.push_back(std::move(model));
}

CommandModel model_of(const CLI::App& app) {
  CommandModel model{app.get_name(), app.get_description(), app.get_footer(), {}, {}};
  for (const CLI::Option* option : app.get_options())
    add_models_of(*option, model.options);
  for (const CLI::App* command : app.get_subcommands({}))
    model.commands.push_back(model_of(*command));
  return model;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* command : app.get_subcommands({}))
    names.push_back(command->get_name());
  return names;
}

std::string names_of_commands(const CLI::App& app) {
  std::string known;
  for (const std::string& name : command_names(app))
    known += (known.empty() ? "" : ", ") + name;
  return known;
}

const CLI::App& chosen_command(const CLI::App& program) {
  const CLI::App* at = &program;
  while (!at->get_subcommands().empty())
    at = at->get_subcommands().front();
  return *at;
}

/// Says what is wrong with the first argument that no option of the chosen command takes.
std::string unexpected(const CLI::App& program) {
  const CLI::App& command = chosen_command(program);
  const std::vector<std::string> extras = program.remaining(true);
  if (extras.empty()) return "an argument was not expected";
  const std::string name = extras.front().substr(0, extras.front().find('='));
  if (!name.starts_with('-')) return name + ": not expected";
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& each : option->get_lnames())
      known.push_back("--" + each);
  const std::string meant = nearest_word(name, known);
  return "no option " + name + (meant.empty() ? "" : "; did you mean " + meant + "?");
}

/// Tells a word in place of a command, which --help behind it would hide: help ends the parsing.
std::optional<std::string> unknown_command(CLI::App& program, int argc, char** argv) {
  const CLI::App* at = &program;
  std::string path = "nendo";
  for (int word = 1; word < argc; ++word) {
    const std::string name = argv[word];
    if (name.empty() || name.starts_with('-') || at->get_subcommands({}).empty()) break;
    const auto named =
        at->get_subcommands([&](const CLI::App* command) { return command->get_name() == name; });
    if (named.empty()) {
      const std::string meant = nearest_word(name, command_names(*at));
      return "no command " + name + "; " +
             (meant.empty() ? "there are " + names_of_commands(*at)
                            : "did you mean " + meant + "?") +
             " (see " + path + " --help)";
    }
    at = named.front();
    path += ' ' + name;
  }
  return std::nullopt;
}

int report_usage(const CLI::App& app, const std::string& first_word, const std::string& what) {
  std::string chosen;
  for (const CLI::App* at = &app; !at->get_subcommands().empty();) {
    at = at->get_subcommands().front();
    chosen += at->get_name() + ' ';
  }
  if (!chosen.empty()) {
    std::cerr << "nendo: " << what << " (see nendo " << chosen << "--help)\n";
  } else if (first_word.starts_with('-')) {
    std::cerr << "nendo: " << what << " (see nendo --help)\n";
  } else {
    std::cerr << "nendo: say what to do; there are " << names_of_commands(app)
              << " (see nendo --help)\n";
  }
  return static_cast<int>(Errc::usage);
}

} // namespace

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::under(const std::string& heading) {
  option_->group(heading);
  return *this;
}

Option& Option::one_of(std::initializer_list<const char*> words) {
  option_->check(CLI::IsMember(std::vector<std::string>(words.begin(), words.end())));
  return *this;
}

Option& Option::once_each(const std::string& type) {
  option_->type_name(type)->allow_extra_args(false);
  return *this;
}

Command Command::add_command(const std::string& name, const std::string& summary) {
  return Command(*app_->add_subcommand(name, summary), *chosen_);
}

template <class T>
Option Command::add_option(const std::string& names, T& value, const std::string& summary) {
  CLI::Option* option = app_->add_option(names, value, summary);
  if (!is_blank(value)) option->capture_default_str();
  if constexpr (std::is_unsigned_v<T>) option->check(not_negative);
  return Option(*option);
}

template Option Command::add_option(const std::string&, std::string&, const std::string&);
template Option Command::add_option(const std::string&, double&, const std::string&);
template Option Command::add_option(const std::string&, std::uint32_t&, const std::string&);
template Option Command::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option Command::add_option(const std::string&, std::optional<unsigned>&,
                                    const std::string&);
template Option Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option Command::add_option(const std::string&, std::vector<std::string>&,
                                    const std::string&);

template <class T>
Option Command::add_duration(const std::string& names, T& seconds, const std::string& summary) {
  return Option(
      *add_quantity(*app_, names, seconds, summary, {seconds_of, duration_words, "TIME", "s"}));
}

template Option Command::add_duration(const std::string&, double&, const std::string&);
template Option Command::add_duration(const std::string&, std::optional<double>&,
                                      const std::string&);

template <class T>
Option Command::add_millimetres(const std::string& names, T& length_mm,
                                const std::string& summary) {
  return Option(*add_quantity(*app_, names, length_mm, summary,
                              {millimetres_of, millimetre_words, "LENGTH", "mm"}));
}

template Option Command::add_millimetres(const std::string&, double&, const std::string&);
template Option Command::add_millimetres(const std::string&, std::optional<double>&,
                                         const std::string&);

template <class T>
Option Command::add_microseconds(const std::string& names, T& time_us, const std::string& summary) {
  return Option(*add_quantity(*app_, names, time_us, summary,
                              {microseconds_of, microsecond_words, "TIME", "us"}));
}

template Option Command::add_microseconds(const std::string&, double&, const std::string&);
template Option Command::add_microseconds(const std::string&, std::optional<double>&,
                                          const std::string&);

template <class T>
Option Command::add_rate(const std::string& names, T& rate_hz, const std::string& summary) {
  return Option(
      *add_quantity(*app_, names, rate_hz, summary, {hertz_of, rate_words, "RATE", "Hz"}));
}

template Option Command::add_rate(const std::string&, double&, const std::string&);
template Option Command::add_rate(const std::string&, std::optional<double>&, const std::string&);

Option Command::add_flag(const std::string& names, bool& value, const std::string& summary) {
  return Option(*app_->add_flag(names, value, summary));
}

std::string Command::first_given(const std::vector<std::string>& names) const {
  for (const std::string& name : names)
    if (const CLI::Option* option = app_->get_option_no_throw(name);
        option != nullptr && option->count() > 0)
      return name;
  return {};
}

void Command::free_short_help() {
  app_->set_help_flag("--help", "Print this help message and exit");
}

void Command::set_footer(const std::string& text) {
  app_->footer(text);
}

void Command::on_chosen(std::function<int()> command) {
  app_->callback([chosen = chosen_, command = std::move(command)] { *chosen = command; });
}

void Command::require_command() {
  app_->require_subcommand(1);
}

CommandModel describe_program(const std::string& summary,
                              const std::function<void(Command&)>& add_commands) {
  CLI::App app{summary};
  std::function<int()> chosen;
  Command program(app, chosen);
  add_commands(program);
  return model_of(app);
}

int run_program(int argc, char** argv, const std::string& summary,
                const std::function<void(Command&)>& add_commands) {
  StandardOutput output;
  CLI::App app{summary};
  app.set_version_flag("--version", NENDO_VERSION);
  app.get_formatter()->column_width(34);
  std::function<int()> chosen;
  Command program(app, chosen);
  program.require_command();
  add_commands(program);
  if (const auto unknown = unknown_command(app, argc, argv)) return report({Errc::usage, *unknown});
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return output.finish(app.exit(help));
  } catch (const CLI::ExtrasError&) {
    return report_usage(app, argc > 1 ? argv[1] : "", unexpected(app));
  } catch (const CLI::ParseError& error) {
    return report_usage(app, argc > 1 ? argv[1] : "", error.what());
  }
  return output.finish(chosen());
}

} // namespace nendo::cli
