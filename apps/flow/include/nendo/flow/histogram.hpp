#pragma once
// A histogram of durations with constant relative precision and constant size, for use inside the
// loop.

#include <algorithm>
#include <array>
#include <cstdint>

#include <nendo/base/units.hpp>

namespace nendo::flow {

class NENDO_API Histogram {
public:
  using Nanoseconds = std::chrono::nanoseconds;

  /// Counts `value`, `count` times. Negative durations count as zero. Wait-free, without
  /// allocation.
  void record(HostClock::duration value, std::uint64_t count = 1) noexcept;

  std::uint64_t count() const noexcept { return count_; }
  Nanoseconds min() const noexcept { return Nanoseconds(count_ == 0 ? 0 : min_ns_); }
  Nanoseconds max() const noexcept { return Nanoseconds(max_ns_); }
  /// Returns the smallest value that `fraction` (0 to 1) of all values do not exceed, to within 1.6
  /// %, and at most max().
  Nanoseconds percentile(double fraction) const noexcept;
  /// Calls sink(longest, count) for each non-empty bucket, shortest durations first. `longest` is
  /// the bucket's upper limit, at most max().
  template <class Sink>
  void for_each(Sink&& sink) const {
    for (std::size_t bucket = 0; bucket < bucket_count; ++bucket) {
      if (buckets_[bucket] == 0) continue;
      const bool last = bucket + 1 == bucket_count;
      const Nanoseconds top(static_cast<std::int64_t>(top_of(bucket)));
      sink(last ? max() : std::min(top, max()), buckets_[bucket]);
    }
  }

private:
  // There are 64 buckets per octave; values below 64 ns have one each. Values above 2^40 ns, which
  // is 18 minutes, share the last bucket.
  static constexpr unsigned sub_bits = 6;
  static constexpr unsigned max_bits = 40;
  static constexpr std::size_t bucket_count = (max_bits - sub_bits + 1) << sub_bits;
  static std::size_t bucket_of(std::uint64_t ns) noexcept;
  static std::uint64_t top_of(std::size_t bucket) noexcept;

  std::array<std::uint64_t, bucket_count> buckets_{};
  std::uint64_t count_ = 0;
  std::int64_t min_ns_ = INT64_MAX;
  std::int64_t max_ns_ = 0;
};

} // namespace nendo::flow
