#include "transport/sysfs.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <system_error>

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;

std::string read_some_text(const fs::path& path, std::size_t most) {
  std::ifstream file(path, std::ios::binary);
  std::string text(most, '\0');
  file.read(text.data(), static_cast<std::streamsize>(most));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return text;
}

} // namespace

std::string printable(std::string_view text) {
  constexpr std::size_t longest = 128;
  std::string shown(text.substr(0, longest));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c < 0x20 || c > 0x7E; }, '?');
  return shown;
}

std::string read_line(const fs::path& path) {
  constexpr std::size_t enough = 256;
  const std::string text = read_some_text(path, enough);
  return printable(std::string_view(text).substr(0, text.find('\n')));
}

std::string read_text(const fs::path& path) {
  std::string text;
  constexpr std::size_t most = 1U << 20U;
  std::ifstream file(path, std::ios::binary);
  // By pieces: the files of /proc have no size.
  for (std::string piece(4096, '\0'); file && text.size() < most;) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    text.append(piece, 0, static_cast<std::size_t>(file.gcount()));
  }
  return text;
}

std::optional<unsigned> read_number(const fs::path& path, int base) {
  const std::string text = read_line(path);
  unsigned number = 0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, number, base);
  return error == std::errc{} && last == end ? std::optional(number) : std::nullopt;
}

std::vector<std::string> names_in(const fs::path& folder) {
  constexpr std::size_t most = 65536;
  std::vector<std::string> names;
  std::error_code failed;
  // Not a range-for: its steps throw when the folder vanishes.
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end && names.size() < most;
       at.increment(failed)) {
    names.push_back(at->path().filename().string());
  }
  return names;
}

std::optional<fs::path> link_target(const fs::path& link) {
  std::error_code not_a_link;
  const fs::path target = fs::read_symlink(link, not_a_link);
  if (not_a_link) return std::nullopt;
  return (link.parent_path() / target).lexically_normal();
}

} // namespace nendo::driver
