#include "session/first_start.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

namespace nendo::session {
namespace {

/// The file whose presence says that the hints were closed; nothing without a home folder.
std::optional<std::filesystem::path> marker() {
  const char* const state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state == '/')
    return std::filesystem::path(state) / "nendo" / "hints-closed";
  const char* const home = std::getenv("HOME");
  if (home == nullptr || *home != '/') return std::nullopt;
  return std::filesystem::path(home) / ".local/state/nendo/hints-closed";
}

} // namespace

bool are_hints_due() {
  std::error_code ignored;
  const auto file = marker();
  return file && !std::filesystem::exists(*file, ignored);
}

void keep_hints_closed() {
  const auto file = marker();
  std::error_code failed;
  if (!file) return;
  std::filesystem::create_directories(file->parent_path(), failed);
  if (!failed) std::ofstream(*file).flush();
}

} // namespace nendo::session
