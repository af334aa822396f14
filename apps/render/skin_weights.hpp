#pragma once
// Which joints carry the skin, and how much of each place.

#include <array>
#include <cstdint>
#include <vector>

#include "render/skin_net.hpp"
#include "render/skin_shape.hpp"

namespace nendo::render {

/// Up to four joints that carry a place, the strongest first.
struct SkinInfluence {
  std::array<hand::Joint, 4> joints{};
  std::array<float, 4> weights{}; ///< none is negative, and the sum is 1; 0 means not used
};

/// Returns the influences on each place of the mesh. At first each is carried by the part of the
/// flesh that is nearest. Then the weights spread along the surface, so that they change smoothly,
/// and never leap from a finger to the next one. Allocates.
std::vector<SkinInfluence> weights_of(const HandFlesh& flesh, const SkinMesh& mesh);

} // namespace nendo::render
