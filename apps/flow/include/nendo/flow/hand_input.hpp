#pragma once
// An input of the loop: a glove's ring, its wearer's calibration, and the filter of its samples. It
// turns samples into joint angles: calibration, sensor gate, filter, pinches. An input can be a
// layer, which replaces some angles of another one.

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
#include <nendo/driver/pose_sample.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/flow/wrist.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/joint_filter.hpp>
#include <nendo/hand/sensor_gate.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/hand/wearer.hpp>
#include <nendo/hand/wrist_tracking.hpp>

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

/// Parses a layer's angles, by Placement::index_of(side): comma-separated hands (left, right) or
/// hand.part, such as "left.index,right". Returns nothing if the text is invalid.
NENDO_API std::optional<std::array<AngleSet, 2>> parse_layer(std::string_view text) noexcept;

/// Returns the angles of a hand as a text for parse_layer(), with names of whole parts.
NENDO_API std::string in_words(Side side, AngleSet angles);

/// Makes an input a layer: its angles replace those of earlier inputs of the same hand. Angles are
/// merged, because raw counts differ between gloves. If no earlier input has that hand, the layer
/// is over a static hand, in the pose of the layer's first sample.
struct NENDO_API Layer {
  /// The fade-in and fade-out time.
  static constexpr HostClock::duration blend_time = std::chrono::milliseconds(150);
  /// The maximum progress of a fade per tick, however late the tick is.
  static constexpr HostClock::duration longest_step = std::chrono::milliseconds(30);

  AngleSet joints = AngleSet::all();
  bool on = true;      ///< it is in, or fades in
  double weight = 1.0; ///< 0: faded out; 1: faded in
  /// The static hand below, if no earlier input has that hand. Nothing: the pose of the layer's
  /// first sample.
  std::optional<hand::JointAngles> below{};

  /// Advances the fade. Wait-free.
  void advance(HostClock::duration time) noexcept;
  /// Blends the layer's `own` angles over `angles`. Angles outside `joints`, and all angles while
  /// it is faded out, keep their bits; when it is faded in, `joints` have exactly the bits of
  /// `own`. Wait-free.
  void play_over(const hand::JointAngles& own, hand::JointAngles& angles) const noexcept;
};

/// The station of a tracker that moves a hand's wrist. Only the loop's thread drains `ring`, which
/// must outlive the loop; null: the poses are in LoopOptions::script.
struct WristSource {
  PoseRing* ring = nullptr;
  hand::TrackingOptions tracking{};
};

/// An input of the loop: a hand, or a layer over it. Only the loop's thread drains `ring`, which
/// must outlive the loop; null: the input is in LoopOptions::script.
struct HandInput {
  SampleRing* ring = nullptr;
  Side side = Side::right; ///< the hand's side on the stage, for a glove of either side
  hand::Wearer wearer;
  GloveSample first;            ///< the pose in which the hand grabs the model
  bool gated = true;            ///< hand::SensorGate rejects counts that no hand can cause
  hand::FilterOptions filter{}; ///< filters the joint angles by the samples' times
  /// A layer has its own glove and calibration; the hand's bones are those of the first input of
  /// its side.
  std::optional<Layer> layer{};
  /// The wrist path of a simulated hand, over its glove's time. The loop moves the wrist at each
  /// sample by a WristMove, which a recording keeps.
  std::shared_ptr<const WristPath> wrist_path{};
  /// Moves the hand; the first input of a side that has one determines it. Nothing: the wrist stays
  /// where it was placed, and WristMove moves it.
  std::optional<WristSource> wrist_source{};

  /// Returns the skeleton for samples from a glove of that side. It always has the side `side`.
  hand::HandSkeleton skeleton(Side glove) const {
    return hand::HandSkeleton(side, wearer.of(glove).size);
  }
};

/// Checks the inputs of a loop: one to max_inputs, and per side at most one that is not a layer,
/// before its layers. Error: bad_input, naming the wrong input.
NENDO_API Result<void> check_inputs(std::span<const HandInput> inputs);
/// Returns the number of hands: one or two.
NENDO_API std::size_t count_hands(std::span<const HandInput> inputs) noexcept;

/// Loop's thread. Only the constructor allocates.
struct NENDO_API GloveHand {
  GloveHand(HandInput hand_input, const Placement& placement, bool closes);

  /// Updates `latest` and `angles` by the next sample. Returns true if this sample turns the wrist
  /// switch on.
  bool update(const GloveSample& sample) noexcept;
  /// Changes the filter, if it differs, and whether pinches are closed.
  void change_filter(const hand::FilterOptions& options, bool closes) noexcept;
  /// Resets all state before `latest`, except learned ranges and stuck sensors.
  void restart() noexcept;

  const hand::HandSkeleton& skeleton() const noexcept {
    return skeletons[Placement::index_of(latest.side)];
  }
  /// Returns the sensors of `latest` that are stuck.
  SensorMask left_out() const noexcept {
    return {calibration.left_out(latest.side).bits & latest.present.bits};
  }

  HandInput input;
  std::size_t slot; ///< the index in arrays by side
  Eigen::Isometry3d T_stage_wrist;
  std::array<hand::HandSkeleton, 2> skeletons; ///< in the order of the glove's side
  hand::ActiveCalibration calibration;
  hand::SensorGate gate{};
  hand::JointFilter filter;
  GloveSample latest{};
  bool closes_pinches;        ///< as FilterOptions::close_pinches, but not in clay
  hand::JointAngles angles{}; ///< the filtered angles of `latest`, with pinches closed
  WristSwitchEdge wrist_switch{};
  bool is_lowest = true;  ///< not a layer over another input
  bool is_topmost = true; ///< the last layer of its side, whose samples are counted
  bool fresh = false;     ///< it got samples in this tick
  bool silent = false;

private:
  void follow(const GloveSample& sample) noexcept;
  void pose_by(const hand::Calibration& active) noexcept;
};

} // namespace nendo::flow
