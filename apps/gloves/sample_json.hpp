#pragma once
// A sample as a line of JSON, as `nendo monitor --json` prints it.

#include <string>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>

namespace nendo::gloves {

/// Returns one object without a line end. Its keys are time_s and measured_s (host clock),
/// sequence, hand, switch ("on", "off", or null if the glove does not tell), raw (counts by
/// sensor), device_time_s if the glove has a clock, and angle_rad (by sensor) unless `calibration`
/// is null. It contains only sensors that the sample has, and only angles that the calibration
/// knows. With `tell_sources`, unless `calibration` is null, there is also the key angles, with
/// what angle_sources_json() returns.
std::string sample_json(const GloveSample& sample, const hand::Calibration* calibration,
                        bool tell_sources = false);

} // namespace nendo::gloves
