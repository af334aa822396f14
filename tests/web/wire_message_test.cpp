// The wire that hands draw, for clients.

#include <cstring>

#include <doctest/doctest.h>

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
}

} // namespace wire_message_test
