// Timelines that an earlier program made of recordings, with the shapes that it made of them.

#include <cstdint>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "support/recorded_rounding.hpp"
#include "timeline/player.hpp"
#include "timeline/timeline.hpp"

namespace kept_timelines_test {

using namespace nendo;
using namespace nendo::timeline;

namespace {

struct Kept {
  const char* name;
  const char* model;
  std::uint64_t vertices;
  std::uint32_t crc;
};
constexpr Kept all_kept[] = {
    {"type1", "face689.obj", 689, 3508920352},   {"type2", "face689.obj", 689, 3230602407},
    {"clay", "face689.obj", 689, 1671154023},    {"mask", "face689.obj", 689, 2700114457},
    {"models", "face689.obj", 2637, 1996880021}, {"puppet", "face689.obj", 689, 1748934254},
    {"cut", "moai.obj", 6112, 3321989196},
};

} // namespace

TEST_SUITE("kept_timelines") {
  TEST_CASE("timelines of an earlier program play to its shapes, bit for bit") {
    for (const Kept& kept : all_kept) {
      CAPTURE(kept.name);
      const auto mesh = deform::read_mesh(std::filesystem::path(NENDO_MODELS) / kept.model);
      REQUIRE(mesh);
      const auto timeline = read_timeline(std::filesystem::path(NENDO_KEPT_TIMELINES) /
                                          (std::string(kept.name) + ".timeline.toml"));
      CAPTURE((timeline ? std::string() : timeline.error().message));
      REQUIRE(timeline);
      auto player = Player::make(*timeline, *mesh);
      REQUIRE(player);
      while ((*player)->next())
        CHECK((*player)->stats().failed == 0);
      const recording::ShapeSum sum = recording::sum_of((*player)->final_shape());
      CHECK(sum.vertices == kept.vertices);
      if (test::rounds_as_recorded()) CHECK(sum.crc == kept.crc);
    }
  }
}

} // namespace kept_timelines_test
