#include "nendo/puppet_file.hpp"

#include <filesystem>
#include <utility>

#include "cli/cli.hpp"

namespace nendo::app {

Result<PuppetFile> open_puppet(const std::string& name) {
  PuppetFile file{name, {}, {}};
  std::error_code ignored;
  if (!std::filesystem::exists(name, ignored)) {
    const auto shipped = cli::shipped_model(name + ".puppet.toml");
    if (!std::filesystem::exists(shipped, ignored))
      return Error{Errc::bad_input, name + ": no such puppet; name a puppet file, or one of the "
                                           "shipped face, moai and spot"};
    file.path = shipped.string();
  }
  auto puppet = puppet::read_puppet(file.path);
  if (!puppet) return puppet.error();
  if (!puppet->is_played())
    return Error{Errc::bad_input,
                 file.path +
                     ": has no points, so hands cannot play it; add [points] and functions, or "
                     "open it with --mask"};
  file.puppet = *std::move(puppet);
  file.model = (std::filesystem::path(file.path).parent_path() / file.puppet.model).string();
  return file;
}

} // namespace nendo::app
