#include "cli/output_place.hpp"

#include <algorithm>
#include <filesystem>

#include <unistd.h>

#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>

#include "cli/model_files.hpp"

namespace nendo::cli {
namespace {

std::string either(std::span<const std::string_view> endings) {
  std::string words;
  for (const auto& ending : endings) {
    const bool is_last = &ending == &endings.back();
    words += (words.empty() ? "" : is_last ? " or " : ", ") + std::string(ending);
  }
  return words;
}

} // namespace

Result<void> check_place(std::string_view option, const std::string& path,
                         std::span<const std::string_view> endings) {
  if (path.empty()) return {};
  const std::filesystem::path file(path);
  const std::string given = std::string(option) + " " + path;
  if (!endings.empty() && ending_of(path, endings).empty())
    return Error{Errc::usage, given + ": end the name in " + either(endings)};
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    return Error{Errc::usage, given + ": is a folder; name a file in it"};
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return {};
  return Error{Errc::failed, given + ": " + folder.string() +
                                 " is not a writable folder; make it or choose another"};
}

Result<void> check_place(std::string_view option, const std::string& path,
                         std::initializer_list<std::string_view> endings) {
  return check_place(option, path, std::span(endings.begin(), endings.size()));
}

Result<void> check_new_recording(std::string_view option, const std::string& path) {
  std::error_code ignored;
  if (path.empty() || !std::filesystem::exists(path, ignored)) return {};
  return Error{Errc::failed, std::string(option) + " " + path +
                                 ": exists, and recordings are never overwritten; name another "
                                 "file or move it away"};
}

Result<void>
check_distinct(std::initializer_list<std::pair<std::string_view, std::string_view>> outputs) {
  const auto place = [](std::string_view path) {
    std::error_code ignored;
    return std::filesystem::weakly_canonical(path, ignored);
  };
  for (auto one = outputs.begin(); one != outputs.end(); ++one)
    for (auto other = outputs.begin(); other != one; ++other)
      if (!one->second.empty() && !other->second.empty() &&
          place(one->second) == place(other->second))
        return Error{Errc::usage, std::string(other->first) + " and " + std::string(one->first) +
                                      ": both name " + std::string(one->second) +
                                      "; give each a file of its own"};
  return {};
}

Result<void> check_spares(const std::string& model, std::string_view option, const std::string& out,
                          bool force) {
  if (force || out.empty()) return {};
  const std::vector<std::string> files = files_of_name(model);
  if (std::none_of(files.begin(), files.end(), [&](const std::string& file) {
        std::error_code not_there;
        return std::filesystem::equivalent(file, out, not_there);
      }))
    return {};
  return Error{Errc::usage, std::string(option) + " " + out +
                                ": is the model itself, whose normals, materials and groups would "
                                "be lost; name another file, or add --force"};
}

Result<std::string> name_beside(const std::string& to, const std::string& from) {
  namespace fs = std::filesystem;
  std::error_code failed;
  const fs::path folder = fs::absolute(from, failed).parent_path();
  const std::string name = fs::proximate(to, folder, failed).string();
  if (failed || printable(name) != name || name.find_first_of("\"\\") != std::string::npos)
    return Error{Errc::usage, from + ": cannot name its model from there; put it beside " + to};
  return name;
}

namespace {

std::string numbered(const std::string& stem, std::string_view ending, int number) {
  return stem + "-" + std::to_string(number) + std::string(ending);
}

std::string stem_of(const std::filesystem::path& path) {
  return (path.parent_path() / path.stem()).string();
}

} // namespace

std::string numbered(const std::string& path, int number) {
  return numbered(stem_of(path), std::filesystem::path(path).extension().string(), number);
}

std::string next_free_name(const std::string& path, int& number) {
  return next_free_name(stem_of(path), std::filesystem::path(path).extension().string(), number);
}

std::string next_free_name(const std::string& stem, std::string_view ending, int& number) {
  std::string name;
  std::error_code ignored;
  do
    name = numbered(stem, ending, ++number);
  while (std::filesystem::exists(std::filesystem::symlink_status(name, ignored)));
  return name;
}

} // namespace nendo::cli
