// nendo-manual: writes the manual pages and completions. The build runs it.

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/files.hpp>
#include <nendo/version.hpp>

#include "cli/cli.hpp"
#include "cli/command.hpp"
#include "manual/completions.hpp"
#include "manual/man_page.hpp"
#include "nendo/commands.hpp"
#ifdef NENDO_BENCH
#include "bench/bench.hpp"
#endif

namespace nendo::manual {
namespace {

/// Returns the commands of the program. `nendo bench` starts nendo-bench, so its commands are here.
cli::CommandModel described_program() {
  cli::CommandModel program = cli::describe_program(app::program_summary, app::add_commands);
#ifdef NENDO_BENCH
  const cli::CommandModel bench = cli::describe_program("", bench::add_bench).commands.front();
  std::replace_if(
      program.commands.begin(), program.commands.end(),
      [&](const cli::CommandModel& command) { return command.name == bench.name; }, bench);
#endif
  return program;
}

int write_all(const std::filesystem::path& folder, const std::string& date) {
  const cli::CommandModel program = described_program();
  const PageOrigin origin{date, NENDO_VERSION};
  std::vector<std::pair<std::string, std::string>> files{
      {"nendo.1", program_page(program, origin)},
      {"nendo.bash", bash_completion(program)},
      {"_nendo", zsh_completion(program)},
      {"nendo.fish", fish_completion(program)},
  };
  for (const cli::CommandModel& command : program.commands)
    files.emplace_back("nendo-" + command.name + ".1", command_page(program, command, origin));
  std::error_code failed;
  std::filesystem::create_directories(folder, failed); // a failure shows when files are written
  for (const auto& [name, text] : files)
    if (const auto written = replace_file(folder / name, text); !written)
      return cli::report(written.error());
  return 0;
}

} // namespace
} // namespace nendo::manual

int main(int argc, char** argv) {
  if (argc == 3) return nendo::manual::write_all(argv[1], argv[2]);
  std::cerr << "usage: nendo-manual FOLDER DATE    (the date on the pages, such as 2026-11-22)\n";
  return static_cast<int>(nendo::Errc::usage);
}
