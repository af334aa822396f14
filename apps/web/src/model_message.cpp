#include <nendo/web/model_message.hpp>

#include <cstring>
#include <span>

#include "wire.hpp"

namespace nendo::web {
namespace {

// Faces, cut into fans, by the vertices' places in the blocks.
std::vector<std::uint32_t> corners_of(const deform::BlockLayout& layout, const deform::Mesh& mesh) {
  std::vector<std::uint32_t> place_of(layout.vertex_count());
  for (std::size_t at = 0; at < place_of.size(); ++at)
    place_of[layout.order()[at]] = static_cast<std::uint32_t>(at);
  std::vector<std::uint32_t> corners;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const auto begin = mesh.face_starts[face];
    for (auto corner = begin + 1; corner + 1 < mesh.face_starts[face + 1]; ++corner)
      for (const auto at : {begin, corner, corner + 1})
        corners.push_back(place_of[mesh.face_corners[at]]);
  }
  return corners;
}

} // namespace

std::vector<std::byte> model_message(const deform::BlockLayout& layout, const deform::Mesh& mesh,
                                     const ModelFacts& facts) {
  const auto corners = corners_of(layout, mesh);
  ModelHead head;
  head.vertices = static_cast<std::uint32_t>(layout.vertex_count());
  head.triangles = static_cast<std::uint32_t>(corners.size() / 3);
  head.name_bytes = static_cast<std::uint32_t>(facts.name.size());
  head.rate_hz = facts.rate_hz;
  head.unit = layout.unit();
  head.units_per_metre = facts.units_per_metre;
  head.diagonal = layout.diagonal();
  head.mode = facts.mode == flow::Mode::type1 ? 1 : 2;
  for (std::size_t axis = 0; axis < 3; ++axis)
    head.origin[axis] = layout.origin()[static_cast<Eigen::Index>(axis)];
  for (std::size_t finger = 0; finger < facts.radius_m.size(); ++finger)
    head.radius_m[finger] = static_cast<float>(facts.radius_m[finger]);
  std::vector<std::byte> message(sizeof head + 16 * layout.vertex_count() + 4 * corners.size() +
                                 facts.name.size());
  WireWriter out(message);
  out.put(head);
  const deform::BlockShape shape = layout.pack();
  for (std::size_t at = 0; at < layout.vertex_count(); ++at) {
    const deform::VertexBlock& block = shape[at / deform::block_size];
    for (const auto* axis : {&block.x, &block.y, &block.z})
      out.put((*axis)[at % deform::block_size]);
  }
  for (const std::uint32_t vertex : layout.order())
    out.put(vertex);
  for (const std::uint32_t corner : corners)
    out.put(corner);
  for (const char c : facts.name)
    out.put(c);
  return message;
}

} // namespace nendo::web
