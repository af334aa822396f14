#pragma once
// Edits of a timeline. Each edit leaves the timeline playable. On an error the timeline is
// unchanged. All errors are usage errors, in one line without the file's name. Keys are counted
// from 0.

#include <cstddef>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

/// Returns where a key goes that is wanted at `time_s`: there, unless it is later than the end by
/// at most a tick, as where the last tick of a run was missed. Then it goes to the end, or, if the
/// hand has a key there already, half a tick before it. `moved` is the key that goes, and that is
/// not in its own way.
double time_near_end(const Timeline& timeline, Side side, double time_s,
                     std::optional<std::size_t> moved = {});

/// Moves a key to another time, which may be beyond other keys. Error: there is no such hand or
/// key, there is already a key at that time, or the time is outside of the timeline.
Result<void> move_key(Timeline& timeline, Side side, std::size_t key, double to_s);
/// Copies a key to another time. Errors: those of move_key().
Result<void> copy_key(Timeline& timeline, Side side, std::size_t key, double to_s);
/// Deletes a key. Error: there is no such key, or it is the hand's last one.
Result<void> delete_key(Timeline& timeline, Side side, std::size_t key);
/// Adds a key on the curve, so that the pose at that time stays the same.
Result<void> add_key(Timeline& timeline, Side side, double at_s);

/// Stretches the time between from_s and to_s by `scale`, and shifts all that comes later. This
/// changes keys, events and the duration. Error: the times are not within the timeline, `scale` is
/// not positive, or the result is too long.
Result<void> retime(Timeline& timeline, double scale, double from_s, double to_s);

/// Blends a key with its neighbours. Factor 0 is its own pose, factor 1 is the pose that the curve
/// would have there without the key. Error: there is no such key, it is the first or last one, or
/// the factor is not from 0 to 1.
Result<void> blend_key(Timeline& timeline, Side side, std::size_t key, double factor);
/// Blends `one` with `other`. Hands that both have get a curve between that of `one` (factor 0) and
/// that of `other` (factor 1), with the keys of both. All else stays as in `one`. Error: there is
/// no common hand, or the factor is not from 0 to 1.
Result<void> blend(Timeline& one, const Timeline& other, double factor);

/// Swaps the left and the right hand, mirrored about the plane x = plane_x_m of the stage.
/// Functions of a puppet then do what their twins (...Left, ...Right) did, and listen to the other
/// hand; those without a twin do what they did. Error: the plane is not finite or too far away, or
/// a function listens to a fingertip's x, which has the other sign in a mirror.
Result<void> mirror(Timeline& timeline, double plane_x_m);

struct TipSet {
  double off_m = 0.0; ///< distance of the fingertip from its target
};
/// Bends a key's finger so that its tip is at `target_m` on the stage. The wrist stays. Error:
/// there is no such key, or the tip stays farther than within_m from the target; the message gives
/// the distance.
Result<TipSet> set_tip(Timeline& timeline, Side side, std::size_t key, hand::Finger finger,
                       const Eigen::Vector3d& target_m, double within_m);

struct ValueSet {
  KeyRef key;         ///< that was changed
  double value = 0.0; ///< the function's value there
};
/// Bends the finger that plays a function of the puppet so that the function has that value at the
/// finger's key. Error: there is no such function or key, the value is beyond its limits or those
/// of the joints, or the hand does not move the function there.
Result<ValueSet> set_value(Timeline& timeline, const std::string& function, std::size_t key,
                           double value);

} // namespace nendo::timeline
