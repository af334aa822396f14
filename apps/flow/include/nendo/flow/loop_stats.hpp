#pragma once
// The loop's counters, of fixed size.

#include <array>
#include <cstdint>

#include <nendo/base/units.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/clay_hands.hpp>
#include <nendo/flow/histogram.hpp>
#include <nendo/hand/range_adaptation.hpp>
#include <nendo/hand/wrist_tracking.hpp>

namespace nendo::flow {

/// A glove's sample rate since the loop's first tick. Samples that waited for that tick, while
/// another glove was opened or the model was placed, do not count.
struct SampleRate {
  std::uint64_t samples = 0; ///< after the last sample of the first tick
  HostTime first{};          ///< the arrival of that sample
  HostTime last{};           ///< the arrival of the latest sample

  /// 0 until there are two samples.
  double per_s() const noexcept {
    return last > first ? static_cast<double>(samples) / to_seconds(last - first) : 0.0;
  }
};

/// The counts of a tracked wrist.
struct WristStats {
  bool tracked = false;
  bool is_lost = false;
  hand::TrackingCounts counts{};
  std::uint64_t releases = 0; ///< returns so far away that the hand released the model first
};

/// Loop's thread; other threads only after run() has returned.
struct LoopStats {
  std::uint64_t ticks = 0;
  std::uint64_t overruns = 0; ///< ticks that ended after the next deadline
  std::uint64_t missed = 0;   ///< deadlines skipped after overruns (OverrunPolicy)
  std::uint64_t failed = 0;   ///< ticks without a usable field; the shape did not change
  std::array<std::uint64_t, 2> samples{};
  std::array<SampleRate, 2> rates{};
  std::array<std::uint64_t, 2> silences{};
  std::array<std::uint64_t, 2> switch_uses{}; ///< how often a hand's switch was turned on
  std::array<std::array<std::uint64_t, sensor_slots>, 2> spikes{}; ///< rejected, by sensor
  std::array<hand::SensorRanges, 2> ranges{}; ///< the learned ranges; zeros without adaptation
  std::array<SensorMask, 2> left_out{};       ///< stuck sensors, which are left out now
  std::array<SensorMask, 2> was_left_out{};   ///< sensors that were left out at any time
  std::array<Side, 2> range_sides{};          ///< the glove's side for each of `ranges`
  /// The learned slips of sensors, in counts; zeros if none are learned.
  std::array<hand::SensorAngles, 2> slips_counts{};
  std::uint64_t grabs = 0;            ///< the number of re-grabs
  std::uint64_t commits = 0;          ///< the number of commits, also by a release
  std::uint64_t undos = 0;            ///< the number of undone steps
  std::uint64_t redos = 0;            ///< the number of redone steps
  std::uint64_t resets = 0;           ///< the number of resets
  std::uint64_t changes = 0;          ///< changes of settings
  std::uint64_t undo_steps = 0;       ///< steps that can be undone now
  std::uint64_t forgotten_steps = 0;  ///< steps dropped for lack of undo memory
  std::uint64_t refused_steps = 0;    ///< undos, redos and resets refused because too many waited
  int max_links = 0;                  ///< the maximum per tick; 0 unless the sculptor is injective
  double max_bound = 0.0;             ///< the largest Lipschitz bound of a tick as one link
  double min_determinant = 1.0;       ///< the smallest ChainReport::min_determinant
  std::uint64_t held_apart_ticks = 0; ///< ticks in which fingertips were kept apart
  std::uint64_t touching_ticks = 0;   ///< ticks in which hands touched clay
  double max_penetration_mm = 0.0;    ///< the depth of clay in a hand, before its correction
  ClayState clay{};                   ///< in the last tick in which hands shaped clay
  Histogram wake_latency;             ///< from TickRecord::scheduled to the wake-up
  Histogram work;                     ///< from the wake-up to the published frame
  Histogram end_to_end; ///< from a sample's last byte to the published frame that shows it
  std::array<WristStats, 2> wrists{};
  Histogram pose_to_frame; ///< from a pose's last byte to the published frame that shows it
  Histogram pose_age;      ///< from the measurement of that pose
  /// The hand::FilterLatency of each hand at each tick with samples; not part of end_to_end.
  Histogram filter_moving;
  Histogram filter_worst;
};

} // namespace nendo::flow
