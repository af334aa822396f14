#include "model_folder.hpp"

#include <algorithm>
#include <system_error>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

namespace nendo::deform {

namespace {

bool is_absolute_anywhere(std::string_view name) noexcept {
  const bool has_drive = name.size() > 1 && name[1] == ':';
  return name.starts_with('/') || has_drive;
}

} // namespace

std::optional<std::string> name_in_folder(std::string_view named) {
  if (named.find('\0') != std::string_view::npos || named.size() > 1024) return std::nullopt;
  std::string slashed(named);
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  bool leads_out = is_absolute_anywhere(slashed);
  std::string name;
  std::string_view last;
  for (std::string_view rest = slashed; !rest.empty();) {
    const std::string_view part = cut(rest, '/');
    last = part;
    if (part == "..") leads_out = true;
    if (part.empty() || part == ".") continue;
    name += (name.empty() ? "" : "/") + std::string(part);
  }
  if (slashed.ends_with('/') || last.empty() || last == "." || last == "..") return std::nullopt;
  if (!leads_out) return name;
  // "C:skin.png": the drive is no part of the name.
  last.remove_prefix(last.rfind(':') + 1); // of npos, 0
  if (last.empty() || last == "." || last == "..") return std::nullopt;
  return std::string(last);
}

ModelFolder::ModelFolder(const std::filesystem::path& model) {
  std::error_code failed;
  const auto parent = model.parent_path();
  folder_ = std::filesystem::canonical(parent.empty() ? "." : parent, failed);
  if (failed) folder_.clear();
}

std::optional<std::string> ModelFolder::read(std::string_view name,
                                             std::uint64_t most_bytes) const {
  if (folder_.empty() || name_in_folder(name) != name) return std::nullopt;
  std::error_code failed;
  const auto path = std::filesystem::canonical(folder_ / name, failed);
  if (failed) return std::nullopt;
  const auto [inside, below] =
      std::mismatch(folder_.begin(), folder_.end(), path.begin(), path.end());
  if (inside != folder_.end() || below == path.end()) return std::nullopt;
  auto contents = read_file(path, most_bytes, "part of a model");
  if (!contents) return std::nullopt;
  return *std::move(contents);
}

} // namespace nendo::deform
