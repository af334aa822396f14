#pragma once
// A glove's samples as they come, or brought to a fixed rate: at each time of a grid the newest
// sample that had arrived. When the program gets to run does not matter: a sample that arrived
// after a grid time is never taken for it, however late the samples are read, and no grid time is
// left out or moves.

#include <chrono>
#include <optional>

#include <nendo/driver/sample.hpp>
#include <nendo/flow/tick_grid.hpp>

namespace nendo::gloves {

class SampleGrid {
public:
  /// The grid's first time is `start`. `rate_hz`: 0 for the samples as they come, or within
  /// TickGrid's limits, which keeps it to a thousandth of a hertz.
  SampleGrid(HostTime start, double rate_hz) {
    if (rate_hz > 0.0) grid_.emplace(start, rate_hz);
  }

  /// The next sample. `emit(HostTime, const GloveSample&)` is called for the grid times before it
  /// and gives back whether to go on; false: it did not want to.
  template <class Emit>
  bool take(const GloveSample& sample, Emit&& emit) {
    if (!grid_) return emit(sample.arrival, sample);
    if (newest_ && !emit_until(sample.arrival - HostClock::duration(1), emit)) return false;
    newest_ = sample;
    return true;
  }
  /// All samples that arrived until `now` have been taken.
  template <class Emit>
  bool pass_time(HostTime now, Emit&& emit) {
    return !grid_ || !newest_ || emit_until(now, emit);
  }

private:
  template <class Emit>
  bool emit_until(HostTime last, Emit&& emit) {
    for (; grid_->deadline(next_) <= last; ++next_)
      if (!emit(grid_->deadline(next_), *newest_)) return false;
    return true;
  }

  std::optional<flow::TickGrid> grid_;
  std::uint64_t next_ = 0;
  std::optional<GloveSample> newest_;
};

} // namespace nendo::gloves
