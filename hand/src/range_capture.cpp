#include <nendo/hand/range_capture.hpp>

#include <algorithm>

namespace nendo::hand {

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
    const double middle =
        std::max(std::min(earlier, before), std::min(std::max(earlier, before), now));
    const bool first = !seen_.present.has(sensor);
    seen_.present.add(sensor);
    seen_.low_counts[slot] = first ? middle : std::min(seen_.low_counts[slot], middle);
    seen_.high_counts[slot] = first ? middle : std::max(seen_.high_counts[slot], middle);
  }
}

} // namespace nendo::hand
