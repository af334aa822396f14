#include "session/kept_state.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include <nendo/base/files.hpp>

namespace nendo::session {
namespace {

constexpr std::size_t max_recent = 12;

/// Nothing without a home folder.
std::optional<std::filesystem::path> kept(const char* name) {
  const char* const state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state == '/') return std::filesystem::path(state) / "nendo" / name;
  const char* const home = std::getenv("HOME");
  if (home == nullptr || *home != '/') return std::nullopt;
  return std::filesystem::path(home) / ".local/state/nendo" / name;
}

void write(const char* name, const std::string& text) {
  const auto file = kept(name);
  std::error_code failed;
  if (!file) return;
  std::filesystem::create_directories(file->parent_path(), failed);
  if (!failed) static_cast<void>(replace_file(*file, text));
}

} // namespace

bool are_hints_due() {
  std::error_code ignored;
  const auto file = kept("hints-closed"); // whose presence says it
  return file && !std::filesystem::exists(*file, ignored);
}

void keep_hints_closed() {
  write("hints-closed", "");
}

std::vector<std::string> recent_files() {
  std::vector<std::string> files;
  const auto list = kept("recent");
  if (!list) return files;
  std::ifstream lines(*list);
  std::error_code ignored;
  for (std::string line; files.size() < max_recent && std::getline(lines, line);)
    if (line.starts_with('/') && std::filesystem::is_regular_file(line, ignored))
      files.push_back(line);
  return files;
}

void keep_recent_file(const std::string& file) {
  std::error_code failed;
  const std::string path = std::filesystem::absolute(file, failed).lexically_normal().string();
  if (failed || path.find('\n') != std::string::npos) return;
  std::string text = path + "\n";
  for (const std::string& earlier : recent_files())
    if (earlier != path) text += earlier + "\n";
  write("recent", text);
}

} // namespace nendo::session
