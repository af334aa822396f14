#pragma once
// A ball to shape, and gloves that send what a test wants.

#include <memory>
#include <vector>

#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/sculptor.hpp>

#include "support/test_meshes.hpp"

namespace nendo::test {

/// Returns a sphere of radius 1 about the origin, of about 2 `rings` squared quads.
inline deform::Mesh ball(std::uint32_t rings) {
  return sphere(rings, 2 * rings, 1.0);
}

/// How much a shape of the ball in float may be off after a few strokes.
inline constexpr double float_gap = 2e-6;

/// Returns a sample of a relaxed hand that is bent further by so many counts at every finger's MCP
/// and PIP.
inline GloveSample bent_sample(Side side, int counts, HostTime arrival) {
  GloveSample sample;
  sample.side = side;
  sample.present = sensors_22;
  sample.arrival = arrival;
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    const auto offset = hand::default_calibration()[sensor].offset_counts;
    sample.raw[slot].value = static_cast<std::uint16_t>(offset + 20.0);
    if (name_of(sensor).ends_with("abduction") || name_of(sensor).starts_with("wrist")) {
      sample.raw[slot].value = static_cast<std::uint16_t>(offset);
    }
    if (name_of(sensor).ends_with("mcp") || name_of(sensor).ends_with("pip")) {
      sample.raw[slot].value = static_cast<std::uint16_t>(sample.raw[slot].value + counts);
    }
  }
  return sample;
}

/// Ends to which a wearer of these sensors would go with some that have slipped.
inline hand::CalibratedRange narrow_ends(Side side) {
  hand::CalibratedRange ends{side, {}};
  ends.counts.present = sensors_22;
  ends.counts.low_counts.fill(50.0);
  ends.counts.high_counts.fill(130.0);
  return ends;
}

/// The options of a test's loop.
struct LoopFixture {
  std::uint32_t rings_of_ball = 24; ///< how fine the model is
  double rate_hz = 1000.0;
  flow::SwitchAction switch_action = flow::SwitchAction::none;
  bool gated = true; ///< samples pass the sensor gate
  hand::FilterKind filter = hand::FilterKind::off;
  bool close_pinches = false;
  std::optional<CountScale> adapt = std::nullopt;
  bool slips = false; ///< of what adapts, slips are learned
  flow::InputLog* input_log = nullptr;
  std::optional<deform::InjectiveOptions> injective = std::nullopt;
  const char* puppet = nullptr; ///< the text of its file; null: hands that touch the model
  bool tracked = false;         ///< trackers move the wrists
};

/// A puppet of the ball: two twins, a function that turns three points, one that listens to a
/// fingertip, a pin.
inline constexpr const char* ball_puppet = R"(
version = 1
model = "ball.obj"
mirror = "x"
[points]
northLeft = { at = [0.5, 0.5, 0.7], radius = 0.9 }
south = { at = [0.0, -0.6, 0.8], radius = 0.8 }
east = { vertex = 40, radius = 0.7 }
pinned = { at = [0.0, 0.0, 1.0], radius = 0.5, pin = true }
[functions.growLeft]
input = "left.index_flexion"
travel_deg = 30
curve = "ease"
least = -0.5
move = { northLeft = [0.2, 0.1, 0.1] }
[functions.turn]
input = "right.middle_flexion"
travel_deg = -40
least = -1
turn = { degrees = 20, axis = [1, 0, 0], through = [0, 0, 0], points = { south = 1, east = 0.5 } }
[functions.push]
input = "right.ring_tip_z"
travel_m = 0.02
least = -2
move = { east = [0.0, 0.1, 0.2], south = [0.05, 0.0, 0.0] }
)";

