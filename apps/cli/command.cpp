#include "cli/command.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <ext/stdio_sync_filebuf.h>
#include <fcntl.h>
#include <poll.h>
#include <spdlog/fmt/fmt.h>
#include <sys/types.h>
#include <unistd.h>

#include <nendo/base/result.hpp>
#include <nendo/base/text.hpp>
#include <nendo/version.hpp>

#include "cli/cli.hpp"
#include "cli/figures.hpp"
#include "cli/nearest_word.hpp"
#include "cli/quantities.hpp"
#include "cli/run_main.hpp"

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

std::optional<double> millimetres_of(std::string_view text) noexcept {
  if (const auto length_m = to_metres(text)) return 1e3 * *length_m;
  return number_of(text);
}

/// A number with a unit, or without: then it has the unit that --help shows.
struct Quantity {
  std::optional<double> (*read)(std::string_view text) noexcept;
  std::string_view words; ///< the allowed forms
  const char* type;
  const char* unit; ///< the unit of the default
};

// In the order of Command::Unit.
constexpr std::array quantities{
    Quantity{seconds_of, duration_words, "TIME", "s"},
    Quantity{millimetres_of, "millimetres, or a length like 1mm, 0.5cm or 0.2m", "LENGTH", "mm"},
    Quantity{microseconds_of, "microseconds, or 250us, 1ms, 0.1s", "TIME", "us"},
    Quantity{hertz_of, "a rate like 90, 90Hz or 1kHz", "RATE", "Hz"}};

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

std::string list_of_commands(const CLI::App& app) {
  return "the commands are " + joined(command_names(app));
}

/// Returns the commands that the arguments chose, the program first.
std::vector<const CLI::App*> chosen_commands(const CLI::App& program) {
  std::vector<const CLI::App*> chosen{&program};
  while (!chosen.back()->get_subcommands().empty())
    chosen.push_back(chosen.back()->get_subcommands().front());
  return chosen;
}

/// Returns what is wrong with the first argument that no option of the chosen command takes.
std::string unexpected(const CLI::App& program) {
  const std::vector<std::string> extras = program.remaining(true);
  if (extras.empty()) return "an argument was not expected";
  const std::string name = extras.front().substr(0, extras.front().find('='));
  if (!name.starts_with('-')) return name + ": is not expected";
  std::vector<std::string> known;
  for (const CLI::Option* option : chosen_commands(program).back()->get_options())
    for (const std::string& each : option->get_lnames())
      known.push_back("--" + each);
  const std::string meant = nearest_word(name, known);
  return "no option " + name + (meant.empty() ? "" : "; did you mean " + meant + "?");
}

bool takes_arguments(const CLI::App& app) {
  const auto options = app.get_options();
  return std::any_of(options.begin(), options.end(),
                     [](const CLI::Option* option) { return option->get_positional(); });
}

/// Returns an error about a word that is neither a command nor an argument. A --help after it would
/// hide it, because help ends the parsing.
std::optional<std::string> unknown_command(CLI::App& program, int argc, char** argv) {
  const CLI::App* at = &program;
  std::string path(program_name());
  for (int word = 1; word < argc; ++word) {
    const std::string name = argv[word];
    if (name.empty() || name.starts_with('-') || at->get_subcommands({}).empty()) break;
    const auto named =
        at->get_subcommands([&](const CLI::App* command) { return command->get_name() == name; });
    if (named.empty() && takes_arguments(*at)) break;
    if (named.empty()) {
      const std::string meant = nearest_word(name, command_names(*at));
      return "no command " + name + "; " +
             (meant.empty() ? list_of_commands(*at) : "did you mean " + meant + "?") + " (see " +
             path + " --help)";
    }
    at = named.front();
    path += ' ' + name;
  }
  return std::nullopt;
}

int report_usage(const CLI::App& app, const std::string& first_word, const std::string& what) {
  const auto chosen = chosen_commands(app);
  std::string path;
  for (std::size_t at = 1; at < chosen.size(); ++at)
    path += chosen[at]->get_name() + ' ';
  const bool is_about_option = !path.empty() || first_word.starts_with('-');
  return report(
      {Errc::usage, (is_about_option ? what : "give a command; " + list_of_commands(app)) +
                        " (see " + std::string(program_name()) + ' ' + path + "--help)"});
}

// Where standard output was closed, the next file that is opened would get its number, and with it
// whatever is printed. Its replacement cannot be written to.
void fill_closed_descriptors() noexcept {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(fd, F_GETFD) < 0)
      static_cast<void>(::open("/dev/null", fd == STDOUT_FILENO ? O_RDONLY : O_RDWR));
}

