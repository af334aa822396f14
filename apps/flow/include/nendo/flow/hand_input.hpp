#pragma once
// An input of the loop: a glove's ring, its wearer's calibration, and the filter of its samples. It
// turns samples into joint angles: calibration, sensor gate, filter, pinches.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>
#include <nendo/base/units.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/flow/wrist.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/joint_filter.hpp>
#include <nendo/hand/sensor_gate.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/hand/wearer.hpp>

namespace nendo::flow {

/// A set of joint angles of a hand. Bit k is hand::angle_at(k).
struct AngleSet {
  std::uint32_t bits = 0;

  static constexpr AngleSet all() noexcept { return {(1U << hand::angle_count) - 1U}; }
  constexpr bool has(hand::Angle angle) const noexcept {
    return (bits >> hand::index_of(angle) & 1U) != 0;
  }
  constexpr bool is_empty() const noexcept { return bits == 0; }
  friend constexpr bool operator==(AngleSet, AngleSet) = default;
};

/// Returns the angles of a part of a hand: thumb, index, middle, ring, little, palm, wrist, or one
/// angle by its name (hand::angle_names). Returns nothing if there is no such part.
NENDO_API std::optional<AngleSet> angles_named(std::string_view part) noexcept;

/// Parses what a layer plays, of both hands by Placement::index_of(side): parts with commas
/// between, each a hand (left, right), or a hand, a point and one of its parts, such as
/// "left.index,right". Returns nothing if the text is not that.
NENDO_API std::optional<std::array<AngleSet, 2>> parse_layer(std::string_view text) noexcept;

/// Returns what that parses as the angles of that hand, with whole parts by their names.
NENDO_API std::string in_words(Side side, AngleSet angles);

/// What makes a layer of an input. Angles are merged, because each glove's counts mean something
/// else, and the hand that shapes is one skeleton. Where no input before it is of the same hand, it
/// lies over that hand at rest, in the pose of its own first sample.
struct NENDO_API Layer {
  /// The fade-in and fade-out time.
  static constexpr HostClock::duration blend_time = std::chrono::milliseconds(150);
  /// The maximum progress of a fade per tick, however late the tick is.
  static constexpr HostClock::duration longest_step = std::chrono::milliseconds(30);

  AngleSet joints = AngleSet::all();
  bool on = true;      ///< it plays, or fades in
  double weight = 1.0; ///< 0: faded out; 1: faded in
  /// The hand below, if no input before this one is of that hand. Nothing: the pose of its first
  /// sample.
  std::optional<hand::JointAngles> below{};

  /// Continues its fade. Wait-free.
  void advance(HostClock::duration time) noexcept;
  /// Puts its angles `own` over those in `angles`. Those that are not its joints stay as they are,
  /// bit for bit, as all do while it is out; while it is wholly in, its joints are `own`, bit for
  /// bit. Wait-free.
  void play_over(const hand::JointAngles& own, hand::JointAngles& angles) const noexcept;
};

/// A hand as an input of the loop, or a layer over it. Only the loop's thread drains `ring`, which
/// must outlive the loop; without one, the input is in LoopOptions::script.
struct HandInput {
  SampleRing* ring = nullptr;
  Side side = Side::right; ///< which hand it is on the stage, whichever glove it wears
  hand::Wearer wearer;
  GloveSample first;            ///< the pose in which the hand grabs the model
  bool gated = true;            ///< hand::SensorGate keeps out counts that no hand can have caused
  hand::FilterOptions filter{}; ///< filters the joint angles, at the samples' own times
  /// Measured bones (HandSkeleton::of_bones) for gloves of the first sample's side, in place of the
  /// wearer's size. A recording does not keep them.
  std::optional<hand::HandSkeleton> measured{};
  /// A layer has its own glove and calibration; the hand's bones are those of the first input of
  /// its side.
  std::optional<Layer> layer{};
  /// Where the wrist of a simulated hand is, by its glove's own time. The loop moves the wrist with
  /// each sample as a WristMove does, which a recording keeps.
  std::shared_ptr<const WristPath> wrist_path{};

  /// Returns the skeleton for samples from a glove of that side. It always has the side `side`.
  hand::HandSkeleton skeleton(Side glove) const {
    if (measured && glove == first.side) return *measured;
    return hand::HandSkeleton(side, wearer.of(glove).size);
  }
};

/// Checks that a loop can be made of these: one to max_inputs, and of each side at most one that
/// is no layer, before its layers. Error: bad_input, naming the input that is wrong.
NENDO_API Result<void> check_inputs(std::span<const HandInput> inputs);
/// Returns how many hands shape: one or two.
NENDO_API std::size_t count_hands(std::span<const HandInput> inputs) noexcept;

/// Loop's thread. Only the constructor allocates.
struct NENDO_API GloveHand {
  GloveHand(HandInput hand_input, const Placement& placement, bool closes);

  /// Updates `latest` and `angles` by the next sample. Returns true if the switch at the wrist was
  /// just turned on.
  bool update(const GloveSample& sample) noexcept;
  /// Changes the filter, where it differs, and whether pinches are closed.
  void change_filter(const hand::FilterOptions& options, bool closes) noexcept;
  /// Forgets all that came before `latest` but what adaptation has learned.
  void restart() noexcept;

  const hand::HandSkeleton& skeleton() const noexcept {
    return skeletons[Placement::index_of(latest.side)];
  }
  /// Returns the sensors of `latest` that are stuck.
  SensorMask left_out() const noexcept {
    return {calibration.left_out(latest.side).bits & latest.present.bits};
  }

  HandInput input;
  std::size_t slot; ///< in arrays by side
  Eigen::Isometry3d T_stage_wrist;
  std::array<hand::HandSkeleton, 2> skeletons; ///< in the order of the glove's side
  hand::ActiveCalibration calibration;
  hand::SensorGate gate{};
  hand::JointFilter filter;
  GloveSample latest{};
  bool closes_pinches;        ///< the filter's options say so, and nothing is between the pads
  hand::JointAngles angles{}; ///< those of `latest`, filtered, with pinches closed
  WristSwitchEdge wrist_switch{};
  bool is_lowest = true;  ///< the hand of its side, and not a layer over it
  bool is_topmost = true; ///< the last layer of its side, whose samples are counted
  bool fresh = false;     ///< samples came out of its ring in this tick
  bool silent = false;

private:
  void follow(const GloveSample& sample) noexcept;
  void pose_by(const hand::Calibration& active) noexcept;
};

} // namespace nendo::flow
