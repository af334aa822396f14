#include "bench/stranger_kind.hpp"

namespace nendo::bench {

std::vector<StrangerRead> stranger_reads() {
  std::vector<StrangerRead> reads{{Sensor::thumb_roll, Sensor::thumb_abduction, -0.1, 0.2, false},
                                  {Sensor::thumb_abduction, Sensor::thumb_roll, 0.1, 0.15, false}};
  constexpr auto first = static_cast<std::size_t>(Sensor::index_mcp);
  for (std::size_t k = 0; k < gap_sensors.size(); ++k) {
    reads.push_back({gap_sensors[k], static_cast<Sensor>(first + 4 * k), 0.08, 0.08, false});
    reads.push_back({gap_sensors[k], static_cast<Sensor>(first + 4 * k + 4), 0.08, 0.08, false});
  }
  for (std::size_t n = first; n < static_cast<std::size_t>(Sensor::palm_arch); ++n)
    if (stranger_joints[n].gain != 0.0 && n % 4 != 3)
      reads.push_back(
          {static_cast<Sensor>(n), Sensor::wrist_pitch, 0.0, n % 4 == 0 ? 0.035 : 0.015, true});
  reads.push_back({Sensor::thumb_roll, Sensor::thumb_mcp, 0.0, 0.05, true});
  return reads;
}

std::vector<std::size_t> touching_slots(std::size_t digit) {
  std::vector<std::size_t> chosen{0, 1, 2, 3};
  for (std::size_t k = 0; digit > 0 && k < 3; ++k)
    chosen.push_back(4 * digit + k);
  return chosen;
}

std::size_t touching_digit(hand::Joint with) {
  for (std::size_t digit = 1; digit < 5; ++digit)
    if (with == hand::fingertips[digit]) return digit;
  return 0;
}

} // namespace nendo::bench
