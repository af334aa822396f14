#include "polhemus/polhemus_options.hpp"

#include <charconv>
#include <cmath>

#include <nendo/base/text.hpp>

namespace nendo::driver::polhemus {
namespace {

Result<std::array<double, 3>> hemisphere_option(const DeviceSpec& spec) {
  const auto option = spec.options.find("hemisphere");
  if (option == spec.options.end()) return Options{}.hemisphere;
  const Error wrong{Errc::usage, spec.text + ": option hemisphere must be three numbers from -1 to "
                                             "1, e.g. 1,0,0 for the front, or 0,0,0 to follow"};
  std::array<double, 3> zenith{};
  ItemReader items(option->second, ',');
  for (double& component : zenith) {
    const auto number = to_finite_number(items.next());
    if (!number || *number < -1.0 || *number > 1.0) return wrong;
    component = *number;
  }
  if (!items.has_ended()) return wrong;
  return zenith;
}

} // namespace

Result<Options> options_of(const DeviceSpec& spec, std::span<const std::uint16_t> stations,
                           std::initializer_list<int> bauds) {
  if (auto allowed = allow_options(spec, {"station", "baud", "hemisphere", "filter"}); !allowed)
    return allowed.error();
  if (auto named = require_port(spec, spec.kind + ":/dev/ttyUSB0"); !named) return named.error();
  Options options;
  options.stations.assign(stations.begin(), stations.end());
  if (spec.options.count("baud") > 0) {
    const auto baud = number_option(spec, "baud", bauds);
    if (!baud) return baud.error();
    options.baud = *baud;
  }
  const auto hemisphere = hemisphere_option(spec);
  if (!hemisphere) return hemisphere.error();
  options.hemisphere = *hemisphere;
  const auto filter = word_option(spec, "filter", {"off", "on"});
  if (!filter) return filter.error();
  options.is_filtered = *filter == "on";
  return options;
}

std::vector<int> bauds_to_try(const Options& options, int first, std::span<const int> bauds) {
  if (options.baud) return {*options.baud};
  std::vector<int> order{first};
  for (const int baud : bauds)
    if (baud != first) order.push_back(baud);
  return order;
}

std::string hemisphere_parameters(const std::array<double, 3>& zenith) {
  std::string text;
  for (const double component : zenith) {
    std::array<char, 32> digits{};
    const auto end =
        std::to_chars(digits.begin(), digits.end(), component, std::chars_format::fixed, 4).ptr;
    text.append(",").append(digits.begin(), end);
  }
  return text;
}

std::optional<std::string> too_slow(int baud, std::size_t record_bytes, double records_per_second) {
  constexpr int bits_per_byte = 10; // 8N1
  const int carried = baud / bits_per_byte;
  const auto records = std::lround(records_per_second);
  const long needed = records * static_cast<long>(record_bytes);
  if (carried >= needed) return std::nullopt;
  return "a line of " + std::to_string(baud) + " baud carries " + std::to_string(carried) +
         " bytes per second, and " + std::to_string(records) + " records per second of " +
         std::to_string(record_bytes) + " bytes need " + std::to_string(needed);
}

} // namespace nendo::driver::polhemus
