#include "transport/sysfs.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>

#include <nendo/base/number_in.hpp>
#include <nendo/base/text.hpp>

namespace nendo::driver {

namespace fs = std::filesystem;

std::string printable(std::string_view text) {
  constexpr std::size_t max_characters = 128;
  return nendo::printable(text.substr(0, max_characters));
}

std::string read_line(const fs::path& path) {
  constexpr std::size_t enough = 256;
  std::ifstream file(path, std::ios::binary);
  std::string text(enough, '\0');
  file.read(text.data(), static_cast<std::streamsize>(enough));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return printable(std::string_view(text).substr(0, text.find('\n')));
}

std::string read_text(const fs::path& path) {
  std::string text;
  constexpr std::size_t max_bytes = 1U << 20U;
  std::ifstream file(path, std::ios::binary);
  // By pieces: the files of /proc have no size.
  for (std::string piece(4096, '\0'); file && text.size() < max_bytes;) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    text.append(piece, 0, static_cast<std::size_t>(file.gcount()));
  }
  return text;
}

std::optional<unsigned> read_number(const fs::path& path, int base) {
  return number_in<unsigned>(read_line(path), base);
}

std::vector<std::string> names_in(const fs::path& folder) {
  constexpr std::size_t max_names = 65536;
  std::vector<std::string> names;
  std::error_code failed;
  // Not a range-for: its steps throw when the folder vanishes.
  for (fs::directory_iterator at(folder, failed), end;
       !failed && at != end && names.size() < max_names; at.increment(failed)) {
    names.push_back(at->path().filename().string());
  }
  return names;
}

} // namespace nendo::driver
