// nendo manual: writes the manual pages and completions, for whoever builds and packages nendo.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/files.hpp>
#include <nendo/version.hpp>

#include "cli/cli.hpp"
#include "manual/completions.hpp"
#include "manual/man_page.hpp"
#include "manual/model_json.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::manual_command {
namespace {

struct Options {
  std::string folder;
  std::string date;
  std::string bench;
};

/// Replaces the command bench of the program by the description that nendo-bench has written.
Result<void> add_bench(const std::string& file, cli::CommandModel& program) {
  if (file.empty()) return {};
  constexpr std::uint64_t max_bytes = 1U << 20U;
  const auto text = read_file(file, max_bytes, "description of nendo-bench");
  if (!text) return text.error();
  auto bench = manual::parse_model(*text);
  if (!bench) return Error{bench.error().code, file + ": " + bench.error().message};
  for (cli::CommandModel& command : program.commands)
    if (command.name == bench->name) command = *bench;
  return {};
}

int write_manual(cli::CommandModel program, const Options& options) {
  if (const auto added = add_bench(options.bench, program); !added)
    return cli::report(added.error());
  const manual::PageOrigin origin{options.date, NENDO_VERSION};
  std::vector<std::pair<std::string, std::string>> files{
      {"nendo.1", manual::program_page(program, origin)},
      {"nendo.bash", manual::bash_completion(program)},
      {"_nendo", manual::zsh_completion(program)},
      {"nendo.fish", manual::fish_completion(program)},
  };
  for (const cli::CommandModel& command : program.commands)
    files.emplace_back("nendo-" + command.name + ".1",
                       manual::command_page(program, command, origin));
  std::error_code failed;
  std::filesystem::create_directories(options.folder, failed);
  for (const auto& [name, text] : files) {
    const auto written = replace_file(std::filesystem::path(options.folder) / name, text);
    if (!written) return cli::report(written.error());
  }
  return 0;
}

} // namespace

void add(cli::Command& program) {
  auto options = std::make_shared<Options>();
  cli::Command command = program.add_command("manual", "Writes the manual pages and completions");
  command.hide();
  command.add_option("DIR", options->folder, "The folder to write them to").required();
  command.add_option("--date", options->date, "The date that the pages bear, as 2026-11-22")
      .required();
  command.add_option("--bench", options->bench,
                     "What nendo-bench describe printed; without it, nendo bench has a short page");
  command.on_chosen([options, program] { return write_manual(program.model(), *options); });
}

} // namespace nendo::app::manual_command
