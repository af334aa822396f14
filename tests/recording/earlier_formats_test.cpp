// Chunks of the setup as earlier formats had them, which end sooner.

#include <nendo/recording/take_reader.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <doctest/doctest.h>

#include "support/takes.hpp"

namespace earlier_formats_test {

using namespace nendo;
using namespace nendo::recording;
using flow::Mode;

namespace {

/// What a setup's chunks of that type hold, in their order.
std::vector<std::vector<std::byte>> payloads_of(const Setup& setup, ChunkType type) {
  std::uint32_t chunks = 0;
  const auto bytes = setup_bytes(setup, chunks);
  auto reader = ChunkReader::of(bytes, "test");
  REQUIRE(reader);
  std::vector<std::vector<std::byte>> payloads;
  while (const auto chunk = reader->next())
    if (chunk->type == type) payloads.emplace_back(chunk->payload.begin(), chunk->payload.end());
  return payloads;
}

} // namespace

TEST_SUITE("earlier_formats") {
  TEST_CASE("a hand of format 1.0, which ends before what was learned, is read") {
    constexpr auto type = chunk_type("HAND");
    Setup setup;
    for (const auto& payload :
         payloads_of(test::setup_of(test::LoopUnderTest(Mode::type1)), type)) {
      const std::span whole(payload);
      // It ends with three flags: that nothing was learned, that it is no layer (since 1.6), and
      // that hands are average ones (since 1.7).
      const auto reads_without = [&](std::size_t bytes) {
        Setup cut = setup;
        return read_setup_chunk(type, whole.first(whole.size() - bytes), cut);
      };
      CHECK_FALSE(reads_without(4));
      CHECK(reads_without(1));
      CHECK(reads_without(2));
      REQUIRE(read_setup_chunk(type, whole.first(whole.size() - 3), setup));
      CHECK_FALSE(setup.hands.back().wearer.learned.has_value());
    }
    CHECK(setup.hands.size() == 2);
  }

  TEST_CASE(
      "a hand of format 1.8 or 1.11, whose shape had fewer terms, is read with zeros for them") {
    auto source = test::setup_of(test::LoopUnderTest(Mode::type1));
    for (flow::HandInput& hand : source.hands)
      for (const Side side : {Side::left, Side::right})
        hand.wearer.of(side).size.shape.terms.fill(0.004);
    constexpr auto type = chunk_type("HAND");
    Setup setup;
    for (const auto& payload : payloads_of(source, type)) {
      const std::span whole(payload);
      constexpr std::size_t later_bytes = 2 * 2 * 8; // of two terms of two hands
      Setup cut = setup, of_1_11 = setup;
      CHECK_FALSE(read_setup_chunk(type, whole.first(whole.size() - 8), cut));
      REQUIRE(read_setup_chunk(type, whole.first(whole.size() - later_bytes), of_1_11));
      REQUIRE(read_setup_chunk(type, whole.first(whole.size() - 2 * later_bytes), setup));
      const auto terms_of = [](const Setup& of) {
        return of.hands.back().wearer.of(Side::left).size.shape.terms;
      };
      CHECK(terms_of(of_1_11)[27] == 0.004);
      CHECK(terms_of(of_1_11)[28] == 0.0);
      CHECK(terms_of(setup)[25] == 0.004);
      CHECK(terms_of(setup)[26] == 0.0);
      CHECK(terms_of(setup)[29] == 0.0);
    }
    CHECK(setup.hands.size() == 2);
  }

  TEST_CASE("a loop of format 1.4 undoes pulls by the rule of its time") {
    constexpr auto type = chunk_type("LOOP");
    int loops = 0;
    for (const auto& payload :
         payloads_of(test::setup_of(test::LoopUnderTest(Mode::type1)), type)) {
      const std::span whole(payload);
      Setup now, then;
      REQUIRE(read_setup_chunk(type, whole, now));
      CHECK(now.loop->options.pull_is_step);
      // That rule, since 1.6 the brushes, since 1.7 how much of the volume is kept, what holds, and
      // whether there is a table, and since 1.13 how type 2 measures.
      constexpr std::size_t since = 1 + 13 + 9 + 1 + 1;
      REQUIRE(read_setup_chunk(type, whole.first(whole.size() - since), then));
      CHECK_FALSE(then.loop->options.pull_is_step);
      CHECK(then.loop->origins.size() == now.loop->origins.size());
      ++loops;
    }
    CHECK(loops == 1);
  }

  TEST_CASE("a loop of format 1.12 has the rules of its time in type 2 and in clay") {
    constexpr auto type = chunk_type("LOOP");
    const auto payload =
        payloads_of(test::setup_of(test::LoopUnderTest(Mode::type2)), type).front();
    const std::span whole(payload);
    Setup now, then;
    REQUIRE(read_setup_chunk(type, whole, now));
    CHECK(now.loop->options.sculptor.type2_along_surface);
    CHECK(now.loop->options.sculptor.clay_scales_few_vertices);
    REQUIRE(read_setup_chunk(type, whole.first(whole.size() - 1), then));
    CHECK_FALSE(then.loop->options.sculptor.type2_along_surface);
    CHECK_FALSE(then.loop->options.sculptor.clay_scales_few_vertices);
  }
}

} // namespace earlier_formats_test
