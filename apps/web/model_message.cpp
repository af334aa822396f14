#include "web/model_message.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <nendo/base/number_in.hpp>
#include <nendo/deform/drawn_faces.hpp>
#include <nendo/deform/triangles.hpp>

#include "render/texture_image.hpp"
#include "web/wire.hpp"

namespace nendo::web {

bool has_picture(const deform::Mesh& mesh, std::uint32_t texture) noexcept {
  const auto& textures = mesh.look.textures;
  if (mesh.corner_texcoords.empty() || texture >= textures.size()) return false;
  const auto& contents = textures[texture].contents;
  return contents && render::picture_kind_of(*contents) != render::PictureKind::none;
}

Pictures pictures_of(const deform::Mesh& mesh) {
  Pictures pictures;
  if (mesh.corner_texcoords.empty()) return pictures;
  for (const deform::Texture& texture : mesh.look.textures)
    pictures.push_back(render::as_png_or_jpeg(texture.contents));
  return pictures;
}

std::optional<std::size_t> picture_number(std::string_view text) noexcept {
  constexpr std::size_t max_digits = 9;
  return text.size() > max_digits ? std::nullopt : number_in<std::size_t>(text);
}

namespace {

struct ModelPaint {
  /// Places in the blocks of the vertices of the triangles that are drawn.
  std::vector<std::uint32_t> corners;
  std::vector<CoatHead> coats; ///< in the order of the triangles
  /// One for each corner; empty if no coat has a texture.
  std::vector<std::array<float, 2>> texcoords;
  /// Linear, red, green, blue of each vertex in block order, or of each corner, 65535 for 1; empty
  /// if all are white.
  std::vector<std::array<std::uint16_t, 3>> colours;
  bool colours_of_corners = false;
};

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

using Hands = std::array<const flow::HandInput*, 2>; ///< index: flow::Placement::index_of(side)

void write_bones(const hand::HandSkeleton& skeleton, WireWriter& out) {
  const hand::HandPose rest = skeleton.pose({}, Eigen::Isometry3d::Identity());
  for (std::size_t joint = 0; joint < hand::joint_count; ++joint) {
    const auto parent = hand::parent_of(static_cast<hand::Joint>(joint));
    Eigen::Isometry3d T_parent_joint = rest.joints[joint];
    if (parent) T_parent_joint = rest[*parent].inverse() * T_parent_joint;
    write_pose(T_parent_joint, out);
  }
}

ModelHead head_of(const deform::BlockLayout& layout, const ModelPaint& paint, const Hands& hands,
                  const ModelFacts& facts) {
  ModelHead head;
  head.triangles = static_cast<std::uint32_t>(paint.corners.size() / 3);
  head.coats = static_cast<std::uint32_t>(paint.coats.size());
  head.vertices = static_cast<std::uint32_t>(layout.vertex_count());
  head.name_bytes = static_cast<std::uint32_t>(facts.name.size());
  head.rate_hz = facts.rate_hz;
  head.unit = layout.unit();
  head.units_per_metre = facts.units_per_metre;
  head.diagonal = layout.diagonal();
  head.flags = static_cast<std::uint8_t>(
      (hands[0] != nullptr ? 1U : 0U) | (hands[1] != nullptr ? 2U : 0U) |
      (paint.colours.empty() ? 0U : 4U) | (paint.texcoords.empty() ? 0U : 8U) |
      (paint.colours_of_corners ? 16U : 0U));
  for (std::size_t axis = 0; axis < 3; ++axis)
    head.origin[axis] = layout.origin()[static_cast<Eigen::Index>(axis)];
  return head;
}

} // namespace

std::vector<std::byte> model_message(const deform::BlockLayout& layout, const deform::Mesh& mesh,
                                     std::span<const flow::HandInput> hands,
                                     const ModelFacts& facts) {
  const ModelPaint paint = paint_of(mesh, layout);
  Hands by_side{};
  for (const flow::HandInput& hand : hands)
    by_side[flow::Placement::index_of(hand.side)] = &hand;
  const ModelHead head = head_of(layout, paint, by_side, facts);
  std::vector<std::byte> message(
      sizeof head + hands.size() * bones_bytes + 16 * layout.vertex_count() +
      4 * paint.corners.size() + sizeof(CoatHead) * paint.coats.size() +
      8 * paint.texcoords.size() + 6 * paint.colours.size() + facts.name.size());
  WireWriter out(message);
  out.put(head);
  for (const flow::HandInput* hand : by_side) {
    if (hand == nullptr) continue;
    write_bones(hand->skeleton(hand->first.side), out);
    write_bones(hand->skeleton(opposite(hand->first.side)), out);
  }
  const deform::BlockShape shape = layout.pack();
  for (std::size_t at = 0; at < layout.vertex_count(); ++at)
    out.put(deform::vertex_at(shape, at));
  const auto put_all = [&out](const auto& values) {
    for (const auto& value : values)
      out.put(value);
  };
  put_all(layout.order());
  put_all(paint.corners);
  put_all(paint.coats);
  put_all(paint.texcoords);
  put_all(paint.colours);
  put_all(facts.name);
  return message;
}

std::vector<std::byte> weights_message(const deform::SurfaceField& field) {
  const deform::SurfaceField::Terms terms = field.terms();
  WeightsHead head;
  head.vectors = static_cast<std::uint16_t>(field.vector_count());
  head.number = static_cast<std::uint32_t>(field.number());
  head.vertices = static_cast<std::uint32_t>(terms.starts.size() - 1);
  head.terms = static_cast<std::uint32_t>(terms.values.size());
  std::vector<std::byte> message(sizeof head + 6 * terms.values.size() +
                                 std::size_t{2} * head.vertices);
  WireWriter out(message);
  out.put(head);
  for (const float value : terms.values)
    out.put(value);
  for (std::size_t vertex = 0; vertex < head.vertices; ++vertex)
    out.put(static_cast<std::uint16_t>(terms.starts[vertex + 1] - terms.starts[vertex]));
  for (const std::uint32_t vector : terms.of_vector)
    out.put(static_cast<std::uint16_t>(vector));
  return message;
}

} // namespace nendo::web
