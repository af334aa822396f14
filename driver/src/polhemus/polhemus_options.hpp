#pragma once
// What Polhemus' trackers have in common: the options of their specifications, and the order in
// which rates of the line are tried.

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/device_spec.hpp>

namespace nendo::driver::polhemus {

struct Options {
  std::vector<std::uint16_t> stations; ///< in the order of the request
  std::optional<int> baud;             ///< else each known rate is tried
  /// From the transmitter to the zenith of the half space in which receivers are. The default is
  /// the front, as the FASTRAK manual has it (page 50), where a table's hands are.
  std::array<double, 3> hemisphere{1, 0, 0};
  /// Whether the tracker filters; off by default, because that delays poses by up to 158 ms.
  bool is_filtered = false;
};

/// Reads `baud`, `hemisphere` and `filter`, and allows `station`. `bauds` are the known rates.
/// Error: usage.
Result<Options> options_of(const DeviceSpec& spec, std::span<const std::uint16_t> stations,
                           std::initializer_list<int> bauds);

/// Returns the rates to try: the option's, or `first` and then the others of `bauds`.
std::vector<int> bauds_to_try(const Options& options, int first, std::span<const int> bauds);

/// Returns ",x,y,z", with four decimals.
std::string hemisphere_parameters(const std::array<double, 3>& zenith);

/// Returns the numbers as "115200, 57600".
template <class Numbers>
std::string listed(const Numbers& numbers) {
  std::string list;
  for (const auto number : numbers)
    list += (list.empty() ? "" : ", ") + std::to_string(number);
  return list;
}

/// Returns why a line of `baud` cannot carry `records_per_second` records of so many bytes, or
/// nothing if it can.
std::optional<std::string> too_slow(int baud, std::size_t record_bytes, double records_per_second);

} // namespace nendo::driver::polhemus
