#pragma once
// Reports what adaptation has learned of a glove's sensors, at the end of `nendo run --adapt`.

#include <nlohmann/json_fwd.hpp>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/range_adaptation.hpp>

namespace nendo::session {

/// Returns an object for each sensor of `sensors`, with low_counts, high_counts and turns of its
/// hand::SensorRange.
nlohmann::ordered_json ranges_json(const hand::SensorRanges& ranges, SensorMask sensors);

/// Prints one line for each sensor to standard output.
void print_ranges(const hand::SensorRanges& ranges, SensorMask sensors);

} // namespace nendo::session
