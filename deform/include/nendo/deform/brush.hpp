#pragma once
// Sculpting brushes: how a fingertip changes the surface along its path in type 2. `pull` is the
// paper's Type-2, in which the surface follows the fingertip.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/vertex_rings.hpp>

namespace nendo::deform {

/// Recordings store the values, so new ones are added at the end.
enum class Brush : std::uint8_t {
  pull, ///< the surface follows the fingertip
  none, ///< the surface does not change
  push, ///< the surface moves inwards, against its mean normal; with keep_volume it bulges nearby
  inflate, ///< each vertex moves outwards along its own normal
  smooth,  ///< each vertex moves towards the mean of its neighbours; the volume is kept
  flatten, ///< the surface approaches its best-fit plane
  twist,   ///< the surface rotates about its mean normal
  scale,   ///< the surface is scaled up about the fingertip
  pinch,   ///< vertices move towards the line through the fingertip along the mean normal
};
inline constexpr std::uint8_t brush_count = 9;

NENDO_API std::string_view name_of(Brush brush) noexcept;
NENDO_API std::optional<Brush> brush_named(std::string_view name) noexcept;
/// Returns all names as text, such as "pull, none, push or inflate".
NENDO_API std::string brush_words();
NENDO_API bool are_all_pull(std::span<const Brush> brushes) noexcept;

inline constexpr double usual_brush_strength = 0.5;

struct BrushOptions {
  std::vector<Brush> of_points{}; ///< one for each start point; empty: all pull
  /// The second half of the points mirrors the first. A brush then computes a point and its mirror
  /// image from the same shape, so that their order does not matter.
  bool are_mirrored = false;
  /// Brush effect per unit of path length, -1 to 1. At 1, push and inflate move the surface as far
  /// as the fingertip, and on a path of one radius twist rotates by one radian, scale enlarges and
  /// pinch shrinks by the factor e, and smooth and flatten cover 86 % of the remaining distance.
  /// Below 0 each brush is inverted, except smooth and flatten, which have no inverse. Pull always
  /// follows the fingertip fully.
  double strength = usual_brush_strength;
  /// The model's rings; required if any brush is neither pull nor none.
  std::shared_ptr<const VertexRings> rings{};

  bool are_all_pull() const noexcept { return deform::are_all_pull(of_points); }
};

} // namespace nendo::deform
