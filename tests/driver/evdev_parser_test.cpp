#include "evdev/evdev_parser.hpp"

#include <bit>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "evdev/input_device.hpp"
#include "support/parser_laws.hpp"

namespace evdev_parser_test {

using namespace nendo;
using namespace nendo::driver::evdev;

namespace {

using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;

/// An event by the layout of the kernel's documentation, not by its header: a time of two long
/// words, type and code of two bytes each, and a value of four.
Bytes event(std::uint16_t type, std::uint16_t code, std::int32_t value) {
  Bytes bytes(2 * sizeof(long), std::byte{0xA5});
  const auto add = [&](std::uint32_t number, unsigned size) {
    for (unsigned k = 0; k < size; ++k) {
      const unsigned shift = 8 * (std::endian::native == std::endian::little ? k : size - 1 - k);
      bytes.push_back(static_cast<std::byte>(number >> shift));
    }
  };
  add(type, 2);
  add(code, 2);
  add(static_cast<std::uint32_t>(value), 4);
  return bytes;
}

constexpr std::size_t size = 2 * sizeof(long) + 8;

std::vector<int> values_of(const Bytes& stream) {
  std::vector<int> values;
  for (const Event& one : test::parse<Event>(Parser(), stream, size).records)
    values.push_back(one.value);
  return values;
}

} // namespace

TEST_SUITE("evdev_parser") {
  TEST_CASE("nothing is no event, and a part of one is held") {
    CHECK(values_of({}).empty());
    Bytes part = event(3, 0, 7);
    part.pop_back();
    const auto outcome = test::parse<Event>(Parser(), part, size);
    CHECK(outcome.records.empty());
    CHECK(outcome.pending == size - 1);
  }

  TEST_CASE("an event has its type, code and value, whatever they are") {
    const auto outcome = test::parse<Event>(
        Parser(),
        joined({event(3, 5, -350), event(0xFFFF, 0xFFFE, std::numeric_limits<int>::min())}), size);
    REQUIRE(outcome.records.size() == 2);
    CHECK(outcome.records[0].type == 3);
    CHECK(outcome.records[0].code == 5);
    CHECK(outcome.records[0].value == -350);
    CHECK(outcome.records[1].type == 0xFFFF);
    CHECK(outcome.records[1].code == 0xFFFE);
    CHECK(outcome.records[1].value == std::numeric_limits<int>::min());
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("where a stream of events is cut makes no difference") {
    const Bytes stream = joined({event(2, 0, 1), event(2, 1, 2), event(0, 0, 0), event(1, 256, 4)});
    CHECK(test::values_however_cut<Event>(Parser(), {stream, size}, [](const Event& one) {
            return static_cast<int>(one.value);
          }) == std::vector<int>{1, 2, 0, 4});
  }

  TEST_CASE("every byte of mutilated events is accounted for") {
    std::mt19937 random(7);
    for (int round = 0; round < 200; ++round) {
      Bytes stream;
      for (int k = 0; k < 20; ++k)
        stream = joined({stream, event(3, static_cast<std::uint16_t>(k % 6), k)});
      test::mutilate(stream, random() % 10, random);
      test::parse<Event>(Parser(), stream, size);
    }
  }

  TEST_CASE("after a reset the next byte begins an event") {
    Parser parser;
    std::vector<int> values;
    const auto sink = [&](const Event& one) { values.push_back(one.value); };
    Bytes part = event(3, 0, 1);
    part.resize(11);
    parser.push(part, sink);
    parser.reset();
    parser.push(event(3, 0, 2), sink);
    CHECK(values == std::vector<int>{2});
    CHECK(parser.counters().discarded_bytes == 11);
  }
}

TEST_SUITE("evdev_kinds") {
  // Bitmaps of real devices, as /sys shows them on a machine with words of 64 bits.
  TEST_CASE("devices are known by their axes and buttons") {
    if (sizeof(long) != 8) return;
    struct Case {
      const char* device;
      InputBitmaps bitmaps;
      std::optional<InputKind> kind;
    };
    const std::string gamepad_keys = "7cdb000000000000 0 0 0 0";
    for (const Case& c :
         {Case{"SpaceNavigator", {"0\n", "3 0 0 0 0\n", "0\n", "3f\n"}, InputKind::six_absolute},
          Case{"SpaceNavigator, REL", {"0", "3 0 0 0 0", "3f", "0"}, InputKind::six_relative},
          Case{"Xbox pad", {"0", gamepad_keys, "0", "3003f"}, InputKind::gamepad},
          Case{"motion sensors of a pad", {"40", "0", "0", "3f"}, std::nullopt},
          Case{"mouse", {"0", "ff0000 0 0 0 0", "1943", "0"}, InputKind::mouse},
          Case{"touchpad", {"5", "e520 10000 0 0 0 0", "0", "661800011000003"}, std::nullopt},
          Case{"keyboard",
               {"0", "1000000000007 ff9f207ac14057ff febeffdfffefffff fffffffffffffffe", "0", "0"},
               std::nullopt},
          Case{"nothing", {"", "", "", ""}, std::nullopt},
          Case{"no numbers", {"x", "zz 0 y", "-1", "3f3f3f3f3f3f3f3f3f"}, std::nullopt}}) {
      CAPTURE(c.device);
      CHECK(kind_of(c.bitmaps) == c.kind);
    }
    CHECK(first_button_of("3 0 0 0 0") == 0x100);
    CHECK(first_button_of("ff0000 0 0 0 0") == 0x110);
    CHECK(first_button_of(gamepad_keys) == 0x130);
    CHECK(first_button_of("0") == 0);
  }
}

} // namespace evdev_parser_test
