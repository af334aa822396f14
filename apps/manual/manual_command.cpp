// nendo manual: writes the manual pages and completions, for whoever builds and packages nendo.

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/files.hpp>

#include "cli.hpp"
#include "commands.hpp"
#include "manual/completions.hpp"
#include "manual/man_page.hpp"

namespace nendo::app {
namespace {

struct Options {
  std::string folder;
  std::string date;
};

int write_manual(const CommandModel& program, const Options& options) {
  const PageOrigin origin{options.date, NENDO_VERSION};
  std::vector<std::pair<std::string, std::string>> files{
      {"nendo.1", program_page(program, origin)},
      {"nendo.bash", bash_completion(program)},
      {"_nendo", zsh_completion(program)},
      {"nendo.fish", fish_completion(program)},
  };
  for (const CommandModel& command : program.commands)
    files.emplace_back("nendo-" + command.name + ".1", command_page(program, command, origin));
  std::error_code failed;
  std::filesystem::create_directories(options.folder, failed);
  for (const auto& [name, text] : files) {
    const auto written = replace_file(std::filesystem::path(options.folder) / name, text);
    if (!written) return report(written.error());
  }
  return 0;
}

} // namespace

void add_manual(Command& program) {
  auto options = std::make_shared<Options>();
  Command command = program.add_command("manual", "Writes the manual pages and completions");
  command.hide();
  command.add_option("DIR", options->folder, "The folder to write them to").required();
  command.add_option("--date", options->date, "The date that the pages bear, as 2026-11-22")
      .required();
  command.on_chosen([options, program] { return write_manual(program.model(), *options); });
}

} // namespace nendo::app
