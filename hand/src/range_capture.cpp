#include <nendo/hand/range_capture.hpp>

#include <algorithm>

namespace nendo::hand {

void CountRanges::widen(Sensor sensor, double counts) noexcept {
  const auto slot = index_of(sensor);
  const bool first = !present.has(sensor);
  present.add(sensor);
  low_counts[slot] = first ? counts : std::min(low_counts[slot], counts);
  high_counts[slot] = first ? counts : std::max(high_counts[slot], counts);
}

void RangeCapture::push(const GloveSample& sample) noexcept {
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto sensor = static_cast<Sensor>(slot);
    Last& last = last_[slot];
    if (!sample.present.has(sensor)) {
      last.known = 0;
      continue;
    }
    const double now = sample.raw[slot].value;
    const auto [earlier, before] = last.counts;
    last.counts = {before, now};
    if (last.known < 2) {
      ++last.known;
      continue;
    }
    seen_.widen(sensor,
                std::max(std::min(earlier, before), std::min(std::max(earlier, before), now)));
  }
}

} // namespace nendo::hand