/// Replaces std::cout and stdout while it lives, so that any lost output is noticed. The first
/// write that fails ends all output, and sets stop_requested(), so that commands without an end
/// stop. Interrupted writes continue, so that no line ends in its middle. Only one may live at a
/// time.
class StandardOutput {
public:
  StandardOutput() : stdout_before_(stdout) {
    fill_closed_descriptors();
    // glibc lets a program exchange stdout. Its own stdout would report that a write has failed,
    // but not why, and not at once.
    file_ = ::fopencookie(this, "w", {nullptr, &StandardOutput::write, nullptr, nullptr});
    if (file_ == nullptr) throw std::bad_alloc();
    std::setvbuf(file_, nullptr, ::isatty(STDOUT_FILENO) != 0 ? _IOLBF : _IOFBF, BUFSIZ);
    std::fflush(stdout);
    stdout = file_;
    buffer_ = std::make_unique<Unbuffered>(file_);
    buffer_before_ = std::cout.rdbuf(buffer_.get());
  }
  ~StandardOutput() {
    std::cout.rdbuf(buffer_before_);
    stdout = stdout_before_;
    std::fclose(file_);
  }
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  /// Flushes, and returns the program's exit code: `exit_code`, or, if that is 0, 1 if output was
  /// lost, which is then reported. If the reader has gone, as in `| head`, it is 141 without a
  /// message, as shells have for SIGPIPE; it stays 0 if a stop signal came first, because Ctrl-C
  /// ends both sides of a pipe.
  int finish(int exit_code) {
    std::fflush(file_);
    if (!failed_ || error_number_ == 0) return exit_code;
    if (error_number_ == EPIPE) return exit_code != 0 ? exit_code : 128 + SIGPIPE;
    const int lost = report({Errc::failed, "standard output cannot be written: " +
                                               std::generic_category().message(error_number_)});
    return exit_code != 0 ? exit_code : lost;
  }

private:
  /// Leaves the buffer to the FILE, so that std::cout and printf keep their order.
  using Unbuffered = __gnu_cxx::stdio_sync_filebuf<char>;

  static ssize_t write(void* self, const char* bytes, std::size_t size) {
    const bool written = static_cast<StandardOutput*>(self)->write_all(bytes, size);
    return written ? static_cast<ssize_t>(size) : 0; // 0 is an error for fopencookie
  }
  bool write_all(const char* bytes, std::size_t size) {
    while (size > 0 && !failed_) { // after a gap, nothing more would be of use
      const ssize_t written = ::write(STDOUT_FILENO, bytes, size);
      if (written >= 0) {
        bytes += written;
        size -= static_cast<std::size_t>(written);
      } else if (errno == EAGAIN) { // another program has made it so, and still has it
        pollfd output{STDOUT_FILENO, POLLOUT, 0};
        ::poll(&output, 1, -1);
      } else if (errno != EINTR) {
        fail(errno);
      }
    }
    return !failed_;
  }
  void fail(int error_number) noexcept {
    failed_ = true;
    const bool is_closed = error_number == EPIPE || error_number == EIO;
    if (!is_closed || !stop_requested()) error_number_ = error_number;
    request_stop();
  }

  std::FILE* file_; ///< passes all bytes to write()
  std::FILE* stdout_before_;
  std::unique_ptr<Unbuffered> buffer_; ///< passes the output of std::cout to `file_`
  std::streambuf* buffer_before_;
  bool failed_ = false;
  int error_number_ = 0; ///< the first error; 0: none that must be reported
};

} // namespace

Option& Option::required() {
  option_->required();
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

Command Command::under(const std::string& heading) const {
  Command section = *this;
  section.heading_ = heading;
  return section;
}

Option Command::described(CLI::Option& option) const {
  if (!heading_.empty()) option.group(heading_);
  return Option(option);
}

template <class T>
Option Command::add_option(const std::string& names, T& value, const std::string& summary) {
  CLI::Option* option = app_->add_option(names, value, summary);
  if (!is_blank(value)) option->capture_default_str();
  if constexpr (std::is_unsigned_v<T>) option->check(not_negative);
  return described(*option);
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
Option Command::add_quantity(const std::string& names, T& value, const std::string& summary,
                             Unit unit) {
  const Quantity quantity = quantities[static_cast<std::size_t>(unit)];
  const auto take = [&value, read = quantity.read](const std::string& text) {
    value = *read(text); // the check has passed
  };
  CLI::Option* option = app_->add_option_function<std::string>(names, take, summary);
  option->check([quantity](const std::string& text) {
    return quantity.read(text) ? std::string() : text + ": use " + std::string(quantity.words);
  });
  option->type_name(quantity.type);
  if constexpr (std::is_same_v<T, double>) {
    if (!is_blank(value)) option->default_str(fmt::format("{:g}{}", value, quantity.unit));
  }
  return described(*option);
}

template Option Command::add_quantity(const std::string&, double&, const std::string&, Unit);
template Option Command::add_quantity(const std::string&, std::optional<double>&,
                                      const std::string&, Unit);

Option Command::add_flag(const std::string& names, bool& value, const std::string& summary) {
  return described(*app_->add_flag(names, value, summary));
}

std::string Command::first_given(const std::vector<std::string>& names) const {
  for (const std::string& name : names)
    if (const CLI::Option* option = app_->get_option_no_throw(name);
        option != nullptr && option->count() > 0)
      return name;
  return {};
}

bool Command::has_arguments() const {
  const auto options = app_->get_options();
  return std::any_of(options.begin(), options.end(),
                     [](const CLI::Option* option) { return option->count() > 0; });
}

void Command::free_short_help() {
  app_->set_help_flag("--help", "Print this help message and exit");
}

void Command::set_footer(const std::string& text) {
  app_->footer(text);
}

void Command::on_chosen(std::function<int()> command) {
  // CLI11 calls this after the callbacks of subcommands.
  app_->callback([app = app_, chosen = chosen_, command = std::move(command)] {
    if (app->get_subcommands().empty()) *chosen = command;
  });
}

void Command::on_chosen(std::function<Result<void>()> command) {
  on_chosen([command = std::move(command)] {
    const auto done = command();
    return done ? 0 : report(done.error());
  });
}

void Command::require_command() {
  app_->require_subcommand(1);
}

CommandModel describe_program(const std::string& summary,
                              const std::function<void(Command&)>& add_commands) {
  CLI::App app{summary};
  app.set_version_flag("--version", NENDO_VERSION);
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
