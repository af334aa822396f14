#pragma once
// Computes a frame from hand poses, commands and prepared changes. It has no clock, thread or ring,
// so that loops, replays and timelines make the same shapes.

#include <memory>
#include <optional>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/flow/change_broker.hpp>
#include <nendo/flow/clay_hands.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/prepared_change.hpp>
#include <nendo/flow/puppet_player.hpp>
#include <nendo/flow/shaping.hpp>

namespace nendo::flow {

class DrawnBlade;

/// Loop's thread, or the thread of a player without a loop. The constructor allocates; other
/// functions neither allocate nor wait.
class NENDO_API ShapingCore {
public:
  using Hands = puppet::RigPlayer::Hands;

  /// `changes` has the initial model and setup, must be made with the same options, and must
  /// outlive this.
  ShapingCore(ChangeBroker& changes, const CoreOptions& options);
  ~ShapingCore();

  /// Returns a frame with all memory for a tick.
  Frame first_frame() const;
  /// Grabs the model for the first time.
  deform::FieldStatus begin(const Hands& hands, Frame& frame) noexcept;

  // Call these in a tick, in this order. `hands` are the current poses of all hands of the options.

  /// Executes a Request, DrawWire or puppet command; others have no effect.
  void apply(const Command& command, const Hands& hands) noexcept;
  /// Toggles a hand's clutch. A puppet must be played.
  void toggle_clutch(Side side, const Hands& hands) noexcept;
  void ask(Request request) noexcept { shaping_.ask(request); }
  void toggle_hold() noexcept { shaping_.toggle_hold(); }
  void commit_when_held() noexcept { shaping_.commit_when_held(); }
  /// Moves the control points and the blade with the hands. `time` is for clutch gestures. Moves
  /// the hands' bodies in modes that use them and, with `with_bodies`, in all modes, as before a
  /// change.
  void place(const Hands& hands, std::optional<HostTime> time, bool with_bodies,
             Frame& frame) noexcept;
  /// Makes the frame's shape, at `time` since the first tick. With `completes`, a stroke is
  /// completed up to the hands.
  void shape(HostClock::duration time, bool completes, Frame& frame, LoopStats& stats) noexcept;

  // Call these at the end of a tick, after shape() with `completes`:

  /// Holds still, or changes the sculptor, version or puppet, and returns the previous ones in
  /// `change`. Hands whose poses jumped, as by another filter, re-grab.
  void finish(PreparedChange& change, const Hands& hands, Frame& frame, LoopStats& stats) noexcept;
  /// Calls Shaping::restart(), and writes the state to `change`.
  void restart(LogChange& change, const Hands& hands, Frame& frame, LoopStats& stats) noexcept;

  const Shaping& shaping() const noexcept { return shaping_; }
  const PuppetPlayer* puppet() const noexcept { return puppet_ ? &*puppet_ : nullptr; }
  /// Returns whether that hand's wrist switch is the puppet's clutch.
  bool has_clutch(Side side) const noexcept;
  const WirePath& completed_wire() const noexcept;
  /// Completes the stroke and returns the shape, 3 by #vertices. Allocates.
  deform::Points final_shape() { return shaping_.final_shape(tips_); }

private:
  void draw(const DrawWire& draw) noexcept;
  void place_tips(const Hands& hands, deform::Points& tips) noexcept;
  void place_bodies(const Hands& hands) noexcept;
  void place_again(const Hands& hands) noexcept;
  void exchange(PreparedChange& change, const Hands& hands, Frame& frame,
                LoopStats& stats) noexcept;
  void take_puppet(ReadyRig& rig, ReadySculptor& ready, const Hands& hands) noexcept;
  void keep_held_values() noexcept;
  void show_puppet(Frame& frame) const noexcept;

  double units_per_metre_;
  std::vector<Side> hands_;
  std::shared_ptr<HandBodies> bodies_; ///< in the order of Side, if there are two
  std::optional<double> mirror_;       ///< mirror_of() the rig
  deform::Points tips_;                ///< control points of hands or puppet; 3 by #, model units
  Shaping shaping_;
  std::optional<PuppetPlayer> puppet_; ///< none: the hands touch the model
  std::unique_ptr<DrawnBlade> blade_;
  bool holds_after_blade_ = false; ///< whether the hands re-grab after drawing
};

} // namespace nendo::flow
