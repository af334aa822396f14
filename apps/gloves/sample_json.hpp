#pragma once
// A sample as a line of JSON, as `nendo monitor --json` prints it.

#include <string>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>

namespace nendo::gloves {

/// One object without a line end. Keys: time_s and measured_s (host clock), sequence, hand, switch
/// ("on", "off", or null if the glove does not tell), raw (counts by sensor), device_time_s if the
/// glove has a clock, and angle_rad (by sensor) unless `calibration` is null. Only sensors that the
/// sample has, and of angles only those that the calibration knows. `tell_sources`: also angles, as
/// angle_sources_json() has them, unless `calibration` is null.
std::string sample_json(const GloveSample& sample, const hand::Calibration* calibration,
                        bool tell_sources = false);

} // namespace nendo::gloves
