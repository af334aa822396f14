#include "bench/test_pattern.hpp"

#include <array>
#include <bit>

namespace nendo::bench {
namespace {

constexpr unsigned cycle = 255;

constexpr unsigned pattern(unsigned record, unsigned slot) noexcept {
  return 1 + (record + 29 * slot) % cycle;
}

} // namespace

PatternVerdict judge_pattern(const GloveSample& sample, unsigned steps_a_count) noexcept {
  std::array<unsigned, cycle> votes{};
  unsigned present = 0;
  for (unsigned slot = 0; slot < sensor_slots; ++slot) {
    if (!sample.present.has(static_cast<Sensor>(slot))) continue;
    ++present;
    if (sample.raw[slot].value % steps_a_count != 0) continue;
    const unsigned count = sample.raw[slot].value / steps_a_count;
    ++votes[(count + cycle - 1 + (cycle - 29 % cycle) * slot) % cycle];
  }
  unsigned record = 0;
  for (unsigned k = 1; k < cycle; ++k)
    record = votes[k] > votes[record] ? k : record;
  if (present > 0 && votes[record] == present) return PatternVerdict::whole;
  constexpr unsigned max_flips = 2; // more in one record would be stranger than a broken one
  if (votes[record] + max_flips < present || votes[record] <= max_flips)
    return PatternVerdict::broken;
  for (unsigned slot = 0; slot < sensor_slots; ++slot) {
    if (!sample.present.has(static_cast<Sensor>(slot))) continue;
    const unsigned expected = pattern(record, slot) * steps_a_count;
    if (std::popcount(sample.raw[slot].value ^ expected) > 1) return PatternVerdict::broken;
  }
  return PatternVerdict::flipped;
}

} // namespace nendo::bench
