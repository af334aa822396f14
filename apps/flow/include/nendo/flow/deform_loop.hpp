#pragma once
// The loop drains the gloves' rings, computes both hands' fingertips, makes control vectors of
// them, deforms the model and publishes the frame, at a fixed rate.

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <nendo/flow/frame.hpp>
#include <nendo/flow/frame_sink.hpp>
#include <nendo/flow/input_log.hpp>
#include <nendo/flow/loop_stats.hpp>
#include <nendo/flow/pacer.hpp>
#include <nendo/flow/shaping.hpp>
#include <nendo/flow/tick_record.hpp>
#include <nendo/flow/wrist_switch.hpp>
#include <nendo/hand/active_calibration.hpp>
#include <nendo/hand/joint_filter.hpp>
#include <nendo/hand/sensor_gate.hpp>

namespace nendo::flow {

/// A hand as an input of the loop. Only the loop's thread drains `ring`, which must outlive the
/// loop.
struct HandInput {
  SampleRing* ring = nullptr;
  Side side = Side::right; ///< which hand it is on the stage, whichever glove it wears
  hand::Wearer wearer;
  GloveSample first;            ///< the pose in which the hand takes hold of the model
  bool gated = true;            ///< hand::SensorGate keeps out counts that no hand can have caused
  hand::FilterOptions filter{}; ///< for the joint angles, at the samples' own times
  /// Measured bones (HandSkeleton::of_bones) for gloves of the first sample's side, in place of the
  /// wearer's size. A recording does not keep them.
  std::optional<hand::HandSkeleton> measured{};

  /// Returns the skeleton for samples from a glove of that side. It always has the side `side`.
  hand::HandSkeleton skeleton(Side glove) const {
    if (measured && glove == first.side) return *measured;
    return hand::HandSkeleton(side, wearer.of(glove).size);
  }
};

/// The stages of a tick. A measurement may leave some out; their results then stay as they were.
struct TickStages {
  bool input = true;   ///< drains the rings
  bool hands = true;   ///< joints and fingertips
  bool deform = true;  ///< field and vertices
  bool publish = true; ///< gives the frame to the reader and the sinks
};

struct LoopOptions : PaceOptions {
  SculptorOptions sculptor;
  TickStages stages;
  /// The ring that gets every tick's record, or refuses it if it is full. It must outlive the loop.
  TickRing* records = nullptr;
  /// The commands, which the loop takes at the beginning of a tick. It must outlive the loop.
  CommandRing* commands = nullptr;
  /// The log to which the loop writes its input, for a recorder. It must outlive the loop.
  InputLog* input_log = nullptr;
  std::size_t undo_most_bytes = 0; ///< ShapingOptions::undo_most_bytes
  /// The sinks that are shown every frame. They must outlive the loop.
  std::vector<FrameSink*> sinks;
  /// Is notified of each sample that comes; OverrunPolicy::sample needs it. It must outlive the
  /// loop.
  EventCount* event_count = nullptr;
  HostClock::duration silent_after = std::chrono::milliseconds(500);
  SwitchAction switch_action = SwitchAction::none;
};

class DeformLoop {
public:
  /// `hands` are one or two, at most one of a side. Copies the model's vertices and allocates all
  /// that a tick needs. The hands take hold of the model at their first samples. With
  /// SwitchAction::grab they hold it only while a switch is on.
  DeformLoop(const deform::Mesh& model, const Placement& placement, std::vector<HandInput> hands,
             const LoopOptions& options);

  /// Runs ticks on the calling thread until `stop` or for `most_ticks` deadlines of the grid, also
  /// skipped ones. A tick does not allocate or lock; its only system call is the sleep. Call
  /// make_thread_realtime() first to make wake-ups punctual.
  void run(const std::atomic<bool>& stop,
           std::uint64_t most_ticks = std::numeric_limits<std::uint64_t>::max()) noexcept;
  /// Runs one tick without its sleep, for callers with a clock of their own, on the thread of
  /// run().
  void tick(std::uint64_t number, HostTime scheduled) noexcept {
    tick({number, scheduled, HostClock::now()});
  }
  /// Repeats a tick from an input log. The times that are measured of it mean nothing.
  void tick(std::uint64_t number, HostTime scheduled, HostTime woke) noexcept {
    tick(Pacer::Due{number, scheduled, woke});
  }

  /// Returns ok or merged if the hands could take hold of the model.
  deform::FieldStatus grab_status() const noexcept { return grab_status_; }
  /// One reader thread may poll it while the loop runs.
  FrameExchange& frames() noexcept { return frames_; }
  const LoopStats& stats() const noexcept { return stats_; }
  /// Returns where the hands are. Must not be called while the loop runs.
  Placement placement() const;
  /// Returns what adaptation has learned of the gloves, by Placement::index_of(); nullopt without
  /// adaptation. Must not be called while the loop runs.
  std::array<std::optional<hand::LearnedRanges>, 2> learned() const;
  /// Makes room for more undos, up to LoopOptions::undo_most_bytes. See Shaping::refill_undo().
  bool refill_undo() { return shaping_.refill_undo(); }
  /// Returns the layout, which turns a frame's shape into points in the mesh's order. Any thread.
  const deform::BlockLayout& layout() const noexcept { return shaping_.sculptor().layout(); }
  /// Completes the last stroke and returns the shape, 3 by #vertices. Call it when the loop has
  /// ended.
  deform::Points final_shape();

private:
  void tick(const Pacer::Due& due) noexcept;
  void take_commands() noexcept;
  void apply(const Command& command) noexcept;
  void take_samples(TickRecord& record) noexcept;
  void follow_switches() noexcept;
  void compute_hands(Frame& frame) noexcept;
  void describe(const TickRecord& record, Frame& frame) noexcept;
  void record_latencies(const TickRecord& record) noexcept;

  struct Hand {
    /// Updates `latest` and `angles` by the next sample.
    void follow(const GloveSample& sample) noexcept;
    const hand::HandSkeleton& skeleton() const noexcept {
      return skeletons[Placement::index_of(latest.side)];
    }

    HandInput input;
    std::size_t slot = 0; ///< of arrays by side
    Eigen::Isometry3d T_stage_wrist;
    std::array<hand::HandSkeleton, 2> skeletons; ///< by the glove's side
    hand::ActiveCalibration calibration;
    hand::SensorGate gate{};
    hand::JointFilter filter;
    GloveSample latest{};
    hand::JointAngles angles{}; ///< of `latest`, filtered
    WristSwitchEdge wrist_switch{};
    bool fresh = false; ///< samples came in with this tick
    bool silent = false;
  };

  LoopOptions options_;
  double units_per_metre_;
  std::vector<Hand> hands_;
  deform::Points tips_; ///< 3 by 5 a hand, model units
  Shaping shaping_;
  deform::FieldStatus grab_status_ = deform::FieldStatus::ok;
  bool switch_on_ = false; ///< any hand's, for SwitchAction::grab
  HostTime last_woke_{};   ///< of the tick before; HostTime{} at first
  LoopStats stats_;
  FrameExchange frames_;
};

} // namespace nendo::flow
