#pragma once
// The list of steps that can be undone and redone: strokes and changes.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo::flow {

struct LoopSettings;

/// Web clients know the numbers, so new values are added at the end.
enum class StepKind : std::uint8_t {
  stroke, ///< a stroke of the hands, up to a commit, a release, or a change
  reset,  ///< the loaded model was restored
  mode,   ///< these five, brush, volume and hold: a change of only this setting
  kernel,
  radius,  ///< the radius of one finger or more
  folding, ///< LoopSettings::injective
  filter,
  settings,  ///< several changes of settings, together or within a second
  subdivide, ///< the model became finer
  brush,     ///< the brush of one finger or more, or their strength
  puppet,    ///< the puppet was edited
  volume,    ///< LoopSettings::keep_volume
  hold,      ///< LoopSettings::hold
  mask,      ///< masks of fingertips were painted, cleared or inverted
  symmetry,  ///< the fingertips' symmetry was turned on or off
  refine,    ///< the model's triangles were adapted to the shape
  cut,       ///< a wire or knife cut the model
  join,      ///< the model's parts were joined
  copy,      ///< a part was copied
  remove,    ///< a part was removed
  topology,  ///< thin places were separated, opened or fused
};

NENDO_API std::string_view name_of(StepKind kind) noexcept;
/// Returns the kind of a step from `before` to `after`.
NENDO_API StepKind kind_of_change(const LoopSettings& before, const LoopSettings& after) noexcept;
constexpr bool is_setting(StepKind kind) noexcept {
  return (kind >= StepKind::mode && kind <= StepKind::settings) || kind == StepKind::brush ||
         kind == StepKind::volume || kind == StepKind::hold;
}
/// Returns whether an undo of this step needs a sculptor, which the asking thread makes.
constexpr bool is_change(StepKind kind) noexcept {
  return kind >= StepKind::mode;
}

struct Step {
  StepKind kind = StepKind::stroke;
  float at_s = 0.0F; ///< the step's end, in seconds since the loop began
};

/// The last undoable steps, the oldest first, followed by the first undone steps.
struct StepList {
  static constexpr std::size_t max_undoable = 48;
  static constexpr std::size_t max_undone = 16;

  std::array<Step, max_undoable + max_undone> steps;
  std::uint32_t count = 0;
  std::uint32_t undoable = 0; ///< the number of undoable steps
  /// The hands' current shaping is not a step yet. An undo would revert it first.
  bool in_hand = false;
  std::uint64_t version = 0; ///< changes with the list, except with in_hand

  std::span<const Step> all() const noexcept { return {steps.data(), count}; }
};

} // namespace nendo::flow
