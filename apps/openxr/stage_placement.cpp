#include "openxr/stage_placement.hpp"

#include <array>
#include <clocale>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <numbers>

namespace nendo::openxr {
namespace {

constexpr double max_position_m = 100.0;
constexpr double max_turn_degrees = 360.0;

/// The numbers of a program's locale may have a decimal comma.
class PlainNumbers {
public:
  PlainNumbers() noexcept : locale_(::newlocale(LC_NUMERIC_MASK, "C", nullptr)) {}
  ~PlainNumbers() noexcept {
    if (locale_ != nullptr) ::freelocale(locale_);
  }
  PlainNumbers(const PlainNumbers&) = delete;
  PlainNumbers& operator=(const PlainNumbers&) = delete;

  /// Reads a number at `*at`, and moves that behind it.
  bool read(const char** at, double limit, double& number) const noexcept {
    if (locale_ == nullptr) return false;
    char* end = nullptr;
    number = ::strtod_l(*at, &end, locale_);
    const bool is_number = end != *at && std::abs(number) <= limit; // not so of a NaN
    *at = end;
    return is_number;
  }

private:
  locale_t locale_;
};

struct NamedSpace {
  const char* name;
  XrReferenceSpaceType type;
};
constexpr std::array named_spaces{NamedSpace{"local:", XR_REFERENCE_SPACE_TYPE_LOCAL},
                                  NamedSpace{"stage:", XR_REFERENCE_SPACE_TYPE_STAGE}};

/// Reads three or four numbers, with commas between them.
bool read_numbers(const char* at, std::array<double, 4>& numbers) noexcept {
  const PlainNumbers plain;
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    if (!plain.read(&at, n < 3 ? max_position_m : max_turn_degrees, numbers[n])) return false;
    if (*at == '\0') return n >= 2;
    if (*at++ != ',') return false;
  }
  return false;
}

} // namespace

bool read_placement(const char* text, StagePlacement& placement) noexcept {
  for (const NamedSpace& space : named_spaces) {
    const std::size_t length = std::strlen(space.name);
    if (std::strncmp(text, space.name, length) != 0) continue;
    std::array<double, 4> numbers{};
    if (!read_numbers(text + length, numbers)) return false;
    const double half_turn_rad = numbers[3] * std::numbers::pi / 360.0;
    placement.space = space.type;
    placement.pose.position = {static_cast<float>(numbers[0]), static_cast<float>(numbers[1]),
                               static_cast<float>(numbers[2])};
    placement.pose.orientation = {0.0F, static_cast<float>(std::sin(half_turn_rad)), 0.0F,
                                  static_cast<float>(std::cos(half_turn_rad))};
    return true;
  }
  return false;
}

} // namespace nendo::openxr
