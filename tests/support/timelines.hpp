#pragma once
// Timelines for tests: random ones, and a wave of a hand.

#include <cmath>
#include <random>

#include "support/random_poses.hpp"
#include "timeline/timeline.hpp"

namespace nendo::test {

inline timeline::Key random_key(double time_s, std::mt19937& random) {
  timeline::Key key;
  key.time_s = time_s;
  key.angles = random_angles(random);
  const Eigen::Isometry3d place = random_place(random);
  key.wrist_m = place.translation();
  key.wrist_turn = Eigen::Quaterniond(place.linear());
  return key;
}

inline timeline::Timeline random_timeline(std::mt19937& random, std::size_t keys = 6) {
  std::uniform_real_distribution<double> step(0.01, 0.8);
  timeline::Timeline made;
  made.take = "take \"of\" M\xC3\xBCller\\.nendo";
  made.mesh = "/tmp/ball\n.obj";
  made.mesh_sum = {random(), static_cast<std::uint32_t>(random())};
  made.units_per_metre = step(random);
  made.rate_hz = 60.0;
  made.held = random() % 2 == 0;
  random.discard(1); // so that tests' seeds give the same timelines
  made.sculptor.mode = random() % 2 == 0 ? flow::Mode::type1 : flow::Mode::type2;
  made.sculptor.piece_length = step(random);
  auto& deformer = made.sculptor.deformer;
  deformer.supports.shared = {{step(random), 1.0}, {step(random), 0.25}};
  deformer.supports.own = {{3, {step(random), 2.0}}};
  deformer.csrbf.kernel = deform::Wendland::c4;
  deformer.csrbf.keep_volume = random() % 2 == 0 ? 0.0 : 0.6;
  made.sculptor.hold = random() % 2 == 0 ? flow::Hold::fingertips : flow::Hold::hand;
  if (random() % 2 == 0) deformer.injective.emplace();
  for (const Side side : {Side::left, Side::right}) {
    made.hands.push_back({side, {0.18 + 0.01 * step(random), 0.08}, {}});
    double time_s = 0.0;
    for (std::size_t at = 0; at < keys; ++at, time_s += step(random))
      made.hands.back().keys.push_back(random_key(time_s, random));
    made.duration_s = std::max(made.duration_s, made.hands.back().keys.back().time_s);
  }
  for (const flow::Request request : flow::requests)
    made.events.push_back({0.1 * static_cast<double>(made.events.size()), request});
  made.events.push_back(
      {2.5, flow::ChangeSettings{
                {.mode = flow::Mode::type2,
                 .injective = true,
                 .radius_m = {0.1, 0.2, 0.3, step(random), 0.5},
                 .piece_fraction = 0.07,
                 .brushes = {deform::Brush::twist, deform::Brush::pull, deform::Brush::none,
                             deform::Brush::smooth, deform::Brush::scale},
                 .brush_strength = -0.3,
                 .keep_volume = 0.3,
                 .hold = flow::Hold::hand}}});
  return made;
}

inline bool same_bits(const timeline::Timeline& one, const timeline::Timeline& other) {
  bool same = one.hands.size() == other.hands.size() && one.events.size() == other.events.size() &&
              one.duration_s == other.duration_s;
  for (std::size_t at = 0; same && at < one.hands.size(); ++at) {
    const auto& keys = one.hands[at].keys;
    same = one.hands[at].side == other.hands[at].side && keys.size() == other.hands[at].keys.size();
    for (std::size_t key = 0; same && key < keys.size(); ++key)
      same = timeline::same_bits(keys[key], other.hands[at].keys[key]);
  }
  for (std::size_t at = 0; same && at < one.events.size(); ++at)
    same = timeline::same_bits(one.events[at], other.events[at]);
  same = same && one.rig_state == other.rig_state && (one.rig != nullptr) == (other.rig != nullptr);
  if (same && one.rig)
    same = one.rig->puppet().text == other.rig->puppet().text &&
           one.rig->starts() == other.rig->starts();
  return same;
}

/// Returns a pose for each frame, at 90 Hz. Every joint moves at a pace of its own, and rests now
/// and then.
inline std::vector<timeline::Key> waving(std::size_t frames) {
  std::vector<timeline::Key> keys(frames);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    timeline::Key& key = keys[frame];
    key.time_s = static_cast<double>(frame) / 90.0;
    for (std::size_t at = 0; at < hand::angle_count; ++at) {
      const double phase = key.time_s * (1.0 + 0.15 * static_cast<double>(at % 7));
      key.angles[hand::angle_at(at)] = 0.3 + 0.3 * std::max(0.0, std::sin(phase));
    }
    key.wrist_m = {0.1 * std::sin(key.time_s), 0.3, 0.0};
    key.wrist_turn = Eigen::AngleAxisd(0.2 * std::cos(key.time_s), Eigen::Vector3d::UnitY());
  }
  return keys;
}

