#include "join/look_collector.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace nendo::deform {
namespace {

bool same_texture(const Texture& a, const Texture& b) {
  if (a.file != b.file) return false;
  return a.contents == b.contents || (a.contents && b.contents && *a.contents == *b.contents);
}

} // namespace

void LookCollector::take(const Appearance& from) {
  textures_.clear();
  materials_.clear();
  for (const Texture& texture : from.textures)
    textures_.push_back(number_of(texture));
  for (const Material& material : from.materials)
    materials_.push_back(number_of(material));
  groups_ = numbers_of(from.groups, look_.groups);
  objects_ = numbers_of(from.objects, look_.objects);
}

FaceLook LookCollector::look_of(const Appearance& from, std::size_t face) const {
  const auto entry = [&](const std::vector<std::uint32_t>& of_face,
                         const std::vector<std::uint32_t>& numbers) {
    return of_face.empty() || of_face[face] == no_index ? no_index : numbers[of_face[face]];
  };
  return {entry(from.face_materials, materials_), entry(from.groups.of_face, groups_),
          entry(from.objects.of_face, objects_)};
}

std::uint32_t LookCollector::number_of(const Texture& texture) {
  const auto found =
      std::find_if(look_.textures.begin(), look_.textures.end(),
                   [&](const Texture& other) { return same_texture(texture, other); });
  const auto number = static_cast<std::uint32_t>(found - look_.textures.begin());
  if (found == look_.textures.end()) look_.textures.push_back(texture);
  return number;
}

std::uint32_t LookCollector::number_of(Material material) {
  if (material.texture != no_index) material.texture = textures_[material.texture];
  const std::string name = material.name;
  for (int copy = 2;; ++copy) {
    const auto found =
        std::find_if(look_.materials.begin(), look_.materials.end(),
                     [&](const Material& other) { return other.name == material.name; });
    const auto number = static_cast<std::uint32_t>(found - look_.materials.begin());
    if (found == look_.materials.end()) {
      look_.materials.push_back(std::move(material));
      return number;
    }
    if (found->colour == material.colour && found->texture == material.texture &&
        found->drawn == material.drawn)
      return number;
    material.name = name + "-" + std::to_string(copy);
  }
}

std::vector<std::uint32_t> LookCollector::numbers_of(const FaceNames& from, FaceNames& to) {
  std::vector<std::uint32_t> numbers;
  for (const std::string& name : from.names) {
    const auto found = std::find(to.names.begin(), to.names.end(), name);
    numbers.push_back(static_cast<std::uint32_t>(found - to.names.begin()));
    if (found == to.names.end()) to.names.push_back(name);
  }
  return numbers;
}

} // namespace nendo::deform
