// Recordings that an earlier program made: of all modes, and with commands of all kinds.

#include <nendo/recording/loop_replay.hpp>

#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/recording/take_reader.hpp>

#include "support/recorded_rounding.hpp"

namespace kept_takes_test {

using namespace nendo;
using namespace nendo::recording;

TEST_SUITE("kept_takes") {
  TEST_CASE("recordings of an earlier program replay to its shapes, bit for bit") {
    const std::filesystem::path folder = NENDO_KEPT_TAKES;
    for (const std::string name : {"type1", "type2", "clay", "mask", "models", "puppet", "cut"}) {
      CAPTURE(name);
      const auto mesh = deform::read_mesh(std::filesystem::path(NENDO_MODELS) /
                                          (name == "cut" ? "moai.obj" : "face689.obj"));
      REQUIRE(mesh);
      auto reader = TakeReader::open(folder / (name + ".nendo"));
      REQUIRE(reader);
      auto replay = LoopReplay::make(reader->setup(), *mesh);
      REQUIRE(replay);
      while (const auto entry = reader->next())
        (*replay)->feed(*entry);
      CHECK((*replay)->is_exact());
      REQUIRE(reader->ending());
      REQUIRE(reader->ending()->shape);
      const ShapeSum sum = sum_of((*replay)->loop().final_shape());
      CHECK(sum.vertices == reader->ending()->shape->vertices);
      if (test::rounds_as_recorded()) CHECK(sum == *reader->ending()->shape);
    }
  }
}

} // namespace kept_takes_test
