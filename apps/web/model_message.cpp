#include "web/model_message.hpp"

#include <array>

#include <nendo/deform/triangles.hpp>

#include "web/wire.hpp"

namespace nendo::web {
namespace {

// The corners of all triangles, as the vertices' places in the blocks.
std::vector<std::uint32_t> corners_of(const deform::BlockLayout& layout, const deform::Mesh& mesh) {
  const std::vector<std::uint32_t> place_of = layout.places();
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t vertex : deform::corners_of_triangles(mesh))
    corners.push_back(place_of[vertex]);
  return corners;
}

using Hands = std::array<const flow::HandInput*, 2>; ///< by flow::Placement::index_of(side)

void write_bones(const hand::HandSkeleton& skeleton, WireWriter& out) {
  const hand::HandPose rest = skeleton.pose({}, Eigen::Isometry3d::Identity());
  for (std::size_t joint = 0; joint < hand::joint_count; ++joint) {
    const auto parent = hand::parent_of(static_cast<hand::Joint>(joint));
    Eigen::Isometry3d T_parent_joint = rest.joints[joint];
    if (parent) T_parent_joint = rest[*parent].inverse() * T_parent_joint;
    const Eigen::Vector3f place = T_parent_joint.translation().cast<float>();
    const Eigen::Quaternionf turn(T_parent_joint.linear().cast<float>());
    for (const float number :
         {place.x(), place.y(), place.z(), turn.x(), turn.y(), turn.z(), turn.w()})
      out.put(number);
  }
}

ModelHead head_of(const deform::BlockLayout& layout, const Hands& hands, const ModelFacts& facts) {
  ModelHead head;
  head.vertices = static_cast<std::uint32_t>(layout.vertex_count());
  head.name_bytes = static_cast<std::uint32_t>(facts.name.size());
  head.rate_hz = facts.rate_hz;
  head.unit = layout.unit();
  head.units_per_metre = facts.units_per_metre;
  head.diagonal = layout.diagonal();
  head.flags =
      static_cast<std::uint8_t>((hands[0] != nullptr ? 1U : 0U) | (hands[1] != nullptr ? 2U : 0U));
  for (std::size_t axis = 0; axis < 3; ++axis)
    head.origin[axis] = layout.origin()[static_cast<Eigen::Index>(axis)];
  return head;
}

} // namespace

std::vector<std::byte> model_message(const deform::BlockLayout& layout, const deform::Mesh& mesh,
                                     std::span<const flow::HandInput> hands,
                                     const ModelFacts& facts) {
  const auto corners = corners_of(layout, mesh);
  Hands by_side{};
  for (const flow::HandInput& hand : hands)
    by_side[flow::Placement::index_of(hand.side)] = &hand;
  ModelHead head = head_of(layout, by_side, facts);
  head.triangles = static_cast<std::uint32_t>(corners.size() / 3);
  std::vector<std::byte> message(sizeof head + hands.size() * bones_bytes +
                                 16 * layout.vertex_count() + 4 * corners.size() +
                                 facts.name.size());
  WireWriter out(message);
  out.put(head);
  for (const flow::HandInput* hand : by_side) {
    if (hand == nullptr) continue;
    write_bones(hand->skeleton(hand->first.side), out);
    write_bones(hand->skeleton(opposite(hand->first.side)), out);
  }
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
