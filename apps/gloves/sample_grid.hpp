#pragma once
// Passes on a glove's samples as they come, or at a fixed rate: at each time of a grid the newest
// sample that had arrived. The result does not depend on when the program gets to run. A sample
// that arrived after a grid time is never taken for it, however late the samples are read, and no
// grid time is left out or moved.

#include <optional>

#include <nendo/driver/sample.hpp>
#include <nendo/flow/pacer.hpp>

namespace nendo::gloves {

class SampleGrid {
public:
  /// The grid's first time is `start`. `rate_hz` is 0 for the samples as they come, or else within
  /// the limits of TickGrid, which rounds it to a thousandth of a hertz.
  SampleGrid(HostTime start, double rate_hz) {
    if (rate_hz > 0.0) grid_.emplace(start, rate_hz);
  }

  /// Takes the next sample. Calls `emit(HostTime, const GloveSample&)` for the grid times before
  /// it; `emit` returns whether to continue. Returns false if `emit` did.
  template <class Emit>
  bool take(const GloveSample& sample, Emit&& emit) {
    if (!grid_) return emit(sample.arrival, sample);
    if (newest_ && !emit_until(sample.arrival - HostClock::duration(1), emit)) return false;
    newest_ = sample;
    return true;
  }
  /// Says that all samples that arrived until `now` have been taken. Calls `emit` and returns as
  /// take() does.
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
