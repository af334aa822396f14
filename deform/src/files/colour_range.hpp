#pragma once
// Colours of files that no rule of their format gives a range: from 0 to 1, to 255 or to 65535.

#include <cmath>
#include <string>

namespace nendo::deform {

/// The numbers that a file has for one part of a colour.
enum class ColourNumbers {
  floats,
  int8,
  int16,
  int32,
  factors ///< floats of materials, which some programs make brighter than 1 on purpose
};

/// Finds out, from all colours of a file, which number stands for full. Floats are from 0 to 1 as
/// long as none is above 1; else from 0 to 255, or from 0 to 65535. Where fractions are above 1 and
/// none is above 2, they are from 0 to 1, and what is above is full; so are factors up to 10.
/// Integers of 8 bits are from 0 to 255; those of more bits, as long as none is above 255, and
/// from 0 to 65535 else.
class ColourRange {
public:
  explicit ColourRange(ColourNumbers numbers = ColourNumbers::floats) noexcept
      : numbers_(numbers) {}

  /// Takes a part of a colour into account; what is not finite counts for nothing.
  void see(double value) noexcept;
  /// Returns the number that stands for full.
  double full() const noexcept;
  /// Returns the part of 1 that the value is; 0 for what is not a number.
  float part_of(double value) const noexcept;
  /// Returns a note for the reader's caller if the range is not what the format's readers agree
  /// about, or an empty text.
  std::string note() const;

private:
  ColourNumbers numbers_;
  double max_ = 0.0;
  bool all_whole_ = true;
};

// In double, so that the float is the same from every machine's pow().
inline float linear_of(float encoded) noexcept {
  const auto value = static_cast<double>(encoded);
  return static_cast<float>(value <= 0.04045 ? value / 12.92
                                             : std::pow((value + 0.055) / 1.055, 2.4));
}

inline float encoded_of(float linear) noexcept {
  const auto value = static_cast<double>(linear);
  return static_cast<float>(value <= 0.0031308 ? value * 12.92
                                               : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055);
}

} // namespace nendo::deform
