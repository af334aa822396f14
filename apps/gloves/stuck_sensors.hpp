#pragma once
// Messages about stuck sensors.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nendo/driver/glove.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::gloves {

/// Notices which sensors begin to be left out, and which come back.
class StuckNotices {
public:
  /// Returns a sentence for each sensor that was not left out before and is now, with its count if
  /// the sample is given, and for each that is no more. What is left out at first was said where
  /// the calibration was found.
  std::vector<std::string> changes(SensorMask left_out, const GloveSample* sample = nullptr);

private:
  std::optional<SensorMask> known_;
};

/// A sensor that was at an end of its counts all the time.
struct SensorAtEnd {
  Sensor sensor;
  std::uint16_t count;
};

/// Looks at a worn glove's samples for a moment, and returns the sensors at an end. At
/// rest no more can be known. Without samples, and of gloves that calibrate themselves, there are
/// none. Starts the glove and stops it. Blocks for 2 s at most.
std::vector<SensorAtEnd> sensors_at_end(driver::Glove& glove);
/// Returns "index_pip is at the end of its range (255): ...", with what that means.
std::string in_words(const SensorAtEnd& found);

} // namespace nendo::gloves
