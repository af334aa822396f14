#include "web/skin_message.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "render/hand_skin.hpp"
#include "web/wire.hpp"

namespace nendo::web {
namespace {

/// Returns the weights in 255ths; the strongest joint has what rounding leaves, so that their sum
/// is 255.
std::array<std::uint8_t, 4> shares_of(const render::SkinInfluence& influence) noexcept {
  std::array<std::uint8_t, 4> shares{};
  int left = 255;
  for (std::size_t rank = 1; rank < shares.size(); ++rank) {
    shares[rank] = static_cast<std::uint8_t>(std::lround(255.0F * influence[rank].weight));
    left -= shares[rank];
  }
  shares[0] = static_cast<std::uint8_t>(left);
  return shares;
}

} // namespace

std::vector<std::byte> skin_message() {
  const render::HandSkin skin(Side::right);
  const hand::HandPose open = render::HandSkin::bind_pose(Side::right);
  render::Surface surface;
  skin.drape(open, Eigen::Vector3d::Zero(), surface);
  assert(surface.places.size() <= 0x10000);
  const SkinHead head{static_cast<std::uint32_t>(surface.places.size()),
                      static_cast<std::uint32_t>(surface.corners.size() / 3)};
  std::vector<std::byte> message(sizeof head + hand::joint_count * pose_bytes +
                                 surface.places.size() * skin_vertex_bytes +
                                 2 * surface.corners.size());
  WireWriter out(message);
  out.put(head);
  for (const Eigen::Isometry3d& joint : open.joints)
    write_pose(joint, out);
  for (const Eigen::Vector3f& place : surface.places)
    out.put(place);
  for (std::size_t at = 0; at < surface.places.size(); ++at)
    for (const render::JointShare& share : skin.influences(at))
      out.put(static_cast<std::uint8_t>(share.joint));
  for (std::size_t at = 0; at < surface.places.size(); ++at)
    out.put(shares_of(skin.influences(at)));
  for (const std::uint32_t corner : surface.corners)
    out.put(static_cast<std::uint16_t>(corner));
  return message;
}

} // namespace nendo::web
