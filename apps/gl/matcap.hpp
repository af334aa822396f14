#pragma once
// Materials of the model in windows. A MatCap is a picture of a lit sphere, from which each place
// of a surface takes the colour of the sphere's place with the same normal, as seen by the camera.
// Thread-safe.

#include <array>
#include <cstdint>
#include <string_view>

#include <Eigen/Core>

#include "render/image.hpp"

namespace nendo::gl {

/// lit: the model's own colours and textures in the scene's lights. The others are MatCaps.
enum class Material : std::uint8_t { lit, clay, plaster, wax, skin };
inline constexpr std::array<std::string_view, 5> material_names{"lit", "clay", "plaster", "wax",
                                                                "skin"};

/// Returns the colour in sRGB, 0 to 1, of a surface with this normal: a unit vector to the right,
/// up, and to the eye. `material` must be a MatCap.
Eigen::Vector3f matcap_colour(Material material, const Eigen::Vector3f& normal);

/// Returns the MatCap's picture, `side_px` high and wide. The sphere touches its sides; the corners
/// have the colours of the nearest place of the sphere.
render::Image matcap(Material material, int side_px = 128);

} // namespace nendo::gl
