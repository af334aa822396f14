#pragma once
// Edits of a puppet. Each returns another puppet, with the text of its file, and leaves the one
// that it was made of as it is. What is done to a twin is done to the one whose mirror image it is,
// on the other side. Only making the field shows whether the points permit one
// (SurfaceField::make()). Errors are bad_input, one line that names the point or the function. All
// functions allocate.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::puppet {

/// A place of the surface that shall be a point.
struct NewPoint {
  Eigen::Vector3d at;
  double radius = 1.0; ///< model units
};

/// Returns a puppet that has no point yet. with_function() makes it whole.
NENDO_API Puppet empty_puppet(std::string_view model_name);

/// Adds a point, and a function that moves it alone by `move` (model units) where `input` has gone
/// by `travel`. Errors: the point is too near to another one, or there are too many of them.
NENDO_API Result<Puppet> with_function(const Rig& rig, const NewPoint& point,
                                       const Eigen::Vector3d& move, const HandSignal& input,
                                       double travel);
/// Adds a point that nothing moves. Errors: as with_function(), and if there is no function yet.
NENDO_API Result<Puppet> with_pin(const Rig& rig, const NewPoint& point);
/// Removes a point, and the functions that move nothing else. Error: it is the last that a function
/// moves, or a part turns with it and three others.
NENDO_API Result<Puppet> without_point(const Rig& rig, std::size_t point);
/// Gives a point that radius. All radii of a mix change as its largest one does.
NENDO_API Result<Puppet> with_radius(const Rig& rig, std::size_t point, double radius);
/// Pins a point, or lets functions move it. Error: a function moves it.
NENDO_API Result<Puppet> with_pinned(const Rig& rig, std::size_t point, bool pinned);
/// Lets a function move the point by that vector, model units. Errors: it is a pin, or turns.
NENDO_API Result<Puppet> with_move(const Rig& rig, std::size_t function, std::size_t point,
                                   const Eigen::Vector3d& vector);
/// Lets a function turn the point so. Points that the function turns already continue doing so, by
/// their parts; if it turned none, all that it moves turn. Errors: it is a pin, or the turn has no
/// axis or more than 360 degrees.
NENDO_API Result<Puppet> with_turn(const Rig& rig, std::size_t function, std::size_t point,
                                   const AxisTurn& turn);
/// Returns where the function would move each point then: 3 by #points, model units.
NENDO_API deform::Points vectors_with_turn(const Rig& rig, std::size_t function, std::size_t point,
                                           const AxisTurn& turn);
NENDO_API Result<Puppet> with_input(const Rig& rig, std::size_t function, const HandSignal& input,
                                    double travel);
/// Gives a function another name. Errors: it is no name, or another function has it.
NENDO_API Result<Puppet> with_name(const Rig& rig, std::size_t function, std::string_view name);
/// Lets points and functions of one side have twins on the other side of x = 0, or makes points and
/// functions of their own of these twins. Names without a side are changed.
NENDO_API Result<Puppet> with_mirror(const Rig& rig, bool mirrors);

/// Adds masks along a stroke of a brush, and, where the puppet mirrors, their mirror images. Places
/// where masks of that radius are near already are passed over, so that a file stays small. Where
/// masks are inverted, what they free is taken away. Error: there are too many.
NENDO_API Result<Puppet> with_masks(const Rig& rig, std::span<const Eigen::Vector3d> stroke,
                                    double radius);
/// Removes the masks whose middle is within the radius of a place of the stroke; where they are
/// inverted, adds what frees it. Error: there are too many.
NENDO_API Result<Puppet> without_masks(const Rig& rig, std::span<const Eigen::Vector3d> stroke,
                                       double radius);
/// Removes all masks: everything moves.
NENDO_API Result<Puppet> without_any_mask(const Rig& rig);
/// Lets move what stayed, and the other way round.
NENDO_API Result<Puppet> with_masks_inverted(const Rig& rig);
/// Lets fingertips shape both sides of the plane x = at, or not. Error: hands play the puppet.
NENDO_API Result<Puppet> with_symmetry(const Rig& rig, bool on, double at);

/// Two points are at least so much of the smaller radius apart.
inline constexpr double min_gap_of_points = 0.1;
inline constexpr std::size_t max_painted_masks = 500;

struct Bend {
  HandSignal input;    ///< the flexion of the finger
  double travel = 1.0; ///< in radians, for a value of 1; < 0 if it was straightened
};

/// Watches the flexions of all fingers from a moment on. For one thread; does not allocate.
class NENDO_API BendWatch {
public:
  /// Forgets what it has seen: the hands are as they shall be at rest.
  void begin() noexcept { rest_ = {}; }
  /// Returns the finger that has bent farthest since begin(), or since its hand came, if that is
  /// far enough, and clearly farther than its neighbours, which bend along. The lengths of bends
  /// are fractions of a finger's usual bend, so that thumbs count as much as others.
  std::optional<Bend> follow(const RigPlayer::Hands& hands) noexcept;

  /// The min bend of a finger, as a fraction of its usual bend.
  static constexpr double min_bend_fraction = 0.6;
  /// The min ratio of its bend to that of any other finger.
  static constexpr double dominance_ratio = 1.25;
  /// Returns how far that finger bends for a value of 1, in radians; 0 thumb to 4 little finger.
  static double usual_rad(std::size_t finger) noexcept;

private:
  std::array<std::optional<std::array<double, hand::finger_count>>, 2>
      rest_; ///< angles at rest, by side
};

} // namespace nendo::puppet
