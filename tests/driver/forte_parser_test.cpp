#include "forte/forte_parser.hpp"

#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/captures.hpp"
#include "support/parser_laws.hpp"

namespace forte_parser_test {

using namespace nendo;
using namespace nendo::driver::forte;

namespace {

using nendo::test::bytes_of;
using nendo::test::joined;
using Bytes = nendo::test::StreamBytes;

/// Sensors first, first+1 ...; the layout as published.
Bytes frame_of(int first, int battery = 100) {
  Bytes bytes = bytes_of({0xF0, 0x01, 0x0B});
  for (int k = 0; k < 10; ++k)
    bytes.push_back(static_cast<std::byte>(first + k));
  bytes.push_back(static_cast<std::byte>(battery));
  bytes.push_back(std::byte{0xF7});
  return bytes;
}

Bytes motion_frame() {
  return bytes_of({0xF0, 0x02, 0x0C, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 0xF7});
}

using Firsts = std::vector<int>;
using Outcome = test::Outcome<Record>;

Outcome parse(std::span<const std::byte> input) {
  Outcome outcome = test::parse<Record>(Parser(), input, 15);
  CHECK(outcome.counters.record_bytes == 15 * outcome.counters.records);
  return outcome;
}

} // namespace

TEST_SUITE("forte_parser") {
  TEST_CASE("empty input yields no record") {
    CHECK(parse({}).firsts().empty());
  }

  TEST_CASE("a good frame is delivered as it was sent") {
    Parser parser;
    int records = 0;
    parser.push(bytes_of({0xF0, 0x01, 0x0B, 0, 1, 20, 30, 40, 50, 60, 70, 126, 127, 99, 0xF7}),
                [&](const Record& record) {
                  ++records;
                  CHECK(record.flexion ==
                        std::array<std::uint8_t, 10>{0, 1, 20, 30, 40, 50, 60, 70, 126, 127});
                  CHECK(record.battery == 99);
                });
    CHECK(records == 1);
    CHECK(parser.pending() == 0);
  }

  TEST_CASE("two frames in a row are two") {
    const Outcome outcome = parse(joined({frame_of(9), frame_of(50)}));
    CHECK(outcome.firsts() == Firsts{9, 50});
    CHECK(outcome.counters.discarded_bytes == 0);
  }

  TEST_CASE("garbage before the first frame costs none, and the end of one is no bad record") {
    for (const Bytes& garbage :
         {bytes_of({1, 2, 3}), bytes_of({0x0B, 5, 6, 0xF7}), bytes_of({0xFF, 0x80, 0x00})}) {
      const Outcome outcome = parse(joined({garbage, frame_of(9), frame_of(50)}));
      CHECK(outcome.firsts() == Firsts{9, 50});
      CHECK(outcome.counters.discarded_bytes == garbage.size());
      CHECK(outcome.counters.bad_records == 0);
    }
  }

  TEST_CASE("a truncated frame is held back, and dropped when the next one begins") {
    for (std::size_t length = 1; length < 15; ++length) {
      CAPTURE(length);
      Bytes half = frame_of(9);
      half.resize(length);
      CHECK(parse(half).pending == length);
      const Outcome outcome = parse(joined({frame_of(1), half, frame_of(50)}));
      CHECK(outcome.firsts() == Firsts{1, 50});
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == length);
    }
  }

  TEST_CASE("an over-long or too short frame is dropped alone and counted once") {
    for (const std::size_t surplus : {std::size_t{1}, std::size_t{2}, std::size_t{200}}) {
      Bytes longer = frame_of(9);
      longer.insert(longer.end() - 1, surplus, std::byte{5});
      const Outcome outcome = parse(joined({frame_of(1), longer, frame_of(50)}));
      CHECK(outcome.firsts() == Firsts{1, 50});
      CHECK(outcome.counters.bad_records == 1);
      CHECK(outcome.counters.discarded_bytes == 15 + surplus);
    }
    Bytes shorter = frame_of(9);
    shorter.erase(shorter.begin() + 4);
    const Outcome outcome = parse(joined({frame_of(1), shorter, frame_of(50)}));
    CHECK(outcome.firsts() == Firsts{1, 50});
    CHECK(outcome.counters.bad_records == 1);
  }

  TEST_CASE("counts above 127 count as 127, are counted, and the frame is read") {
    Bytes high = frame_of(9);
    high[3] = std::byte{128};
    high[12] = std::byte{0xFF};
    const Outcome outcome = parse(joined({frame_of(1), high, frame_of(50)}));
    CHECK(outcome.firsts() == Firsts{1, 127, 50});
    CHECK(outcome.counters.clamped == 2);
    CHECK(outcome.counters.bad_records == 0);
  }

