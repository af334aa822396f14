// The writer of PLY, binary little-endian.

#include <algorithm>
#include <cmath>
#include <limits>

#include <nendo/deform/corner_colours.hpp>

#include "files/binary_numbers.hpp"
#include "files/colour_range.hpp"
#include "files/mesh_formats.hpp"

namespace nendo::deform {
namespace {

void append_colour(std::string& text, const Eigen::Vector4f& colour) {
  for (Eigen::Index channel = 0; channel < 4; ++channel) {
    const float part = channel < 3 ? encoded_of(colour[channel]) : colour[channel];
    append_little_endian(
        text, static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(part, 0.0F, 1.0F))));
  }
}

} // namespace

std::string ply_text(const Mesh& mesh) {
  // uchar and int are what every reader knows; uint only where a face or the model is too large for
  // them.
  const bool large_face = max_corners(mesh) > 255;
  const bool large_model = mesh.vertices.cols() > std::numeric_limits<std::int32_t>::max();
  const Eigen::Matrix4Xf colours = mean_vertex_colours(mesh);
  const bool coloured = colours.cols() > 0 && colours.cols() == mesh.vertices.cols();
  const std::string colour_properties = "property uchar red\nproperty uchar green\n"
                                        "property uchar blue\nproperty uchar alpha\n";
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment nendo\nelement vertex " +
                     std::to_string(mesh.vertices.cols()) +
                     "\nproperty double x\nproperty double y\nproperty double z\n" +
                     (coloured ? colour_properties : "") + "element face " +
                     std::to_string(mesh.face_count()) + "\nproperty list " +
                     (large_face ? "uint" : "uchar") + (large_model ? " uint" : " int") +
                     " vertex_indices\nend_header\n";
  for (Eigen::Index vertex = 0; vertex < mesh.vertices.cols(); ++vertex) {
    for (const double coordinate : mesh.vertices.col(vertex))
      append_little_endian(text, coordinate);
    if (coloured) append_colour(text, colours.col(vertex));
  }
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const auto corners = mesh.corners_of(face);
    if (large_face)
      append_little_endian(text, to_index(corners.size()));
    else
      append_little_endian(text, static_cast<std::uint8_t>(corners.size()));
    for (const std::uint32_t vertex : corners)
      append_little_endian(text, vertex);
  }
  return text;
}

} // namespace nendo::deform
