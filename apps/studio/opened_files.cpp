#include "studio/opened_files.hpp"

#include "timeline/edit.hpp"

namespace nendo::studio {

std::vector<std::string> openable() {
  return {".obj", ".ply", ".stl", ".gltf", ".glb", ".puppet.toml", ".timeline.toml", ".nendo"};
}

bool opens_in_timeline(const std::string& file) {
  return file.ends_with(".nendo") || timeline::is_timeline(file);
}

} // namespace nendo::studio
