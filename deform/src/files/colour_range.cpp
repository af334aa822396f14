#include "files/colour_range.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::deform {
namespace {

constexpr double full_of_bytes = 255.0;
constexpr double full_of_words = 65535.0;
constexpr double max_overshoot = 2.0; // of colours that a filter has sharpened
constexpr double max_factor = 10.0;

} // namespace

void ColourRange::see(double value) noexcept {
  if (!std::isfinite(value)) return;
  max_ = std::max(max_, value);
  all_whole_ = all_whole_ && value == std::floor(value);
}

double ColourRange::full() const noexcept {
  if (numbers_ == ColourNumbers::int8) return full_of_bytes;
  if (numbers_ == ColourNumbers::factors) return max_ > max_factor ? full_of_bytes : 1.0;
  if (numbers_ != ColourNumbers::floats)
    return max_ > full_of_bytes ? full_of_words : full_of_bytes;
  const bool overshoots = max_ <= max_overshoot && !all_whole_;
  if (max_ <= 1.0 || overshoots) return 1.0;
  return max_ > full_of_bytes ? full_of_words : full_of_bytes;
}

float ColourRange::part_of(double value) const noexcept {
  const double part = value / full();
  if (!(part > 0.0)) return 0.0F; // NaN, too
  return static_cast<float>(std::min(part, 1.0));
}

std::string ColourRange::note() const {
  if (numbers_ == ColourNumbers::int8 || max_ <= 0.0) return {};
  const bool is_words = full() == full_of_words;
  if (numbers_ == ColourNumbers::int16)
    return is_words ? "" : "no colour is above 255, so the 16-bit colours are read as 0 to 255";
  if (is_words) return "colours above 255 were found, so colours are read as 0 to 65535";
  if (numbers_ == ColourNumbers::int32 || max_ <= 1.0) return {};
  return full() == 1.0 ? "some colours are above 1; they are taken as 1"
                       : "colours above 1 were found, so colours are read as 0 to 255";
}

} // namespace nendo::deform