/// Returns a timeline of two hands that wave at a model of about the size of a ball, with some
/// requests.
inline timeline::Timeline waved_timeline(const deform::Mesh& model, flow::Mode mode,
                                         std::size_t frames = 90) {
  timeline::Timeline made;
  made.mesh_sum = recording::sum_of(model.vertices);
  made.units_per_metre = 2.5;
  made.duration_s = static_cast<double>(frames - 1) / made.rate_hz;
  made.sculptor.mode = mode;
  made.sculptor.piece_length = 0.02;
  made.sculptor.deformer.supports = deform::one_radius(0.5);
  made.sculptor.deformer.csrbf.merge_fraction = 0.05;
  const auto wave = waving(frames);
  for (const Side side : {Side::left, Side::right}) {
    made.hands.push_back({side, {}, {}});
    for (std::size_t frame = 0; frame < frames; frame += 8) {
      timeline::Key key = wave[frame];
      key.wrist_m.x() += side == Side::left ? -0.35 : 0.35;
      made.hands.back().keys.push_back(key);
    }
  }
  const std::array at_s{0.3, 0.4, 0.5, 0.62, 0.7};
  const std::array asked{flow::Request::release, flow::Request::grab, flow::Request::commit,
                         flow::Request::undo, flow::Request::redo};
  for (std::size_t at = 0; at < asked.size(); ++at)
    made.events.push_back({at_s[at], asked[at]});
  return made;
}

/// A puppet whose sides are alike: twins, and two functions without one, each of one hand.
inline constexpr const char* symmetric_puppet = R"(
version = 1
model = "ball.obj"
distance = "air"
mirror = "x"
[points]
cornerLeft = { at = [0.5, -0.2, 0.8], radius = 0.9 }
chin = { at = [0.0, -0.6, 0.8], radius = 0.8 }
crown = { at = [0.0, 1.0, 0.0], radius = 0.7, pin = true }
[functions.jawOpen]
input = "right.thumb_flexion"
travel_deg = 40
curve = "ease"
move = { chin = [0.0, -0.2, 0.05] }
[functions.pucker]
input = "left.thumb_flexion"
travel_deg = 40
move = { chin = [0.0, 0.0, 0.2], cornerLeft = [-0.1, 0.0, 0.1], cornerRight = [0.1, 0.0, 0.1] }
[functions.smileLeft]
input = "right.index_flexion"
travel_deg = 60
move = { cornerLeft = [0.15, 0.12, -0.05] }
[functions.frownLeft]
input = "right.middle_mcp_flexion"
travel_deg = -30
least = -0.5
most = 2
move = { cornerLeft = [0.05, -0.14, 0.03] }
)";

inline std::shared_ptr<const puppet::Rig> symmetric_rig() {
  puppet::Puppet puppet = *puppet::parse_puppet(symmetric_puppet, "a test's puppet");
  deform::Points starts(3, static_cast<Eigen::Index>(puppet.points.size()));
  for (std::size_t at = 0; at < puppet.points.size(); ++at) {
    Eigen::Vector3d place = puppet.points[at].at;
    if (puppet.points[at].is_mirrored) place.x() = -place.x();
    starts.col(static_cast<Eigen::Index>(at)) = place;
  }
  return std::make_shared<const puppet::Rig>(std::move(puppet), std::move(starts));
}

/// Returns waved_timeline(), in which the hands play the symmetric puppet, release, grab, and
/// change their roles.
inline timeline::Timeline puppet_timeline(const deform::Mesh& model, std::size_t frames = 90) {
  timeline::Timeline made = waved_timeline(model, flow::Mode::type1, frames);
  made.rig = symmetric_rig();
  made.rig_state = timeline::first_state(*made.rig);
  made.sculptor.deformer.supports = made.rig->supports();
  const auto function = [&](const char* name) {
    return static_cast<std::uint16_t>(*made.rig->puppet().function_named(name));
  };
  made.events = {
      {0.1, flow::SetClutch{Side::right, 1, false}},
      {0.2, flow::SetRole{function("smileRight"), *puppet::HandSignal::named("right.wrist_yaw")}},
      {0.3, flow::SetClutch{Side::right, 1, true}},
      {0.35, flow::Mark{}},
      {0.4, flow::SetSymmetry{true}},
      {0.5, flow::SetClutch{Side::left, puppet::RigPlayer::all_fingers, false}},
      {0.6, flow::SetSymmetry{false}},
      {0.7, flow::SetRole{function("pucker"), *puppet::HandSignal::named("left.palm_arch")}},
      {0.8, flow::SetClutch{Side::left, puppet::HandSignal::no_finger, true}}};
  return made;
}

} // namespace nendo::test
