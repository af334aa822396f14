#include "cyberglove/cyberglove_parser.hpp"

#include <array>
#include <bit>

#include <doctest/doctest.h>

namespace channel_map_test {

using namespace nendo;
using nendo::driver::cyberglove::make_channel_map;

namespace {

constexpr SensorMask everything{0xFFFFFF};

} // namespace

TEST_SUITE("channel_map") {
  TEST_CASE("with the masks of the two gloves it is the published table") {
    constexpr std::array of_22{0,  1,  2,  3,  4,  5,  6,  8,  9,  10, 11,
                               12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22};
    constexpr std::array of_18{0, 1, 2, 3, 4, 5, 8, 9, 11, 12, 13, 15, 16, 17, 19, 20, 21, 22};
    const auto large = make_channel_map(sensors_22, everything, 24);
    REQUIRE(large.count == of_22.size());
    for (std::size_t k = 0; k < of_22.size(); ++k)
      CHECK(large.slot[k] == of_22[k]);
    const auto small = make_channel_map(sensors_18, everything, 24);
    REQUIRE(small.count == of_18.size());
    for (std::size_t k = 0; k < of_18.size(); ++k)
      CHECK(small.slot[k] == of_18[k]);
  }

  TEST_CASE("masked sensors are left out, and the list is cut at the number of values") {
    const SensorMask no_thumb{0xFFFFF0};
    const auto map = make_channel_map(sensors_22, no_thumb, 3);
    REQUIRE(map.count == 3);
    CHECK(map.slot[0] == static_cast<int>(Sensor::index_mcp));
    CHECK(map.slot[2] == static_cast<int>(Sensor::index_dip));
    CHECK(map.sensors() == SensorMask{0x70});
    CHECK(make_channel_map(sensors_22, SensorMask{0}, 24).count == 0);
  }

  TEST_CASE("high-resolution records carry the full glove's 22 values") {
    using nendo::driver::cyberglove::hi_res_channels;
    CHECK(hi_res_channels.count == 22);
    CHECK(hi_res_channels.sensors() == sensors_22);
  }

  TEST_CASE("the sensors of a map are those it was made of") {
    for (std::uint32_t bits = 1; bits < (1U << 24U); bits = bits * 3 + 1) {
      const auto map = make_channel_map(SensorMask{bits}, everything, 24);
      CHECK(map.sensors().bits == (bits & 0xFFFFFFU));
      CHECK(map.count == static_cast<std::size_t>(std::popcount(bits & 0xFFFFFFU)));
    }
  }
}

} // namespace channel_map_test
