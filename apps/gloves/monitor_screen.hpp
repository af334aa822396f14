#pragma once
// The picture that `nendo monitor` draws in a terminal: two lines about the glove, and a bar for
// each sensor.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>
#include <nendo/hand/calibration.hpp>

#include "cli/terminal.hpp"

namespace nendo::gloves {

class SeenCounts {
public:
  struct Range {
    std::uint16_t least = 0;
    std::uint16_t most = 0;
  };

  void add(const GloveSample& sample) noexcept;
  void clear() noexcept { present_ = {}; }
  /// Returns the range of a sensor that the sample added last has.
  const Range& operator[](Sensor sensor) const noexcept { return ranges_[index_of(sensor)]; }

private:
  std::array<Range, sensor_slots> ranges_{};
  SensorMask present_;
};

/// The contents of a picture. Everything that is pointed to must outlive the picture.
struct MonitorPicture {
  const driver::GloveInfo* info = nullptr;
  driver::StreamStats stats;
  const GloveSample* sample = nullptr;            ///< the latest; null: none came yet
  const SeenCounts* seen = nullptr;               ///< includes `sample`
  const hand::Calibration* calibration = nullptr; ///< null: counts only
  double age_s = 0.0;                             ///< age of `sample`
  bool light = false;
  bool keys = false; ///< the user can press keys
  /// The angles are an average hand's: the first line says so, and each has a '~' before it.
  bool uncalibrated = false;
  std::string wearer{}; ///< whose calibration the angles are of; empty: not said
  /// Sensors that are stuck: the third line names them, and their angles have an 'e' before them.
  SensorMask left_out{};
};

/// Returns `width` characters, of which the one at the place of `count` is '#'. '[' and ']' are at
/// the least and the greatest count seen ('|' where they meet), '-' is between them, and '.' where
/// no count has been.
std::string count_bar(int width, std::uint16_t count, SeenCounts::Range seen, std::uint16_t most);

/// Returns lines of printable ASCII, at most as many and as long as the screen. If there are few
/// rows, the sensors are in two columns, and the last line says how many still do not fit. If
/// there are few columns, first the angle is left out, then the bar.
std::vector<std::string> monitor_lines(const MonitorPicture& picture, cli::ScreenSize size);

} // namespace nendo::gloves
