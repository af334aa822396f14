#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <random>
#include <thread>

#include <nendo/hand/hand_body.hpp>

#include "publish/publish_fixtures.hpp"
#include "publish/segment.hpp"

namespace segment_test {

using namespace nendo;
using namespace nendo::publish;
using deform::Points;
using flow::Mode;
using test::LoopUnderTest;
using test::MappedSegment;
using test::Player;
using test::segment_name;

namespace {

/// Checks the published states of both hands against the frame's.
void check_states(const MappedSegment& segment, std::uint64_t number, const flow::Frame& frame) {
  nendo_publish_states states{};
  REQUIRE(nendo_publish_read_states(segment.base(), number, &states) != 0);
  CHECK(states.number == number);
  CHECK(states.model == frame.model);
  for (std::size_t side = 0; side < 2; ++side) {
    const flow::HandFrame& hand = frame.hands[side];
    const nendo_publish_hand_state& state = states.hands[side];
    CHECK(state.flags == 0); // neither a switch nor a tracker
    for (std::size_t at = 0; at < hand::angle_count; ++at)
      CHECK(state.angles[at] == hand.angles[hand::angle_at(at)]);
    CHECK(state.sampled_ns == hand.sampled.time_since_epoch() / std::chrono::nanoseconds(1));
    CHECK(state.sampled_ns > 0);
    CHECK(state.sampled_ns <= frame.woke.time_since_epoch() / std::chrono::nanoseconds(1));
    CHECK(state.tracked_ns == 0);
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      CHECK(state.forearm.position[axis] ==
            static_cast<float>(hand.T_stage_wrist.translation()[axis]));
  }
}

} // namespace

TEST_SUITE("segment") {
  TEST_CASE("a frame's hands and vertices come out as they are, whatever changed since") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      LoopUnderTest test(mode, {.rings_of_ball = 12});
      SegmentPublisher publisher(segment_name("frames"), {});
      test::attach(test, {&publisher});
      REQUIRE(publisher.begin(test::outline_of(test)));
      const MappedSegment segment(segment_name("frames"));
      CHECK(segment.newest() == 0);
      CHECK(segment.header().vertices == test.model.vertices.cols());
      CHECK(segment.setup().mode == (mode == Mode::type1 ? 1 : 2));
      CHECK((segment.rest() - test.model.vertices).cwiseAbs().maxCoeff() < test::float_gap);
      Player player(test);
      Points before = test.model.vertices;
      std::uint64_t different = 0, changes = 0;
      for (std::uint64_t number = 1; number <= 150; ++number) {
        const flow::Frame& frame = player.next();
        REQUIRE(segment.newest() == number);
        const auto record = segment.record(number);
        const auto& head = test::head_of(record);
        CHECK(head.number == number);
        CHECK(head.tick == frame.tick);
        CHECK(head.rest_changes == frame.rest_changes);
        CHECK(head.shape_jumps == frame.shape_jumps);
        CHECK(head.woke_ns == frame.woke.time_since_epoch() / std::chrono::nanoseconds(1));
        CHECK(segment.header().heartbeat_ns == head.woke_ns);
        CHECK(((head.flags & NENDO_PUBLISH_HELD) != 0) == frame.held);
        for (std::size_t side = 0; side < 2; ++side) {
          REQUIRE((head.hands[side].flags & NENDO_PUBLISH_PRESENT) != 0);
          for (std::size_t at = 0; at < hand::joint_count; ++at) {
            const auto& [place, turn] = head.hands[side].joints[at];
            const auto& pose = frame.hands[side].pose.joints[at];
            const Eigen::Quaterniond read(
                Eigen::Quaternionf(turn[3], turn[0], turn[1], turn[2]).cast<double>());
            for (Eigen::Index axis = 0; axis < 3; ++axis)
              CHECK(place[axis] == static_cast<float>(pose.translation()[axis]));
            CHECK((read.toRotationMatrix() - pose.linear()).cwiseAbs().maxCoeff() < 1e-6);
          }
        }
        check_states(segment, number, frame);
        const Points expected = test.vertices_of(frame);
        // unpack() gives untouched coordinates their original bits, which float does not hold.
        CHECK((segment.shape(number) - expected).cwiseAbs().maxCoeff() < test::float_gap);
        const bool counted = head.shape_changes != changes;
        CHECK((counted || expected == before));
        different += expected != before ? 1U : 0U;
        changes = head.shape_changes;
        before = expected;
      }
      CHECK(different > 15);
      CHECK(publisher.counts().records == 150);
      CHECK(publisher.counts().shape_changes == changes);
      publisher.end();
      CHECK(segment.has_ended());
      CHECK(segment.newest() == 150); // and stays readable for who has it mapped
    }
  }

  TEST_CASE("the states of hands have switch, tracker, touch, and which angles are measured") {
    flow::Frame frame;
    frame.model = 3;
    flow::HandFrame& right = frame.hands[1];
    right.present = right.tracked = right.lost = true;
    right.wrist_switch = WristSwitch::on;
    right.tracked_at = HostTime(std::chrono::nanoseconds(77));
    right.sensors.add(Sensor::index_mcp);
    right.sensors.add(Sensor::index_pip);
    right.sensors.add(Sensor::wrist_yaw);
    right.left_out.add(Sensor::index_pip);
    // The only present hand is body 0. Part 5 is the end of its index finger, part 20 of its palm.
    deform::ClayContact light;
    light.part = 5;
    light.load_mm = 0.25F;
    deform::ClayContact strong;
    strong.part = 20;
    strong.load_mm = strong.pressed_mm = 9.0F;
    frame.contacts.take(std::array{light, strong});
    const nendo_publish_states states = states_of(frame, 8);
    CHECK(states.number == 8);
    CHECK(states.model == 3);
    const nendo_publish_hand_state& state = states.hands[1];
    CHECK(state.flags == (NENDO_PUBLISH_HAS_SWITCH | NENDO_PUBLISH_SWITCH_ON |
                          NENDO_PUBLISH_TRACKED | NENDO_PUBLISH_LOST));
    CHECK(state.measured == (1U << hand::index_of(hand::Angle::index_mcp_flexion) |
                             1U << hand::index_of(hand::Angle::wrist_yaw)));
    CHECK(state.tracked_ns == 77);
    const std::array<float, 6> touch{0.0F, 0.25F, 0.0F, 0.0F, 0.0F, 1.0F};
    CHECK(std::equal(touch.begin(), touch.end(), state.touch));
    const nendo_publish_hand_state none{};
    CHECK(std::memcmp(&states.hands[0], &none, sizeof none) == 0);
  }

  TEST_CASE("a reader gets the radii of joints, and neither they nor states from an older writer") {
    LoopUnderTest test(Mode::type1, {.rings_of_ball = 8});
    SegmentPublisher publisher(segment_name("radii"), {});
    test::attach(test, {&publisher});
    auto outline = test::outline_of(test);
    outline.skeletons = {std::nullopt, hand::HandSkeleton(Side::right, {.length_m = 0.2})};
    REQUIRE(publisher.begin(outline));
    const MappedSegment segment(segment_name("radii"));
    float radii[2][NENDO_PUBLISH_JOINTS];
    REQUIRE(nendo_publish_read_radii(segment.base(), radii) != 0);
    const hand::JointRadii expected_m = hand::joint_radii_m(*outline.skeletons[1]);
    for (std::size_t at = 0; at < hand::joint_count; ++at)
      CHECK(radii[1][at] == static_cast<float>(expected_m[at]));
    CHECK(std::all_of(std::begin(radii[0]), std::end(radii[0]), [](float r) { return r == 0.0F; }));
    Player player(test);
    player.next();
    const auto bytes = segment.header().segment_bytes;
    std::vector<std::uint64_t> copy(bytes / 8);
    std::memcpy(copy.data(), segment.base(), bytes);
    auto& header = *reinterpret_cast<nendo_publish_header*>(copy.data());
    auto& setup = copy[header.setup_offset / 8];
    nendo_publish_states states{};
    CHECK(nendo_publish_read_states(copy.data(), 1, &states) == 1);
    CHECK(nendo_publish_read_radii(copy.data(), radii) == 1);
    reinterpret_cast<nendo_publish_setup&>(setup).radii_offset = 0;
    CHECK(nendo_publish_read_radii(copy.data(), radii) == 0);
    reinterpret_cast<nendo_publish_setup&>(setup).radii_offset = 0xFFFFFFF8U;
    CHECK(nendo_publish_read_radii(copy.data(), radii) == 0);
    header.states_offset = 0;
    CHECK(nendo_publish_read_states(copy.data(), 1, &states) == 0);
    CHECK(nendo_publish_is_usable(copy.data(), bytes) == 1);
    header.states_offset = bytes - 8;
    CHECK(nendo_publish_is_usable(copy.data(), bytes) == 0);
  }

  TEST_CASE("faces become triangles of the same area, over the same vertices") {
    LoopUnderTest test(Mode::type1, {.rings_of_ball = 8});
    SegmentPublisher publisher(segment_name("faces"), {});
    REQUIRE(publisher.begin(test::outline_of(test)));
    const MappedSegment segment(segment_name("faces"));
    std::vector<std::uint32_t> corners(std::size_t{3} * segment.header().triangles);
    nendo_publish_setup setup{};
    REQUIRE(nendo_publish_read_setup(segment.base(), &setup, corners.data(), nullptr));
    // A closed surface has twice as many triangles as vertices, less four (Euler), and the volume
    // of a ball's inscribed polyhedron.
    CHECK(corners.size() / 3 == 2 * (segment.header().vertices - 2));
    double volume = 0.0;
    for (std::size_t at = 0; at < corners.size(); at += 3) {
      Eigen::Matrix3d sides;
      for (Eigen::Index corner = 0; corner < 3; ++corner)
        sides.col(corner) = test.model.vertices.col(corners[at + static_cast<std::size_t>(corner)]);
      volume += sides.determinant() / 6.0;
    }
    CHECK(std::abs(volume) == doctest::Approx(4.0 / 3.0 * 3.14159265).epsilon(0.1));
  }

  TEST_CASE("a second loop keeps the segment, another model gets another one") {
    LoopUnderTest test(Mode::type1, {.rings_of_ball = 10});
    SegmentPublisher publisher(segment_name("second"), {});
    test::attach(test, {&publisher});
    REQUIRE(publisher.begin(test::outline_of(test)));
    const MappedSegment segment(segment_name("second"));
    Player player(test);
    for (int n = 0; n < 20; ++n)
      player.next();
    test.model.vertices *= 1.5;
    test::attach(test, {&publisher});
    REQUIRE(publisher.begin(test::outline_of(test)));
    CHECK_FALSE(segment.has_ended());
    CHECK(segment.setup().generation == 2);
    CHECK((segment.rest() - test.model.vertices).cwiseAbs().maxCoeff() < 2 * test::float_gap);
    Player second(test);
    const Points shape = test.vertices_of(second.next());
    CHECK(segment.newest() == 21); // numbers continue
    CHECK(test::head_of(segment.record(21)).generation == 2);
    CHECK((segment.shape(21) - shape).cwiseAbs().maxCoeff() < 2 * test::float_gap);

    LoopUnderTest larger(Mode::type1, {.rings_of_ball = 12});
    test::attach(larger, {&publisher});
    REQUIRE(publisher.begin(test::outline_of(larger)));
    CHECK(segment.has_ended());
    const MappedSegment other(segment_name("second"));
    CHECK(other.header().vertices == larger.model.vertices.cols());
    CHECK(other.newest() == 0);
  }

  TEST_CASE(
      "a stranger that may write, and writes garbage everywhere, changes nothing in the loop") {
    LoopUnderTest test(Mode::type1, {.rings_of_ball = 10});
    LoopUnderTest alone(Mode::type1, {.rings_of_ball = 10});
    SegmentPublisher publisher(segment_name("garbage"), {});
    test::attach(test, {&publisher});
    REQUIRE(publisher.begin(test::outline_of(test)));
    const std::string path = "/dev/shm/nendo-" + segment_name("garbage");
    REQUIRE(::chmod(path.c_str(), 0600) == 0); // its own user can
    const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
    const std::size_t words = plan_segment(test::outline_of(test)).segment_bytes / 8;
    void* const base = ::mmap(nullptr, 8 * words, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    REQUIRE(base != MAP_FAILED);
    std::atomic<bool> over{false};
    std::atomic<std::uint64_t> written{0};
    std::thread stranger([&] {
      auto* const garbage = static_cast<AtomicWord*>(base);
      for (std::mt19937_64 random(3); !over; ++written)
        garbage[random() % words].store(random(), std::memory_order_relaxed);
    });
    Player player(test);
    Player other(alone);
    for (int n = 0; n < 100 || written < 100'000; ++n)
      REQUIRE(test.vertices_of(player.next()) == alone.vertices_of(other.next()));
    over = true;
    stranger.join();
    ::munmap(base, 8 * words);
    CHECK(test.loop->stats().failed == alone.loop->stats().failed);
    CHECK(publisher.counts().records == test.loop->stats().ticks);
    publisher.end();
    CHECK(::access(path.c_str(), F_OK) != 0);
  }

  TEST_CASE("fields that do not fit are left out together, and marked") {
    LoopUnderTest test(Mode::type1, {.rings_of_ball = 8});
    SegmentPublisher publisher(segment_name("fields"), {});
    test::attach(test, {&publisher});
    auto outline = test::outline_of(test);
    outline.functions = 3;
    outline.max_fields = 1;
    REQUIRE(publisher.begin(outline));
    const MappedSegment segment(segment_name("fields"));
    Player player(test);
    for (int n = 0; n < 5; ++n)
      player.next();
    const auto record = segment.record(5);
    const auto& head = test::head_of(record);
    CHECK((head.flags & NENDO_PUBLISH_FIELDS_LEFT_OUT) != 0);
    CHECK(head.fields == 0);
    CHECK(head.fields_bytes == 0);
  }

  TEST_CASE("a reader takes no segment whose sizes lead outside of it") {
    LoopUnderTest test(Mode::type1, {.rings_of_ball = 8});
    SegmentPublisher publisher(segment_name("judge"), {});
    REQUIRE(publisher.begin(test::outline_of(test)));
    const MappedSegment segment(segment_name("judge"));
    const auto bytes = segment.header().segment_bytes;
    std::vector<std::uint64_t> copy(bytes / 8);
    const auto usable = [&] { return nendo_publish_is_usable(copy.data(), bytes) != 0; };
    const auto begin = [&] { std::memcpy(copy.data(), segment.base(), bytes); };
    begin();
    CHECK(usable());
    CHECK_FALSE(nendo_publish_is_usable(copy.data(), bytes - 8) != 0);
    CHECK_FALSE(nendo_publish_is_usable(copy.data(), 100) != 0);
    for (std::size_t at = 6; at < 13; ++at) { // offsets and strides
      begin();
      copy[at] = UINT64_MAX - 7;
      CHECK_FALSE(usable());
    }
    for (const std::size_t at : {0U, 1U, 16U}) { // magic, byte order, state
      begin();
      copy[at] = 0;
      CHECK_FALSE(usable());
    }
  }
}

} // namespace segment_test
