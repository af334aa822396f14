#pragma once
// Puts what several models look like into one list each of materials, textures and names.

#include <cstdint>
#include <vector>

#include "join/triangle_surface.hpp"

namespace nendo::deform {

/// What is the same in two models is one entry. Another material of the same name gets a new name.
class LookCollector {
public:
  /// `look` must outlive this.
  explicit LookCollector(Appearance& look) : look_(look) {}

  /// Starts with another mesh's lists; the numbers of its entries are then known.
  void take(const Appearance& from);
  /// Returns the entries of a face of that mesh.
  FaceLook look_of(const Appearance& from, std::size_t face) const;

private:
  std::uint32_t number_of(const Texture& texture);
  std::uint32_t number_of(Material material);
  static std::vector<std::uint32_t> numbers_of(const FaceNames& from, FaceNames& to);

  Appearance& look_;
  std::vector<std::uint32_t> textures_, materials_, groups_, objects_;
};

} // namespace nendo::deform
