#pragma once
// What a tick does to the shape: hand poses, commands and prepared changes in, a frame out. It has
// no clock, thread or ring, so that loops, replays and timelines make the same shapes.

#include <array>
#include <cstddef>
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

/// Loop's thread, or that of a player without a loop. The constructor allocates; its functions
/// neither allocate nor wait.
class NENDO_API ShapingCore {
public:
  using Hands = puppet::RigPlayer::Hands;

  /// `changes` has the first model and its sculptor's setup, and was made with these options. It
  /// must outlive the core.
  ShapingCore(ChangeBroker& changes, const CoreOptions& options);
  ~ShapingCore();

  /// Returns a frame that has the memory that a tick needs.
  Frame first_frame() const;
  /// Lets the hands grab the model for the first time.
  deform::FieldStatus begin(const Hands& hands, Frame& frame) noexcept;

  // In a tick, in this order. `hands` are where they are then; all hands of the options must be
  // there.

  /// Handles a Request, DrawWire, or command of a puppet; others have no effect.
  void apply(const Command& command, const Hands& hands) noexcept;
  /// Toggles the clutch of the puppet's hand. There must be a played puppet.
  void toggle_clutch(Side side, const Hands& hands) noexcept;
  void ask(Request request) noexcept { shaping_.ask(request); }
  void toggle_hold() noexcept { shaping_.toggle_hold(); }
  void commit_when_held() noexcept { shaping_.commit_when_held(); }
  /// Moves the control points and the blade with the hands. `time` is that of clutch gestures. The
  /// hands' bodies move in modes that use them, and, `with_bodies`, in all, as before a change.
  void place(const Hands& hands, std::optional<HostTime> time, bool with_bodies,
             Frame& frame) noexcept;
  /// Makes the frame's shape, at that time since the beginning. With `completes`, a stroke leads
  /// all the way to the hands.
  void shape(HostClock::duration time, bool completes, Frame& frame, LoopStats& stats) noexcept;

  // At the end of a tick, whose shape() has completed the stroke:

  /// Holds still, or continues with another sculptor, version or puppet. `change` gets the previous
  /// ones. Hands whose poses jumped, as by another filter, grab where they are.
  void finish(PreparedChange& change, const Hands& hands, Frame& frame, LoopStats& stats) noexcept;
  /// Ends all that came before (Shaping::restart()), and writes the state.
  void restart(LogChange& change, const Hands& hands, Frame& frame, LoopStats& stats) noexcept;

  const Shaping& shaping() const noexcept { return shaping_; }
  const PuppetPlayer* puppet() const noexcept { return puppet_ ? &*puppet_ : nullptr; }
  /// Returns whether the switch at that hand's wrist is the clutch of the puppet.
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
  std::shared_ptr<HandBodies>
      bodies_; ///< bodies of hands that press clay; in the order of Side, if there are two
  std::optional<double> mirror_; ///< mirror_of() the puppet or masks
  deform::Points tips_; ///< control points: of hands, or of the puppet; 3 by #, model units
  Shaping shaping_;
  std::optional<PuppetPlayer> puppet_; ///< none: the hands touch the model
  std::unique_ptr<DrawnBlade> blade_;
  bool holds_after_blade_ = false; ///< the hands held the model before they drew
};

} // namespace nendo::flow
