#pragma once
// The statistics of a stress test's ticks. Another thread computes them from the loop's records, in
// constant memory.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <nendo/flow/histogram.hpp>
#include <nendo/flow/pacer.hpp>

#include "stress/incident.hpp"

namespace nendo::stress {

enum class Measure : std::uint8_t { lateness, period_error, work, input_age, end_to_end };
inline constexpr std::array<std::string_view, 5> measure_names{"lateness", "period_error", "work",
                                                               "input_age", "end_to_end"};

/// `raw` has a value for each tick that ran. `corrected` has one for each tick that was scheduled,
/// so that a long stall counts for all the ticks that it prevented (coordinated omission). For the
/// lateness that is exact, since a missed deadline waited for the next tick. For the others it is
/// HdrHistogram's rule: a value v beyond the period T also stands for v - T, v - 2T, and so on.
struct Distribution {
  flow::Histogram raw;
  flow::Histogram corrected;
};

/// The lateness over time in a limited number of slices, which get longer as time continues.
class LatenessTrace {
public:
  static constexpr std::size_t max_slices = 512;
  struct Slice {
    std::uint64_t count = 0;
    std::chrono::nanoseconds sum{};
    std::chrono::nanoseconds max{};
  };
  void add(HostTime time, std::chrono::nanoseconds lateness);
  const std::vector<Slice>& slices() const noexcept { return slices_; }
  HostClock::duration slice_length() const noexcept { return length_; }

private:
  HostTime start_{};
  HostClock::duration length_ = std::chrono::milliseconds(10);
  std::vector<Slice> slices_;
};

class TickTally {
public:
  /// A tick that is later than this is an incident that has to be explained.
  static constexpr std::chrono::milliseconds incident_threshold{1};
  static constexpr std::size_t max_worst = 10;

  explicit TickTally(const flow::PaceOptions& pace);

  /// Adds the next record. `delay` must have been sampled after the record was made; null means
  /// unknown.
  void add(const flow::TickRecord& record, const RunDelay* delay);

  std::uint64_t ticks() const noexcept { return ticks_; }
  std::uint64_t samples() const noexcept { return samples_; }
  /// Returns the longest time from one wake-up to the next.
  std::chrono::nanoseconds longest_outage() const noexcept { return longest_outage_; }
  const Distribution& operator[](Measure measure) const noexcept {
    return distributions_[static_cast<std::size_t>(measure)];
  }
  /// Returns the times that a stage took; for Phase::wake the times spun.
  const flow::Histogram& stage(Phase phase) const noexcept {
    return stages_[static_cast<std::size_t>(phase)];
  }
  /// Returns the incidents with the greatest lateness, the greatest first, at most max_worst.
  const std::vector<Incident>& worst() const noexcept { return worst_; }
  /// The incidents of a cause that are beyond the threshold, and the sum of their lateness.
  struct Share {
    std::uint64_t incidents = 0;
    std::chrono::nanoseconds lateness{};
  };
  const std::array<Share, cause_names.size()>& causes() const noexcept { return causes_; }
  /// Returns the fraction of the incidents' lateness whose cause is known; 1 if there was no
  /// incident.
  double explained() const noexcept;
  const LatenessTrace& trace() const noexcept { return trace_; }

private:
  void add_stages(const flow::TickRecord& record) noexcept;
  void add_step(const flow::TickRecord& before, const flow::TickRecord& record,
                const RunDelay* delay);
  void record(Measure measure, HostClock::duration value) noexcept;
  UsualTimes usual_times() const noexcept;

  std::chrono::nanoseconds period_;
  bool on_grid_;
  std::optional<flow::TickRecord> before_;
  std::uint64_t ticks_ = 0;
  std::uint64_t samples_ = 0;
  std::chrono::nanoseconds longest_outage_{};
  std::array<Distribution, measure_names.size()> distributions_;
  std::array<flow::Histogram, phase_names.size()> stages_;
  /// The stages of ticks that took samples only; other ticks had almost nothing to do.
  std::array<flow::Histogram, phase_names.size()> busy_stages_;
  std::vector<Incident> worst_;
  std::array<Share, cause_names.size()> causes_{};
  LatenessTrace trace_;
};

} // namespace nendo::stress
