#pragma once
// What can be done to a timeline. Each leaves it playable; on an error it is as it was. Errors are
// usage, one line without the file's name; keys are counted from 0.

#include <array>

#include <nendo/base/result.hpp>
#include <nendo/timeline/timeline.hpp>

namespace nendo::timeline {

/// A key goes to another time, past others if need be. Error: no such hand or key, a key is there
/// already, the time is outside of the timeline.
Result<void> move_key(Timeline& timeline, Side side, std::size_t key, double to_s);
Result<void> copy_key(Timeline& timeline, Side side, std::size_t key, double to_s);
/// Error: no such key, or it is the hand's last.
Result<void> delete_key(Timeline& timeline, Side side, std::size_t key);
/// A key where the curve is, so that nothing changes but the slopes' freedom.
Result<void> add_key(Timeline& timeline, Side side, double at_s);

/// Times from from_s to to_s pass `scale` times as slowly, from from_s on; what comes later is
/// moved. Keys, events and the duration. Error: no part of the timeline, not positive, too long.
Result<void> retime(Timeline& timeline, double scale, double from_s, double to_s);

/// The key becomes a mixture: its own pose at factor 0, at 1 what its neighbours would make of that
/// moment without it. Error: as above; it is at an end; a factor that is not from 0 to 1.
Result<void> blend_key(Timeline& timeline, Side side, std::size_t key, double factor);
/// The hands that both have move between one's curve at factor 0 and other's at 1, with the keys of
/// both; the rest is one's. Error: no hand in common, a factor that is not from 0 to 1.
Result<void> blend(Timeline& one, const Timeline& other, double factor);

/// The left hand does what the right one did, and the other way round, mirrored about the plane x =
/// plane_x_m of the stage. Error: not finite, too far.
Result<void> mirror(Timeline& timeline, double plane_x_m);

struct TipSet {
  double off_m = 0.0; ///< of the fingertip, from where it was to be
};
/// A key's finger bends so that its tip is at `target_m` on the stage; the wrist stays. Error: as
/// above; out of reach by more than within_m, which the message then tells.
Result<TipSet> set_tip(Timeline& timeline, Side side, std::size_t key, hand::Finger finger,
                       const Eigen::Vector3d& target_m, double within_m);

} // namespace nendo::timeline
