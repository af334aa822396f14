#include "studio/opened_files.hpp"

#include <algorithm>
#include <filesystem>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

#include "timeline/edit.hpp"

namespace nendo::studio {

std::vector<std::string> openable() {
  return {".obj", ".ply", ".stl", ".gltf", ".glb", ".puppet.toml", ".timeline.toml", ".nendo"};
}

bool opens_in_timeline(const std::string& file) {
  return file.ends_with(".nendo") || timeline::is_timeline(file);
}

Result<std::string> store_sent(const std::string& name, std::string_view bytes) {
  const auto endings = openable();
  const auto ending =
      std::ranges::find_if(endings, [&](const auto& one) { return name.ends_with(one); });
  if (ending == endings.end()) {
    std::string all;
    for (const std::string& one : endings)
      all += (all.empty() ? "" : ", ") + one;
    return Error{Errc::bad_input,
                 printable(name) + ": the studio opens no such file; it opens " + all};
  }
  const std::string stem = name.substr(0, name.size() - ending->size());
  std::string place = name;
  std::error_code ignored;
  for (int number = 1; exists(std::filesystem::symlink_status(place, ignored)); ++number)
    place = stem + "-" + std::to_string(number) + *ending;
  if (const auto written = replace_file(place, bytes); !written) return written.error();
  return place;
}

} // namespace nendo::studio
