#pragma once
// Edits of a puppet. Each function returns a new puppet with its file text, and does not change the
// original. An edit of a twin is applied, mirrored, to the point or function that it mirrors. Only
// SurfaceField::make() shows whether the points permit a field. Errors are bad_input, one line that
// names the point or the function. All functions allocate.

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::puppet {

/// A surface position for a new point.
struct NewPoint {
  Eigen::Vector3d at;
  double radius = 1.0; ///< model units
};

/// Returns a puppet without points. with_function() completes it.
NENDO_API Puppet empty_puppet(std::string_view model_name);

/// Adds a point, and a function that moves only this point, by `move` (model units) when `input`
/// has changed by `travel`. Errors: the point is too close to another one, or there are too many
/// points.
NENDO_API Result<Puppet> with_function(const Rig& rig, const NewPoint& point,
                                       const Eigen::Vector3d& move, const HandSignal& input,
                                       double travel);
/// Adds a point that no function moves. Errors: those of with_function(), and no function exists
/// yet.
NENDO_API Result<Puppet> with_pin(const Rig& rig, const NewPoint& point);
/// Removes a point, and the functions that move only it. Errors: no function would be left, or an
/// affine part would have fewer than four points.
NENDO_API Result<Puppet> without_point(const Rig& rig, std::size_t point);
/// Sets a point's radius. A mix is scaled so that this is its largest radius.
NENDO_API Result<Puppet> with_radius(const Rig& rig, std::size_t point, double radius);
/// Pins or unpins a point. Error: a function moves it.
NENDO_API Result<Puppet> with_pinned(const Rig& rig, std::size_t point, bool pinned);
/// Sets the vector by which a function moves a point, model units. Errors: the point is a pin, or
/// the function rotates it.
NENDO_API Result<Puppet> with_move(const Rig& rig, std::size_t function, std::size_t point,
                                   const Eigen::Vector3d& vector);
/// Makes a function rotate a point by `turn`. Points that it already rotates keep their fractions;
/// if there are none, all points that it moves rotate. Errors: the point is a pin, or the turn has
/// no axis or exceeds 360 degrees.
NENDO_API Result<Puppet> with_turn(const Rig& rig, std::size_t function, std::size_t point,
                                   const AxisTurn& turn);
/// Returns the displacements of the points by the function after with_turn(): 3 by #points, model
/// units.
NENDO_API deform::Points vectors_with_turn(const Rig& rig, std::size_t function, std::size_t point,
                                           const AxisTurn& turn);
NENDO_API Result<Puppet> with_input(const Rig& rig, std::size_t function, const HandSignal& input,
                                    double travel);
/// Renames a function. Errors: the name is invalid, or another function has it.
NENDO_API Result<Puppet> with_name(const Rig& rig, std::size_t function, std::string_view name);
/// Adds mirrored twins, about x = 0, to the points and functions of one side, or converts these
/// twins to independent points and functions. Names without a side are changed.
NENDO_API Result<Puppet> with_mirror(const Rig& rig, bool mirrors);

/// Adds masks along a brush stroke, and their mirror images if the puppet mirrors. Positions near
/// existing masks of this radius are skipped, which keeps files small. If masks are inverted,
/// removes the masks there instead. Error: too many masks.
NENDO_API Result<Puppet> with_masks(const Rig& rig, std::span<const Eigen::Vector3d> stroke,
                                    double radius);
/// Removes the masks whose centre is within the radius of a position of the stroke; if masks are
/// inverted, adds masks there instead. Error: too many masks.
NENDO_API Result<Puppet> without_masks(const Rig& rig, std::span<const Eigen::Vector3d> stroke,
                                       double radius);
/// Removes all masks, so that all vertices are free.
NENDO_API Result<Puppet> without_any_mask(const Rig& rig);
/// Swaps protected and free vertices.
NENDO_API Result<Puppet> with_masks_inverted(const Rig& rig);
/// Sets whether fingertips shape both sides of the plane x = at. Error: the puppet has points.
NENDO_API Result<Puppet> with_symmetry(const Rig& rig, bool on, double at);

/// Min distance of two points, as a fraction of the smaller radius.
inline constexpr double min_gap_of_points = 0.1;
inline constexpr std::size_t max_painted_masks = 500;

struct Bend {
  HandSignal input;    ///< the flexion of the finger
  double travel = 1.0; ///< in radians, for a value of 1; < 0 if it was straightened
};

/// Watches the flexions of all fingers since begin(). For one thread; does not allocate.
class NENDO_API BendWatch {
public:
  /// Resets the state: the next poses of the hands are their poses at rest.
  void begin() noexcept { rest_ = {}; }
  /// Returns the finger that has bent most since begin(), or since its hand appeared, if it has
  /// bent enough, and clearly more than its neighbours, which bend along. Bends are fractions of a
  /// finger's usual bend, so that thumbs count as much as other fingers.
  std::optional<Bend> follow(const RigPlayer::Hands& hands) noexcept;

  /// The min bend of a finger, as a fraction of its usual bend.
  static constexpr double min_bend_fraction = 0.6;
  /// The min ratio of its bend to that of any other finger.
  static constexpr double dominance_ratio = 1.25;
  /// Returns the bend of a finger (0 thumb to 4 little finger) for a value of 1, in radians.
  static double usual_rad(std::size_t finger) noexcept;

private:
  std::array<std::optional<std::array<double, hand::finger_count>>, 2>
      rest_; ///< angles at rest, by side
};

} // namespace nendo::puppet
