#pragma once
// Layers: an input of the loop may play some joints of a hand over the inputs before it, as an
// animator overdubs. Angles are merged, because each glove's counts mean something else, and the
// hand that shapes is one skeleton.

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/side.hpp>
#include <nendo/base/units.hpp>
#include <nendo/hand/joint_angles.hpp>

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

/// What makes a layer of an input. Where no input before it is of the same hand, it lies over that
/// hand at rest, in the pose of its own first sample.
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

} // namespace nendo::flow
