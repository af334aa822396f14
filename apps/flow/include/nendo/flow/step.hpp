#pragma once
// The list of steps that can be undone and redone: strokes of the hands, and changes of settings.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo::flow {

struct LoopSettings;

/// Clients of the browser's protocol know the numbers, so new values are added at the end.
enum class StepKind : std::uint8_t {
  stroke, ///< a stroke of the hands, up to a commit, a release, or a change
  reset,  ///< back to the model as it was loaded
  mode,   ///< these five, brush, volume and hold: a change of this setting alone
  kernel,
  radius,  ///< the radius of one finger or more
  folding, ///< LoopSettings::injective
  filter,
  settings,  ///< a change of several settings at once, or within a second
  subdivide, ///< the model became finer
  brush,     ///< the brush of one finger or more, or their strength
  puppet,    ///< the puppet was edited
  volume,    ///< how much of it stays
  hold,      ///< LoopSettings::hold
  mask,      ///< what fingertips leave alone was painted, cleared or inverted
  symmetry,  ///< fingertips shape both sides, or no longer
  refine,    ///< the model's triangles were made to suit the shape
  cut,       ///< a wire went through the model
  join,      ///< the model's parts became one
  copy,      ///< a part was copied
  remove,    ///< a part was removed
  topology,  ///< what was thin has parted, opened or fused
};

NENDO_API std::string_view name_of(StepKind kind) noexcept;
/// Returns the kind of a step that leads from one of these to the other.
NENDO_API StepKind kind_of_change(const LoopSettings& before, const LoopSettings& after) noexcept;
constexpr bool is_setting(StepKind kind) noexcept {
  return (kind >= StepKind::mode && kind <= StepKind::settings) || kind == StepKind::brush ||
         kind == StepKind::volume || kind == StepKind::hold;
}
/// Returns whether such a step needs another sculptor, and so another thread, to be undone.
constexpr bool is_change(StepKind kind) noexcept {
  return kind >= StepKind::mode;
}

struct Step {
  StepKind kind = StepKind::stroke;
  float at_s = 0.0F; ///< when it ended, in seconds since the loop began
};

/// The last steps that can be undone, the oldest first, and then the first of those that were
/// undone.
struct StepList {
  static constexpr std::size_t max_undoable = 48;
  static constexpr std::size_t max_undone = 16;

  std::array<Step, max_undoable + max_undone> steps;
  std::uint32_t count = 0;
  std::uint32_t undoable = 0; ///< as many of them, at the beginning
  /// The hands have shaped something that is no step yet, which an undo would undo first.
  bool in_hand = false;
  std::uint64_t version = 0; ///< differs between lists that differ, but for in_hand

  std::span<const Step> all() const noexcept { return {steps.data(), count}; }
};

} // namespace nendo::flow
