#include <nendo/flow/histogram.hpp>

#include <bit>
#include <cmath>

namespace nendo::flow {

std::size_t Histogram::bucket_of(std::uint64_t ns) noexcept {
  const auto width = static_cast<unsigned>(std::bit_width(ns));
  if (width <= sub_bits) return static_cast<std::size_t>(ns);
  const unsigned octave =
      width - sub_bits; // how many low bits the bucket does not distinguish, plus one
  const std::uint64_t mantissa = ns >> (octave - 1);
  const std::size_t bucket =
      (static_cast<std::size_t>(octave) << sub_bits) + static_cast<std::size_t>(mantissa & 63U);
  return std::min(bucket, bucket_count - 1);
}

std::uint64_t Histogram::top_of(std::size_t bucket) noexcept {
  const std::size_t octave = bucket >> sub_bits;
  const std::uint64_t low = bucket & 63U;
  if (octave == 0) return low;
  return ((low + 64U + 1U) << (octave - 1)) - 1U;
}

void Histogram::record(HostClock::duration value, std::uint64_t count) noexcept {
  if (count == 0) return;
  const std::int64_t ns =
      std::max<std::int64_t>(0, std::chrono::duration_cast<Nanoseconds>(value).count());
  buckets_[bucket_of(static_cast<std::uint64_t>(ns))] += count;
  count_ += count;
  min_ns_ = std::min(min_ns_, ns);
  max_ns_ = std::max(max_ns_, ns);
}

Histogram::Nanoseconds Histogram::percentile(double fraction) const noexcept {
  if (count_ == 0) return Nanoseconds(0);
  const double wanted = std::ceil(std::clamp(fraction, 0.0, 1.0) * static_cast<double>(count_));
  const auto rank = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(wanted));
  std::uint64_t seen = 0;
  for (std::size_t bucket = 0; bucket < bucket_count; ++bucket) {
    seen += buckets_[bucket];
    if (seen >= rank && bucket + 1 < bucket_count) {
      return std::clamp(Nanoseconds(static_cast<std::int64_t>(top_of(bucket))), min(), max());
    }
  }
  return max();
}

} // namespace nendo::flow
