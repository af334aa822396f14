#include "cyberglove/cyberglove_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <spdlog/fmt/fmt.h>

#include <nendo/base/number_in.hpp>
#include <nendo/driver/glove_options.hpp>

#include "cyberglove/cyberglove_parser.hpp"
#include "cyberglove/cyberglove_protocol.hpp"

namespace nendo::driver::cyberglove {
namespace {

constexpr double min_rate_hz = 0.1;
constexpr double max_rate_hz = 1000.0;

Error wrong(const DeviceSpec& spec, const std::string& key, const std::string& known) {
  return {Errc::usage, spec.text + ": " + key + "=" + spec.options.at(key) + " is not " + known};
}

/// Sets `option` from the text of `key`, as `read` understands it.
template <class T, class Read>
Result<void> take(const DeviceSpec& spec, const std::string& key, const std::string& known,
                  T& option, Read&& read) {
  const auto found = spec.options.find(key);
  if (found == spec.options.end()) return {};
  const auto value = read(found->second);
  if (!value) return wrong(spec, key, known);
  option = *value;
  return {};
}

std::optional<bool> read_switch(std::string_view text) {
  if (text == "on") return true;
  if (text == "off") return false;
  return std::nullopt;
}

std::optional<int> read_baud(std::string_view text) {
  constexpr std::array known{115'200, 57'600, 38'400, 19'200, 9'600};
  const auto baud = number_in<int>(text);
  if (!baud || std::find(known.begin(), known.end(), *baud) == known.end()) return std::nullopt;
  return baud;
}

std::optional<double> read_rate(std::string_view text) {
  const auto rate_hz = number_in<double>(text);
  if (!rate_hz || !(*rate_hz >= min_rate_hz && *rate_hz <= max_rate_hz)) return std::nullopt;
  return rate_hz;
}

std::optional<SensorMask> read_mask(std::string_view text) {
  constexpr std::uint32_t all = (1U << sensor_slots) - 1;
  if (!text.starts_with("0x")) return std::nullopt;
  const auto bits = number_in<std::uint32_t>(text.substr(2), 16);
  if (!bits || *bits == 0 || *bits > all) return std::nullopt;
  return SensorMask{*bits};
}

/// Refuses options that exclude each other.
Result<void> check_together(const DeviceSpec& spec, const Options& options) {
  const auto usage = [&](const char* what) { return Error{Errc::usage, spec.text + ": " + what}; };
  if (options.sync && options.rate_hz)
    return usage("sync=on: the pulses make the rate; leave out rate=");
  if (options.sync && options.hires) return usage("sync=on and hires=on exclude each other");
  if (options.hires && options.mask) return usage("hires=on sends all sensors; leave out mask=");
  if (options.hires && options.stamps.value_or(false))
    return usage("hires=on: its records have a time of their own; leave out stamps=");
  return {};
}

/// Rounded down: the rate in a message must fit.
int whole(double limit_hz) {
  return static_cast<int>(limit_hz);
}

Error too_fast(double rate_hz, std::size_t record_bytes, int baud, const std::string& remedy) {
  const double limit_hz = line_limit_hz(baud, record_bytes);
  return {Errc::usage,
          fmt::format("rate={:g}: a record of {} bytes at {} baud takes {:.1f} ms; at "
                      "most {} records per second; {}",
                      rate_hz, record_bytes, baud, 1e3 / limit_hz, whole(limit_hz), remedy)};
}

} // namespace

Result<Options> read_options(const DeviceSpec& spec) {
  auto good = allow_options(
      spec, {"baud", "rate", "mask", "stamps", "filter", "quantised", "sync", "hires", "hand"});
  Options options;
  const auto also = [&](const char* key, const char* known, auto& option, auto read) {
    if (good) good = take(spec, key, known, option, read);
  };
  also("baud", "one of 115200, 57600, 38400, 19200, 9600", options.baud, read_baud);
  also("rate", "a number of records per second from 0.1 to 1000", options.rate_hz, read_rate);
  also("mask", "a sensor mask from 0x1 to 0xFFFFFF", options.mask, read_mask);
  also("stamps", "on or off", options.stamps, read_switch);
  also("filter", "on or off", options.filter, read_switch);
  also("quantised", "on or off", options.quantised, read_switch);
  also("sync", "on or off", options.sync, read_switch);
  also("hires", "on or off", options.hires, read_switch);
  const auto hand = hand_option(spec);
  if (good && !hand) good = hand.error();
  if (hand) options.hand = *hand;
  if (good) good = check_together(spec, options);
  if (!good) return good.error();
  return options;
}

double rate_of(Period period) noexcept {
  if (period.ticks == 0 || period.times == 0) return 0.0;
  return clock_hz / (static_cast<double>(period.ticks) * period.times);
}

std::optional<Period> choose_period(double rate_hz) noexcept {
  constexpr double most = std::numeric_limits<std::uint16_t>::max();
  if (!(rate_hz > 0.0 && rate_hz <= clock_hz)) return std::nullopt;
  const double ticks = clock_hz / rate_hz;
  if (!(ticks <= most * most)) return std::nullopt;
  // As few repetitions as possible: the words then come nearest.
  const double times = std::ceil(std::round(ticks) / most);
  return Period{static_cast<std::uint16_t>(std::round(ticks / times)),
                static_cast<std::uint16_t>(times)};
}

Period decode_period(PeriodBytes bytes, WordOrder order) noexcept {
  const auto word = [&](std::size_t at) {
    const auto first = std::to_integer<unsigned>(bytes[at]);
    const auto second = std::to_integer<unsigned>(bytes[at + 1]);
    return static_cast<std::uint16_t>(order == WordOrder::high_first ? first << 8U | second
                                                                     : second << 8U | first);
  };
  return {word(0), word(2)};
}

std::optional<WordOrder> order_of(PeriodBytes bytes, Period period) noexcept {
  for (const WordOrder order : {WordOrder::high_first, WordOrder::low_first}) {
    if (decode_period(bytes, order) == period) return order;
  }
  return std::nullopt;
}

std::optional<Period> guess_period(PeriodBytes bytes) noexcept {
  constexpr double max_hz = 1000.0;
  std::optional<Period> best;
  for (const WordOrder order : {WordOrder::high_first, WordOrder::low_first}) {
    const Period period = decode_period(bytes, order);
    const double rate_hz = rate_of(period);
    if (rate_hz > max_hz) continue;
    // Where a low byte is 0, both orders have the same rate: 1280 times 1 is 5 times 256.
    const bool better = !best || rate_hz > rate_of(*best) ||
                        (rate_hz == rate_of(*best) && period.times < best->times);
    if (better) best = period;
  }
  return best;
}

Result<RecordPlan> plan_records(const Options& options, std::size_t values, int baud,
                                double present_hz) {
  const double wanted_hz = options.rate_hz.value_or(present_hz);
  const auto bytes_of = [&](bool stamps) {
    RecordShape shape;
    shape.values = values;
    shape.time_stamp = shape.status = stamps;
    return shape.bytes();
  };
  const auto fits = [&](bool stamps) { return wanted_hz <= line_limit_hz(baud, bytes_of(stamps)); };
  RecordPlan plan;
  plan.stamps = options.stamps.value_or(fits(true));
  plan.stamps_dropped = !plan.stamps && !options.stamps;
  plan.record_bytes = bytes_of(plan.stamps);
  if (options.rate_hz && !fits(plan.stamps)) {
    const bool helps = plan.stamps && fits(false);
    return too_fast(wanted_hz, plan.record_bytes, baud,
                    helps ? fmt::format("lower the rate or say stamps=off (at most {})",
                                        whole(line_limit_hz(baud, bytes_of(false))))
                          : std::string("lower the rate or mask sensors off"));
  }
  if (options.rate_hz) plan.period = choose_period(wanted_hz);
  return plan;
}

Result<std::optional<std::uint8_t>> plan_hires(const Options& options, int baud) {
  constexpr double max_steps = 4; // 120 records per second, what the maker states
  if (!options.rate_hz) return std::optional<std::uint8_t>{};
  const double steps = *options.rate_hz / third_frame_step_hz;
  if (steps != std::floor(steps) || steps < 1 || steps > max_steps) {
    return Error{Errc::usage, fmt::format("rate={:g}: with hires=on it is one of 30, 60, 90, 120",
                                          *options.rate_hz)};
  }
  if (*options.rate_hz > line_limit_hz(baud, hi_res_bytes))
    return too_fast(*options.rate_hz, hi_res_bytes, baud, "lower the rate");
  return std::optional(static_cast<std::uint8_t>(steps));
}

} // namespace nendo::driver::cyberglove
