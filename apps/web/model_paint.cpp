#include "web/model_paint.hpp"

#include <algorithm>
#include <cmath>

#include <nendo/deform/drawn_faces.hpp>
#include <nendo/deform/triangles.hpp>

#include "web/pictures.hpp"

namespace nendo::web {
namespace {

std::uint16_t as_share(float value) noexcept {
  return value > 0.0F ? static_cast<std::uint16_t>(std::lround(65535.0F * std::min(value, 1.0F)))
                      : std::uint16_t{0};
}

CoatHead coat_of(const deform::Material& material, const deform::Mesh& mesh) {
  CoatHead coat;
  if (has_picture(mesh, material.texture)) coat.texture = material.texture;
  if (!material.colour) return coat;
  coat.has_colour = 1;
  for (std::size_t channel = 0; channel < 3; ++channel)
    coat.colour[channel] =
        as_float(static_cast<double>((*material.colour)[static_cast<Eigen::Index>(channel)]));
  return coat;
}

std::array<std::uint16_t, 3> as_shares(const Eigen::Vector4f& colour) noexcept {
  return {as_share(colour[0]), as_share(colour[1]), as_share(colour[2])};
}

std::vector<std::array<std::uint16_t, 3>> vertex_colours_of(const deform::Mesh& mesh,
                                                            const deform::BlockLayout& layout) {
  const auto& given = mesh.look.vertex_colours;
  std::vector<std::array<std::uint16_t, 3>> colours;
  if (given.cols() == 0 || given.cols() != mesh.vertices.cols()) return colours;
  for (const std::uint32_t vertex : layout.order())
    colours.push_back(as_shares(given.col(vertex)));
  return colours;
}

} // namespace

ModelPaint paint_of(const deform::Mesh& mesh, const deform::BlockLayout& layout) {
  const std::vector<std::uint32_t> place_of = layout.places();
  ModelPaint paint;
  std::vector<std::uint32_t> drawn; // numbers of the mesh's corners
  const auto faces = deform::drawn_faces(mesh);
  deform::FaceTriangles triangles(mesh);
  bool textured = false;
  for (std::size_t at = 0; at < faces.size(); ++at) {
    CoatHead coat = at == 0 ? CoatHead{} : coat_of(mesh.look.materials[at - 1], mesh);
    const std::size_t before = drawn.size();
    for (const std::uint32_t face : faces[at])
      for (const deform::Triangle& triangle : triangles.of(face))
        drawn.insert(drawn.end(), triangle.begin(), triangle.end());
    coat.triangles = static_cast<std::uint32_t>((drawn.size() - before) / 3);
    if (coat.triangles == 0) continue;
    textured = textured || coat.texture != deform::no_index;
    paint.coats.push_back(coat);
  }
  const auto& of_corners = mesh.look.texcoord_colours;
  paint.colours_of_corners = of_corners.cols() > 0;
  if (!paint.colours_of_corners) paint.colours = vertex_colours_of(mesh, layout);
  for (const std::uint32_t corner : drawn) {
    paint.corners.push_back(place_of[mesh.face_corners[corner]]);
    if (paint.colours_of_corners)
      paint.colours.push_back(as_shares(of_corners.col(mesh.corner_texcoords[corner])));
    if (!textured) continue;
    const auto& place = mesh.texcoords.col(mesh.corner_texcoords[corner]);
    paint.texcoords.push_back({as_float(place.x()), as_float(place.y())});
  }
  return paint;
}

} // namespace nendo::web
