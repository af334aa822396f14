#include "output_place.hpp"

#include <algorithm>
#include <filesystem>

#include <unistd.h>

namespace nendo::app {
namespace {

std::string either(std::initializer_list<std::string_view> endings) {
  std::string words;
  for (const auto ending : endings)
    words += (words.empty() ? "" : " or ") + std::string(ending);
  return words;
}

} // namespace

Result<void> check_place(std::string_view option, const std::string& path,
                         std::initializer_list<std::string_view> endings) {
  if (path.empty()) return {};
  const std::filesystem::path file(path);
  const std::string given = std::string(option) + " " + path;
  if (endings.size() > 0 &&
      std::find(endings.begin(), endings.end(), file.extension().string()) == endings.end())
    return Error{Errc::usage, given + ": end the name in " + either(endings)};
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    return Error{Errc::usage, given + ": that is a folder; name a file in it"};
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return {};
  return Error{Errc::failed,
               given + ": " + folder.string() +
                   " is not a folder that you may write to; make it or choose another"};
}

std::string numbered(const std::string& path, int number) {
  const std::filesystem::path whole(path);
  const std::string name =
      whole.stem().string() + "-" + std::to_string(number) + whole.extension().string();
  return (whole.parent_path() / name).string();
}

std::string next_free_name(const std::string& path, int& number) {
  std::string name;
  std::error_code ignored;
  do
    name = numbered(path, ++number);
  while (std::filesystem::exists(name, ignored));
  return name;
}

} // namespace nendo::app
