// The shipped face in type 1 and in type 2: its mouth opens in both, and both are replayed.

#include <memory>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/recording/loop_replay.hpp>

#include "support/takes.hpp"

namespace puppet_replay_test {

using namespace nendo;
using namespace nendo::recording;
using flow::Mode;
using test::RecordedLoop;

namespace {

// ICT FaceKit's vertices in the middle of the lips, by the 68-point scheme.
constexpr Eigen::Index upper_inner = 5533, upper_outer = 0, lower_inner = 5517, lower_outer = 5518;

/// A glove whose thumb alone is bent.
GloveSample thumb_sample(Side side, int counts, HostTime arrival) {
  GloveSample sample = test::bent_sample(side, 0, arrival);
  for (const Sensor sensor : {Sensor::thumb_mcp, Sensor::thumb_ip}) {
    std::uint16_t& value = sample.raw[static_cast<std::size_t>(sensor)].value;
    value = static_cast<std::uint16_t>(value + counts);
  }
  return sample;
}

/// A recorded loop in which hands play the shipped face.
struct PlayedFace {
  explicit PlayedFace(Mode mode) : live(mode) {
    auto read = deform::read_mesh(NENDO_MODELS "/face.obj");
    auto puppet = puppet::read_puppet(NENDO_MODELS "/face.puppet.toml");
    REQUIRE(read);
    REQUIRE(puppet);
    auto& test = live.test;
    test.model = *std::move(read);
    test.options.rig = std::make_shared<const puppet::Rig>(*puppet, test.model);
    test.options.sculptor.deformer.supports = test.options.rig->supports();
    test.loop =
        std::make_unique<flow::DeformLoop>(test.model, test.placement, test.inputs, test.options);
    live.setup = test::setup_of(test);
    live.record();
  }

  /// After a tick in which the right thumb, which plays the jaw, is bent so far.
  const deform::Points& after(int counts) {
    now += std::chrono::milliseconds(11);
    live.test.rings[0]->try_push(test::bent_sample(Side::left, 0, now));
    live.test.rings[1]->try_push(thumb_sample(Side::right, counts, now));
    shape = live.test.vertices_of(live.test.frame_after_tick(tick++));
    return shape;
  }
  /// How far the lips are apart.
  double gap_cm() const { return (shape.col(upper_inner) - shape.col(lower_inner)).norm(); }
  double moved_cm(Eigen::Index vertex) const {
    return (shape.col(vertex) - live.test.model.vertices.col(vertex)).norm();
  }

  RecordedLoop live;
  deform::Points shape;
  HostTime now = HostClock::now();
  std::uint64_t tick = 0;
};

/// REQUIREs that the recording's shape is the loop's, bit for bit.
void require_replay(PlayedFace& face) {
  const auto recorded = face.live.end();
  REQUIRE(recorded);
  auto reader = TakeReader::open(face.live.path);
  REQUIRE(reader);
  auto replay = LoopReplay::make(reader->setup(), face.live.test.model);
  REQUIRE(replay);
  while (const auto entry = reader->next())
    (*replay)->feed(*entry);
  CHECK((*replay)->is_exact());
  REQUIRE((*replay)->loop().final_shape() == face.live.test.loop->final_shape());
}

} // namespace

TEST_SUITE("puppet_replay") {
  TEST_CASE("the face's mouth opens in type 2 as in type 1, and is replayed bit for bit") {
    constexpr int bent = 60;
    PlayedFace type1(Mode::type1), type2(Mode::type2);
    for (PlayedFace* const face : {&type1, &type2}) {
      CAPTURE(name_of(face->live.test.options.sculptor.mode));
      face->after(0);
      CHECK(face->gap_cm() < 0.1); // the lips touch
      for (int counts = 0; counts <= bent; ++counts)
        face->after(counts);
      CHECK(face->gap_cm() > 1.0);
      CHECK(face->moved_cm(lower_outer) > 1.0);
      CHECK(face->moved_cm(upper_outer) < 1e-4); // a point of the puppet that stays
      CHECK(face->moved_cm(upper_inner) < 0.1 * face->gap_cm());
      face->after(bent);
    }
    CHECK(type2.gap_cm() == doctest::Approx(type1.gap_cm()).epsilon(0.01));
    for (int counts = bent; counts >= 0; --counts) // a leap would be a sensor's fault
      type2.after(counts);
    CHECK(type2.gap_cm() < 0.1);
    for (int counts = 0; counts <= bent; ++counts)
      type2.after(counts);
    require_replay(type1);
    require_replay(type2);
  }
}

} // namespace puppet_replay_test