  TEST_CASE("a frame with a bad end, beginning, kind or length is dropped alone") {
    struct Damage {
      std::size_t at;
      int to;
    };
    for (const Damage& damage :
         {Damage{14, 0x00}, Damage{14, 0x77}, Damage{0, 0x70}, Damage{1, 0x03}, Damage{2, 0x0C},
          Damage{7, 0xF7}, Damage{7, 0xF0}}) {
      CAPTURE(damage.at);
      CAPTURE(damage.to);
      Bytes bad = frame_of(9);
      bad[damage.at] = static_cast<std::byte>(damage.to);
      const Outcome outcome = parse(joined({frame_of(1), bad, frame_of(50), frame_of(60)}));
      CHECK(outcome.firsts() == Firsts{1, 50, 60});
      CHECK(outcome.counters.bad_records >= 1);
      CHECK(outcome.counters.bad_records <= 2); // a begin or end within breaks it in two
      CHECK(outcome.counters.discarded_bytes == 15);
    }
  }

  TEST_CASE("frames of motion are passed over, whatever they hold") {
    Bytes odd = motion_frame();
    odd.insert(odd.begin() + 5, 100, std::byte{0xEE});
    const Outcome outcome = parse(
        joined({motion_frame(), frame_of(9), motion_frame(), motion_frame(), frame_of(50), odd}));
    CHECK(outcome.firsts() == Firsts{9, 50});
    CHECK(outcome.counters.bad_records == 0);
    CHECK(outcome.counters.discarded_bytes == 4 * 16 + 100);
    CHECK(outcome.pending == 0);
  }

  TEST_CASE("the battery may say anything") {
    for (int battery = 0; battery <= 0xFF; ++battery) {
      if (battery == 0xF0 || battery == 0xF7) continue;
      CHECK(parse(frame_of(9, battery)).firsts() == Firsts{9});
    }
  }

  TEST_CASE("where a Forte stream is cut makes no difference") {
    Bytes bad = frame_of(3);
    bad[4] = std::byte{0xF0};
    Bytes longer = frame_of(3);
    longer.insert(longer.begin() + 8, 9, std::byte{1});
    const Bytes stream =
        joined({bytes_of({7, 0xF7, 8}), frame_of(1), motion_frame(), frame_of(2), bad, longer,
                bytes_of({0xF0, 0xF0}), frame_of(4), bytes_of({0xF7}), frame_of(5)});
    const auto value_of = [](const Record& record) { return record.flexion[0]; };
    CHECK(test::values_however_cut<Record>(Parser(), {stream, 15}, value_of) == Firsts{1, 2, 4, 5});
  }

  TEST_CASE("every byte of a Forte stream is accounted for, however it is mutilated") {
    std::mt19937 random(5);
    std::uint64_t records = 0;
    for (int round = 0; round < 400; ++round) {
      Bytes stream;
      for (int k = 0; k < 30; ++k) {
        const Bytes next = k % 5 == 4 ? motion_frame() : frame_of(static_cast<int>(random() % 118));
        stream.insert(stream.end(), next.begin(), next.end());
      }
      const auto damages = random() % 10;
      test::mutilate(stream, damages, random);
      const std::uint64_t here = parse(stream).counters.records;
      CHECK(here + damages >= 24); // each costs one frame at most
      records += here;
    }
    CHECK(records > 400 * 15);
  }

  TEST_CASE("after a reset the unfinished frame is discarded") {
    Parser parser;
    int records = 0;
    const auto count = [&](const Record&) { ++records; };
    const Bytes frame = frame_of(9);
    parser.push(std::span(frame).first(5), count);
    parser.reset();
    parser.count_discarded(7);
    parser.push(std::span(frame).subspan(5), count); // its end, which is no bad record
    parser.push(frame_of(50), count);
    CHECK(records == 1);
    CHECK(parser.counters().discarded_bytes == 15 + 7);
    CHECK(parser.counters().bytes == 15 + 7 + 15);
    CHECK(parser.counters().bad_records == 0);
  }

  TEST_CASE("a file of frames yields what was worked out for it by hand") {
    test::reads_as_expected<Record>(Parser(), {"forte_stream.bin", 15}, [](const Record& record) {
      std::string line;
      for (std::size_t k = 0; k < sensor_count; ++k)
        line += (k == 0 ? "" : " ") + std::string(name_of(slots[k])) + "=" +
                std::to_string(record.flexion[k]);
      return line;
    });
  }
}

} // namespace forte_parser_test
