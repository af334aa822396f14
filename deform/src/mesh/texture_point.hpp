#pragma once
// What a mesh has for corners, in one piece: texture coordinates, and a colour where corners have
// one. Cutting, joining and refining put new ones between those of a file.

#include <array>
#include <span>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// u, v, and the colour of the corners, linear: red, green, blue, opacity; white if they have none.
using TexturePoint = std::array<double, 6>;

inline constexpr TexturePoint white_texture_point{0.0, 0.0, 1.0, 1.0, 1.0, 1.0};

/// Returns the point with this number, which must be less than #texcoords.
TexturePoint texture_point_of(const Mesh& mesh, std::size_t number) noexcept;

/// Replaces texcoords and texcoord_colours. The mesh gets no colours if all are white. Allocates.
void set_texture_points(std::span<const TexturePoint> points, Mesh& mesh);

} // namespace nendo::deform