/// Returns settings of which some, chosen at random, differ from these.
template <class Random>
flow::LoopSettings any_settings(const flow::LoopSettings& before, Random& random) {
  flow::LoopSettings settings = before;
  if (random() % 4 == 0) settings.mode = static_cast<flow::Mode>(random() % flow::mode_count);
  if (random() % 4 == 0) settings.kernel = static_cast<deform::Wendland>(random() % 4);
  if (random() % 6 == 0) settings.injective = !settings.injective;
  if (random() % 6 == 0) settings.piece_fraction = 0.02 + 0.01 * static_cast<double>(random() % 8);
  if (random() % 6 == 0)
    settings.filter.kind = random() % 2 == 0 ? hand::FilterKind::one_euro : hand::FilterKind::off;
  if (random() % 4 == 0) settings.filter.close_pinches = !settings.filter.close_pinches;
  const double radius_m = 0.1 + 0.01 * static_cast<double>(random() % 20);
  if (random() % 2 == 0) settings.radius_m.fill(radius_m);
  if (random() % 4 == 0) settings.radius_m[random() % 5] = radius_m;
  if (random() % 3 == 0)
    settings.brushes[random() % 5] = static_cast<deform::Brush>(random() % deform::brush_count);
  if (random() % 6 == 0) settings.brush_strength = -1.0 + 0.1 * static_cast<double>(random() % 21);
  if (random() % 5 == 0) settings.keep_volume = 0.25 * static_cast<double>(random() % 5);
  if (random() % 5 == 0)
    settings.hold = settings.hold == flow::Hold::hand ? flow::Hold::fingertips : flow::Hold::hand;
  return settings;
}

/// A loop over two hands whose rings the test fills itself.
struct LoopUnderTest {
  std::vector<std::unique_ptr<SampleRing>> rings;
  std::vector<std::unique_ptr<PoseRing>> poses; ///< in the order of Side; empty unless tracked
  flow::CommandRing commands{32};
  deform::Mesh model;
  flow::Placement placement;
  std::vector<flow::HandInput> inputs; ///< these two as the loop was made of them
  flow::LoopOptions options;
  std::unique_ptr<flow::DeformLoop> loop;

  explicit LoopUnderTest(flow::Mode mode, const LoopFixture& fixture = {})
      : model(ball(fixture.rings_of_ball)) {
    const HostTime now = HostClock::now();
    std::array<std::optional<flow::Fingertips>, 2> tips;
    for (const Side side : {Side::left, Side::right}) {
      rings.push_back(std::make_unique<SampleRing>(64));
      const GloveSample first = bent_sample(side, 0, now);
      const hand::HandSkeleton skeleton(side);
      tips[flow::Placement::index_of(side)] =
          skeleton
              .pose(hand::joint_angles(first, hand::default_calibration()),
                    Eigen::Isometry3d::Identity())
              .fingertip_positions();
      inputs.push_back({rings.back().get(), side, {}, first, fixture.gated});
      inputs.back().filter.kind = fixture.filter;
      inputs.back().filter.close_pinches = fixture.close_pinches;
      inputs.back().wearer.adapt = fixture.adapt;
      if (fixture.slips) inputs.back().wearer.ends = narrow_ends(side);
      if (!fixture.tracked) continue;
      poses.push_back(std::make_unique<PoseRing>(64));
      inputs.back().wrist_source = {poses.back().get(), {}};
    }
    placement = flow::place_hands(model, tips);
    if (fixture.puppet != nullptr)
      options.rig = std::make_shared<const puppet::Rig>(
          *puppet::parse_puppet(fixture.puppet, "a test's puppet"), model);
    options.input_log = fixture.input_log;
    options.sculptor.deformer.injective = fixture.injective;
    options.rate_hz = fixture.rate_hz;
    options.switch_action = fixture.switch_action;
    options.commands = &commands;
    options.sculptor.mode = mode;
    options.sculptor.deformer.undo_bytes = std::size_t{4} << 20;
    options.sculptor.deformer.supports = deform::one_radius(0.5);
    if (flow::is_played(options.rig.get()))
      options.sculptor.deformer.supports = options.rig->supports();
    options.sculptor.piece_length = 0.02;
    loop = std::make_unique<flow::DeformLoop>(model, placement, inputs, options);
  }

  void bend(int counts, HostTime arrival) {
    rings[0]->try_push(bent_sample(Side::left, counts, arrival));
    rings[1]->try_push(bent_sample(Side::right, counts, arrival));
  }
  /// Returns a frame's shape, in the model's order.
  deform::Points vertices_of(const flow::Frame& frame) const {
    deform::Points vertices;
    loop->changes().layout(frame.model).unpack(frame.shape, vertices);
    return vertices;
  }
  const flow::Frame& frame_after_tick(std::uint64_t number) {
    loop->tick(number, HostClock::now());
    loop->frames().update();
    return loop->frames().front();
  }
};

} // namespace nendo::test
