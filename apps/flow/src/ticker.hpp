#pragma once
// The side of a DeformLoop that belongs to the thread of run(): inputs, core, statistics, frames.

#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/shaping_core.hpp>

#include "hand_inputs.hpp"

namespace nendo::flow {

class DeformLoop::Ticker {
public:
  Ticker(ChangeBroker& changes, const LoopOptions& options, const CoreOptions& core,
         std::vector<HandInput> hands, const Placement& placement);

  void run(const std::atomic<bool>& stop, std::uint64_t max_ticks) noexcept;
  void tick(const Pacer::Due& due) noexcept;

  FrameExchange& frames() noexcept { return frames_; }
  deform::FieldStatus grab_status() const noexcept { return grab_status_; }
  const LoopStats& stats() const noexcept { return stats_; }
  ShapingCore& core() noexcept { return core_; }

private:
  // In take_input.cpp:
  void take_input(TickRecord& record) noexcept;
  void take_commands(HostTime scheduled) noexcept;
  void take_script(HostTime scheduled) noexcept;
  void take_samples(TickRecord& record) noexcept;
  void take(std::uint8_t number, const GloveSample& sample) noexcept;
  void apply(const Command& command) noexcept;
  void update_switches() noexcept;
  // In ticker.cpp:
  void begin_change() noexcept;
  void finish_change(Frame& frame) noexcept;
  void end_change() noexcept;
  void describe(const TickRecord& record, Frame& frame) noexcept;
  void record_latencies(const TickRecord& record) noexcept;

  LoopOptions options_;
  JobOffer<PreparedChange*>& changes_;
  ShapingCore core_;
  HandInputs inputs_;
  PreparedChange* change_ = nullptr; ///< that this tick finishes
  bool switch_on_ = false;           ///< any hand's, for SwitchAction::grab
  bool draws_in_time_ = false;       ///< by LoopOptions::wire_time
  HostTime first_due_{};             ///< the first tick's deadline
  HostTime last_woke_{};             ///< the previous tick's; HostTime{} at first
  LoopStats stats_;
  FrameExchange frames_;
  deform::FieldStatus grab_status_ = deform::FieldStatus::ok;
};

} // namespace nendo::flow
