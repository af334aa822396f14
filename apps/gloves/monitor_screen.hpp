#pragma once
// The picture that `nendo monitor` draws in a terminal: two lines about the glove, a bar a sensor.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>
#include <nendo/hand/calibration.hpp>

#include "cli/terminal.hpp"

namespace nendo::gloves {

/// The least and the greatest count that each sensor has shown.
class SeenCounts {
public:
  struct Range {
    std::uint16_t least = 0;
    std::uint16_t most = 0;
  };

  void see(const GloveSample& sample) noexcept;
  void forget() noexcept { present_ = {}; }
  /// Only for a sensor of a sample that was seen.
  const Range& operator[](Sensor sensor) const noexcept {
    return ranges_[static_cast<std::size_t>(sensor)];
  }

private:
  std::array<Range, sensor_slots> ranges_{};
  SensorMask present_;
};

/// What a picture is made of. Everything that is pointed to lives as long as the picture.
struct MonitorPicture {
  const driver::GloveInfo* info = nullptr;
  driver::GloveStats stats;
  const GloveSample* sample = nullptr;            ///< the latest; null: none came yet
  const SeenCounts* seen = nullptr;               ///< has seen `sample`
  const hand::Calibration* calibration = nullptr; ///< null: counts only
  double age_s = 0.0;                             ///< of `sample`
  bool light = false;
  bool keys = false; ///< the user can press keys
};

/// `width` characters of which one in proportion to `count` is '#', with '[' and ']' at the least
/// and the greatest count seen ('|' where they meet), '-' between, '.' where nothing has been.
std::string count_bar(int width, std::uint16_t count, SeenCounts::Range seen, std::uint16_t most);

/// Lines of printable ASCII, at most as many and as long as the screen. Where rows are scarce the
/// sensors stand in two columns, and those that still do not fit are counted in the last line;
/// where columns are, first the angle goes, then the bar.
std::vector<std::string> monitor_lines(const MonitorPicture& picture, cli::ScreenSize size);

} // namespace nendo::gloves
