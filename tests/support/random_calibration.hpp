#pragma once
// Makes random calibrations with any content that a file may have.

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include <nendo/hand/calibration_file.hpp>

namespace nendo::test {

/// Returns a double between -most and most, of any magnitude, with a random mantissa.
inline double random_number(std::mt19937_64& random, double most) {
  std::uniform_real_distribution<double> mantissa(-most, most);
  std::uniform_int_distribution<int> exponent(-60, 0);
  return random() % 8 == 0 ? 0.0
                           : std::ldexp(mantissa(random), random() % 2 ? 0 : exponent(random));
}

inline std::string random_text(std::mt19937_64& random, std::size_t least) {
  static const std::string parts[] = {"a",       "Z",   "9",  " ",  "\"",
                                      "\\",      "/",   "..", "#",  "=",
                                      "'",       "%",   "é",  "手", "\xF0\x9F\xA7\xA4",
                                      "\\u0041", "[x]", "+",  "_"};
  std::string text;
  const std::size_t count = least + random() % 12;
  for (std::size_t k = 0; k < count; ++k)
    text += parts[random() % std::size(parts)];
  return text;
}

inline hand::WearerCalibration random_calibration(std::mt19937_64& random) {
  hand::WearerCalibration wearer;
  wearer.user = random_text(random, 1);
  wearer.glove_model = random_text(random, 0);
  wearer.glove_serial = random_text(random, 0);
  wearer.method = random_text(random, 1);
  wearer.side = random() % 2 ? Side::left : Side::right;
  wearer.counts = {static_cast<std::uint16_t>(1 + random() % 65535), random() % 2 == 0};
  wearer.made = std::chrono::sys_seconds(std::chrono::seconds(random() % 253402300800ULL));
  wearer.size = {std::uniform_real_distribution(0.05, 0.35)(random),
                 std::uniform_real_distribution(0.02, 0.2)(random)};
  for (std::size_t k = 0; random() % 2 == 0 && k < hand::shape_terms; ++k)
    wearer.size.shape.terms[k] =
        random_number(random, hand::max_of(static_cast<hand::ShapeTerm>(k)));
  wearer.calibration.middle_bias = random_number(random, 10.0);
  for (double& gain : wearer.calibration.coupling_gains)
    gain = random() % 4 == 0 ? -0.0 : random_number(random, 10.0);
  for (std::size_t slot = 0; slot + 1 < sensor_slots; ++slot) {
    const double gain = std::abs(random_number(random, 255.0 / wearer.counts.max_count));
    if (gain == 0.0 || random() % 8 == 0) {
      if (random() % 2 == 0) wearer.left_out.add(static_cast<Sensor>(slot));
      continue;
    }
    wearer.calibration.sensors[slot] = {gain, random_number(random, 65535.0)};
    if (random() % 2) continue;
    const double least = std::abs(random_number(random, 30000.0));
    wearer.quality[slot] = {std::abs(random_number(random, 10.0)), least,
                            least + std::abs(random_number(random, 30000.0)),
                            std::abs(random_number(random, 1.0))};
  }
  return wearer;
}

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

inline bool same_bits(const hand::Calibration& a, const hand::Calibration& b) {
  bool same = same_bits(a.middle_bias, b.middle_bias);
  for (std::size_t k = 0; k < a.coupling_gains.size(); ++k)
    same = same && same_bits(a.coupling_gains[k], b.coupling_gains[k]);
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    const auto& x = a.sensors[slot];
    const auto& y = b.sensors[slot];
    same = same && same_bits(x.gain_rad_per_count, y.gain_rad_per_count) &&
           same_bits(x.offset_counts, y.offset_counts);
  }
  return same;
}

inline bool same_bits(const hand::WearerCalibration& a, const hand::WearerCalibration& b) {
  return a.user == b.user && a.glove_model == b.glove_model && a.glove_serial == b.glove_serial &&
         a.counts == b.counts && a.side == b.side && a.made == b.made && a.method == b.method &&
         same_bits(a.size.length_m, b.size.length_m) &&
         same_bits(a.size.breadth_m, b.size.breadth_m) && a.size.shape == b.size.shape &&
         a.quality == b.quality && a.left_out == b.left_out &&
         same_bits(a.calibration, b.calibration);
}

} // namespace nendo::test
