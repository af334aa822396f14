#include "web/model_message.hpp"

#include <array>

#include "web/model_paint.hpp"
#include "web/wire.hpp"

namespace nendo::web {
namespace {

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
  for (std::size_t at = 0; at < layout.vertex_count(); ++at) {
    const deform::VertexBlock& block = shape[at / deform::block_size];
    for (const auto* axis : {&block.x, &block.y, &block.z})
      out.put((*axis)[at % deform::block_size]);
  }
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

} // namespace nendo::web
