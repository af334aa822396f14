#pragma once
// What adaptation has learned of a glove's sensors, for the end of `nendo run --adapt`.

#include <nlohmann/json_fwd.hpp>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/range_adaptation.hpp>

namespace nendo::session {

/// By sensor of `sensors`: low_counts, high_counts and turns, as hand::SensorRange has them.
nlohmann::ordered_json ranges_json(const hand::SensorRanges& ranges, SensorMask sensors);

/// A line a sensor on standard output.
void print_ranges(const hand::SensorRanges& ranges, SensorMask sensors);

} // namespace nendo::session
