#pragma once
// What a fingertip does to the surface along its way in type 2. Sculpting programs know these
// brushes; `pull` is the paper's Type-2, in which the surface follows the fingertip.

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

/// Recordings keep the numbers, so new values are added at the end.
enum class Brush : std::uint8_t {
  pull,    ///< the surface follows the fingertip
  none,    ///< nothing
  push,    ///< the surface goes in, against its mean normal; with keep_volume it comes out nearby
  inflate, ///< each vertex goes out, along its own normal
  smooth,  ///< each vertex goes to the mean of its neighbours; the volume stays
  flatten, ///< the surface becomes the plane that fits it best
  twist,   ///< the surface turns about its mean normal
  scale,   ///< the surface grows about the fingertip
  pinch,   ///< vertices gather about the line through the fingertip along the mean normal
};
inline constexpr std::uint8_t brush_count = 9;

NENDO_API std::string_view name_of(Brush brush) noexcept;
NENDO_API std::optional<Brush> brush_named(std::string_view name) noexcept;
/// Returns all names, as "pull, none, push or inflate".
NENDO_API std::string brush_words();
NENDO_API bool are_all_pull(std::span<const Brush> brushes) noexcept; ///< none does anything else

inline constexpr double usual_brush_strength = 0.5;

struct BrushOptions {
  std::vector<Brush> of_points{}; ///< one for each start point; empty: all pull
  /// The second half of the points mirrors the first. What a brush does at a point and at its image
  /// is then worked out of the same shape, so that none of the two comes first.
  bool are_mirrored = false;
  /// Brush effect per unit of path length, -1 to 1. At 1, push and inflate lead as far
  /// as the fingertip goes, and on a way of one radius twist turns by one radian, scale grows and
  /// pinch shrinks by e, and smooth and flatten do 86 % of the remaining way. Below 0 each does
  /// the opposite, but smooth and flatten, which have none. Pull always leads all the way.
  double strength = usual_brush_strength;
  /// Of the model; needed if any brush is neither pull nor none.
  std::shared_ptr<const VertexRings> rings{};

  bool are_all_pull() const noexcept { return deform::are_all_pull(of_points); }
};

} // namespace nendo::deform
