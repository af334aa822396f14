// The nendo program: one subcommand a file.

#include <exception>
#include <iostream>
#include <string>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "cli.hpp"

namespace {

int report_usage(const CLI::App& app, const std::string& first_word, const std::string& what) {
  const auto chosen = app.get_subcommands();
  if (!chosen.empty()) {
    std::cerr << "nendo: " << what << " (see nendo " << chosen.front()->get_name() << " --help)\n";
  } else if (first_word.starts_with('-')) {
    std::cerr << "nendo: " << what << " (see nendo --help)\n";
  } else {
    std::string known;
    for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; })) {
      known += (known.empty() ? "" : ", ") + command->get_name();
    }
    std::cerr << "nendo: "
              << (first_word.empty() ? "say what to do;" : "no command " + first_word + ";")
              << " there are " << known << " (see nendo --help)\n";
  }
  return static_cast<int>(nendo::Errc::usage);
}

int run(int argc, char** argv) {
  using namespace nendo::app;
  // The drivers' log lines must not mix with what a command prints.
  spdlog::set_default_logger(spdlog::stderr_color_mt("nendo"));
  spdlog::set_pattern("nendo: %v");

  CLI::App app{
      "Nendo: data gloves that shape 3-D models.\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 no such glove or no answer, 4 no permission, "
      "5 bad input file."};
  app.set_version_flag("--version", NENDO_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  int exit_code = 0;
  add_run(app, exit_code);
  add_monitor(app, exit_code);
  add_devices(app, exit_code);
  add_doctor(app, exit_code);
  add_info(app, exit_code);
  add_deform(app, exit_code);
  add_emulate(app, exit_code);
  add_bench(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return report_usage(app, argc > 1 ? argv[1] : "", error.what());
  }
  return exit_code;
}

} // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) { // out of memory, mostly
    std::cerr << "nendo: " << error.what() << '\n';
    return static_cast<int>(nendo::Errc::failed);
  }
}
