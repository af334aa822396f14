#pragma once
// A wearer of whom the truth is known, to judge calibrations by, and the file of such wearers. Each
// line of the file is a JSON object, so that any simulator can write one. The format is described
// in hand/CALIBRATION-EVIDENCE.md.

#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/angle.hpp>
#include <nendo/hand/calibration_fit.hpp>

namespace nendo::bench {

/// A sample's counts by slot; those of absent sensors are 0.
using CountRow = std::array<std::uint16_t, sensor_slots>;

/// A moment of a motion.
struct JudgedMoment {
  CountRow counts{};
  std::array<double, hand::angle_count> angles_deg{}; ///< the true ones
  int touching = 0; ///< 1 to 4: the thumb's pad touches the pad of index to little finger
};

/// Poses that were held, and a motion afterwards, all with the glove on and not moved.
struct JudgedSession {
  std::vector<CountRow> free_motion; ///< motion before the poses, of each joint from end to end
  std::vector<hand::PoseReading> takes;
  std::vector<JudgedMoment> motion;
};

struct JudgedWearer {
  std::string name;
  Side side = Side::right;
  SensorMask sensors;
  JudgedSession fresh;
  /// The same after the glove has been put on again: three kinds of poses, flat, fist and pinches.
  JudgedSession again;
  /// How deep the pads of thumb to little finger are, and how far behind the end; metres.
  struct Pad {
    double depth_m = 0.0, behind_m = 0.0;
  };
  using Pads = std::array<Pad, 5>;
  Pads pads{};
};

/// Returns the wearer as one line of JSON, with its end.
std::string line_of(const JudgedWearer& wearer);

/// Reads a file of wearers, one at a time. Blocks.
class JudgedWearers {
public:
  /// Error: bad_input, if the file cannot be read.
  static Result<JudgedWearers> open(const std::filesystem::path& path);
  /// Returns the next wearer, or nothing at the end. Error: bad_input, "FILE:LINE: what".
  Result<std::optional<JudgedWearer>> next();

private:
  std::string name_;
  std::ifstream file_;
  std::size_t line_ = 0;
};

} // namespace nendo::bench
