#pragma once
// The loop's counters, in memory of fixed size.

#include <array>
#include <cstdint>

#include <nendo/base/units.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/clay_hands.hpp>
#include <nendo/flow/histogram.hpp>
#include <nendo/hand/range_adaptation.hpp>

namespace nendo::flow {

/// How fast a glove's samples came from the loop's first tick on. What had waited for that tick,
/// while another glove was opened or the model was placed, says nothing of a glove's rate.
struct SampleRate {
  std::uint64_t samples = 0; ///< after the first tick's last one
  HostTime first{};          ///< when that one arrived
  HostTime last{};           ///< when the latest one did

  /// 0 until there are two.
  double per_s() const noexcept {
    return last > first ? static_cast<double>(samples) / to_seconds(last - first) : 0.0;
  }
};

/// Loop's thread; others read them when run() has returned.
struct LoopStats {
  std::uint64_t ticks = 0;
  std::uint64_t overruns = 0; ///< ticks that ended after the next deadline
  std::uint64_t missed = 0;   ///< deadlines that were skipped for it, as OverrunPolicy says
  std::uint64_t failed = 0;   ///< ticks without a usable field: the shape stayed as it was
  std::array<std::uint64_t, 2> samples{};
  std::array<SampleRate, 2> rates{};
  std::array<std::uint64_t, 2> silences{};
  std::array<std::uint64_t, 2> switch_uses{}; ///< how often a hand's switch was turned on
  std::array<std::array<std::uint64_t, sensor_slots>, 2> spikes{}; ///< kept out, by sensor
  std::array<hand::SensorRanges, 2> ranges{}; ///< learned; zeros if not adapting
  std::array<SensorMask, 2> left_out{};       ///< sensors that are left out, because they are stuck
  std::array<SensorMask, 2> was_left_out{};   ///< at any time
  std::array<Side, 2> range_sides{};          ///< the sides of the gloves with these ranges
  /// By how many counts sensors have slipped; zeros if that is not learned.
  std::array<hand::SensorAngles, 2> slips_counts{};
  std::uint64_t grabs = 0;            ///< times the hands grabbed again
  std::uint64_t commits = 0;          ///< times it became the rest shape, also by releasing
  std::uint64_t undos = 0;            ///< times it became an earlier one
  std::uint64_t redos = 0;            ///< times it became what it had been before an undo
  std::uint64_t resets = 0;           ///< times it became what it was at first
  std::uint64_t changes = 0;          ///< changes of settings
  std::uint64_t undo_steps = 0;       ///< as many commits can be undone
  std::uint64_t forgotten_steps = 0;  ///< could not any more, for want of memory
  std::uint64_t refused_steps = 0;    ///< undos, redos and resets that found too many waiting
  int max_links = 0;                  ///< the maximum per tick; 0 unless the sculptor is injective
  double max_bound = 0.0;             ///< Lipschitz bound of a tick, had it been one link
  double min_determinant = 1.0;       ///< ChainReport::min_determinant of any tick
  std::uint64_t held_apart_ticks = 0; ///< ticks in which fingertips were kept apart
  std::uint64_t touching_ticks = 0;   ///< ticks in which hands touched clay
  double max_penetration_mm = 0.0;    ///< the depth of clay in a hand, before its correction
  ClayState clay{};                   ///< the state at the last tick in which hands shaped clay
  Histogram wake_latency;             ///< from TickRecord::scheduled to the loop's running
  Histogram work;                     ///< from there to the published frame
  Histogram end_to_end; ///< from a sample's last byte to the published frame that shows it
  /// The hand::FilterLatency of each hand at each tick with samples. end_to_end does not contain
  /// it.
  Histogram filter_moving;
  Histogram filter_worst;
};

} // namespace nendo::flow
