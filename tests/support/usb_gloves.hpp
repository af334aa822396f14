#pragma once
// USB gloves from their own side: descriptors, feature reports, input reports made from a motion.
// They are pure, and written from published facts without the code under test but for the motion.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "simulated/hand_motion.hpp"

namespace nendo::test {

using UsbBytes = std::vector<std::uint8_t>;

/// The counts that a report sent, by sensor slot; -1 for a sensor that is not measured.
using SentCounts = std::array<int, sensor_slots>;

/// Returns whether the sample has exactly these counts. (It makes a mask first: GCC 12.2
/// miscompiles the comparison of a bit with the sign of a number.)
inline bool shows(const GloveSample& sample, const SentCounts& sent) {
  SensorMask measured;
  SentCounts told{};
  for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
    if (sent[slot] >= 0) measured.bits |= 1U << slot;
    told[slot] = sample.present.has(static_cast<Sensor>(slot)) ? sample.raw[slot].value : -1;
  }
  return sample.present == measured && told == sent;
}

class UsbGlove {
public:
  UsbGlove() = default;
  UsbGlove(const UsbGlove&) = delete;
  UsbGlove& operator=(const UsbGlove&) = delete;
  virtual ~UsbGlove() = default;

  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint8_t interfaces =
      1; ///< all HID; interface k has the interrupt input 0x82, but the last 0x81
  std::uint8_t packet_bytes = 64;
  std::vector<SentCounts> sent;
  std::vector<UsbBytes> odd_reports; ///< sent first, one after the other, instead of good ones
  bool silent = false;

  std::optional<UsbBytes> next_report() {
    if (silent) return std::nullopt;
    if (!odd_reports.empty()) {
      const UsbBytes odd = odd_reports.front();
      odd_reports.erase(odd_reports.begin());
      return odd;
    }
    sent.push_back({});
    sent.back().fill(-1);
    const double time_s = static_cast<double>(sent.size()) / 60.0;
    return report(motion_.at(time_s), sent.back());
  }
  /// Returns device, configuration, and one HID input for each interface (USB 2.0, 9.6).
  UsbBytes descriptors() const {
    const auto low = [](unsigned v) { return static_cast<std::uint8_t>(v & 0xFFU); };
    const auto high = [](unsigned v) { return static_cast<std::uint8_t>(v >> 8U); };
    const unsigned total = 9 + interfaces * 16U;
    UsbBytes bytes{
        18, 1, 0x10, 0x01, 0, 0, 0, 8, low(vendor), high(vendor), low(product), high(product),
        0,  1, 1,    2,    3, 1};
    const auto add = [&bytes](const UsbBytes& more) {
      bytes.insert(bytes.end(), more.begin(), more.end());
    };
    add({9, 2, low(total), high(total), interfaces, 1, 0, 0x80, 50});
    for (unsigned k = 0; k < interfaces; ++k) {
      add({9, 4, low(k), 0, 1, 3, 0, 0, 0});
      add({7, 5, low(k + 1U == interfaces ? 0x81U : 0x82U), 3, packet_bytes, 0, 10});
    }
    return bytes;
  }
  /// Returns a feature report, or nothing if the request is refused.
  virtual std::optional<UsbBytes> get_feature(std::uint8_t /*number*/) { return std::nullopt; }
  virtual bool set_feature(const UsbBytes& /*report*/) { return false; }

protected:
  virtual UsbBytes report(const driver::JointAngles& angles, SentCounts& counts) = 0;
  /// Returns the count of a joint, from 0 to `most` over its range.
  static int count_of(Sensor sensor, const driver::JointAngles& angles, int most,
                      SentCounts& counts) {
    const auto slot = static_cast<std::size_t>(sensor);
    const auto range = driver::joint_range(sensor);
    const double part = (angles[slot] - range.min_rad) / (range.max_rad - range.min_rad);
    counts[slot] = static_cast<int>(std::lround(std::clamp(part, 0.0, 1.0) * most));
    return counts[slot];
  }

private:
  driver::HandMotion motion_{driver::Motion::wave, Side::right, 7};
};

/// 24 bytes: 1, five bends of 6 bits, 2 bits, buttons, four lights, four views, 12 bits.
class P5Model final : public UsbGlove {
public:
  P5Model() {
    vendor = 0x0D7F;
    product = 0x0100;
    interfaces = 2;
    packet_bytes = 8; // a slow device has no longer ones
  }
  unsigned buttons = 0;
  std::uint8_t mouse_mode = 0x01;
  std::vector<std::uint8_t> mouse_modes_set;
  bool knows_mouse_mode = true;

  std::optional<UsbBytes> get_feature(std::uint8_t number) override {
    if (number != 5 || !knows_mouse_mode) return std::nullopt;
    return UsbBytes{5, mouse_mode};
  }
  bool set_feature(const UsbBytes& report) override {
    if (report.size() != 2 || report[0] != 5 || !knows_mouse_mode) return false;
    mouse_mode = report[1];
    mouse_modes_set.push_back(mouse_mode);
    return true;
  }

protected:
  UsbBytes report(const driver::JointAngles& angles, SentCounts& counts) override {
    std::string bits;
    const auto put = [&bits](unsigned value, unsigned width) {
      for (unsigned k = width; k-- > 0;)
        bits += (value >> k & 1U) != 0 ? '1' : '0';
    };
    put(1, 8);
    for (const Sensor finger : {Sensor::index_mcp, Sensor::middle_mcp, Sensor::ring_mcp,
                                Sensor::little_mcp, Sensor::thumb_mcp})
      put(static_cast<unsigned>(count_of(finger, angles, 63, counts)), 6);
    put(0, 2);
    put(buttons, 4);
    for (int k = 0; k < 4; ++k)
      put(8, 4); // no light seen
    bits.resize(24 * 8, '1');
    UsbBytes bytes;
    for (std::size_t k = 0; k < bits.size(); k += 8)
      bytes.push_back(static_cast<std::uint8_t>(std::stoul(bits.substr(k, 8), nullptr, 2)));
    return bytes;
  }
};

/// A 5DT Ultra. Its report has 64 bytes, with 16 values of two bytes, high byte first.
class UltraModel final : public UsbGlove {
public:
  explicit UltraModel(std::uint16_t product_id) {
    vendor = 0x5D70;
    product = product_id;
  }

protected:
  UsbBytes report(const driver::JointAngles& angles, SentCounts& counts) override {
    using enum Sensor;
    constexpr std::array order{
        thumb_mcp, thumb_ip,  thumb_abduction, //
        index_mcp, index_pip, index_middle_abduction, middle_mcp, middle_pip, middle_ring_abduction,
        ring_mcp,  ring_pip,  ring_little_abduction,  little_mcp, little_pip};
    UsbBytes bytes(64, 0xEE);
    for (std::size_t k = 0; k < order.size(); ++k) {
      const bool measured = (product & 0x10U) == 0 || k % 3 == 0;
      const int count = measured ? count_of(order[k], angles, 4095, counts) : 0x0BAD;
      bytes[2 * k] = static_cast<std::uint8_t>(count >> 8);
      bytes[2 * k + 1] = static_cast<std::uint8_t>(count & 0xFF);
    }
    return bytes;
  }
};

} // namespace nendo::test
