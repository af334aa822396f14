// The skin of hands for clients. tools/check-browser compares what the page's shader makes of it.

#include <cstring>
#include <numeric>

#include <doctest/doctest.h>

#include "render/hand_skin.hpp"
#include "web/skin_message.hpp"
#include "web/wire.hpp"

namespace skin_message_test {

using namespace nendo;
using namespace nendo::web;

namespace {

/// Takes the numbers of a message, in its order.
struct Reader {
  std::vector<std::byte> bytes;
  std::size_t at = 0;

  template <class T>
  T next() {
    T value;
    REQUIRE(at + sizeof value <= bytes.size());
    std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
    return value;
  }
  Eigen::Vector3f next_place() {
    const auto x = next<float>(), y = next<float>(), z = next<float>();
    return {x, y, z};
  }
};

} // namespace

TEST_SUITE("skin_message") {
  TEST_CASE("the message has the open hand's joints, and its skin with weights that sum to 255") {
    const render::HandSkin skin(Side::right);
    const hand::HandPose open = render::HandSkin::bind_pose(Side::right);
    render::Surface surface;
    skin.drape(open, Eigen::Vector3d::Zero(), surface);
    Reader in{skin_message()};
    REQUIRE(in.next<std::uint32_t>() == surface.places.size());
    REQUIRE(3 * in.next<std::uint32_t>() == surface.corners.size());
    for (const Eigen::Isometry3d& joint : open.joints) {
      CHECK((in.next_place().cast<double>() - joint.translation()).norm() < 1e-7);
      const auto x = in.next<float>(), y = in.next<float>(), z = in.next<float>(),
                 w = in.next<float>();
      const Eigen::Quaternionf turn(w, x, y, z);
      CHECK(turn.cast<double>().angularDistance(Eigen::Quaterniond(joint.linear())) < 1e-3);
    }
    for (const Eigen::Vector3f& place : surface.places)
      REQUIRE(in.next_place() == place);
    for (std::size_t at = 0; at < surface.places.size(); ++at)
      for (const render::JointShare& share : skin.influences(at))
        REQUIRE(in.next<std::uint8_t>() == static_cast<std::uint8_t>(share.joint));
    for (std::size_t at = 0; at < surface.places.size(); ++at) {
      const auto shares = in.next<std::array<std::uint8_t, 4>>();
      CHECK(std::accumulate(shares.begin(), shares.end(), 0) == 255);
      for (std::size_t rank = 0; rank < shares.size(); ++rank)
        CHECK(std::abs(shares[rank] / 255.0F - skin.influences(at)[rank].weight) < 2.1F / 255.0F);
    }
    for (const std::uint32_t corner : surface.corners)
      REQUIRE(in.next<std::uint16_t>() == corner);
    CHECK(in.at == in.bytes.size());
  }
}

} // namespace skin_message_test
