// The wire that hands draw, and masks, for clients.

#include <cstring>

#include <doctest/doctest.h>

#include <nendo/puppet/puppet_edit.hpp>

#include "web/wire.hpp"

namespace wire_message_test {

using namespace nendo;

TEST_SUITE("wire_message") {
  TEST_CASE("clients get the ends of a wire on the stage while it is drawn, and then none") {
    flow::Frame frame;
    frame.units_per_metre = 4.0;
    frame.wire.begin(0.01);
    for (const double z : {1.0, 0.0, -1.0})
      frame.wire.draw_to({{-2.0, 1.0, z}, {2.0, 1.0, z}});
    const auto message = web::wire_message(frame);
    const std::size_t count = frame.wire.places().size();
    REQUIRE(count > 1);
    REQUIRE(message.size() == 4 + 24 * count);
    CHECK(message[0] == std::byte{11});
    CHECK(message[2] == static_cast<std::byte>(count));
    std::array<float, 6> newest{};
    std::memcpy(newest.data(), message.data() + message.size() - sizeof newest, sizeof newest);
    CHECK(newest == std::array{-0.5F, 0.25F, -0.25F, 0.5F, 0.25F, -0.25F});
    frame.wire.end();
    CHECK(web::wire_message(frame).size() == 4);
  }

  TEST_CASE("clients get the masks of fingertips, and whether they are inverted") {
    const puppet::Rig nothing(puppet::Puppet{}, deform::Points(3, 0));
    const std::array stroke{Eigen::Vector3d(1.0, 2.0, 3.0)};
    auto masked = puppet::with_masks(nothing, stroke, 0.5);
    REQUIRE(masked);
    masked->inverted = true;
    const puppet::Rig rig(*masked, deform::Points(3, 0));
    const auto message = web::message_of(7, &rig);
    REQUIRE(message.size() == 8 + 4 + 16);
    CHECK(message[1] == std::byte{1});
    CHECK(message[8] == std::byte{1});
    std::array<float, 4> mask{};
    std::memcpy(mask.data(), message.data() + 12, sizeof mask);
    CHECK(mask == std::array{1.0F, 2.0F, 3.0F, 0.5F});
    CHECK(web::message_of(0, nullptr).size() == 8 + 4);
  }
}

} // namespace wire_message_test
