#pragma once
// What --adapt has learned of a wearer, kept as a calibration of the method "adapted".

#include <filesystem>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/hand/calibration_file.hpp>
#include <nendo/hand/range_adaptation.hpp>

namespace nendo::sculpting {

/// Returns whether a calibration is what keep_ranges() writes.
NENDO_API bool is_kept_ranges(const hand::WearerCalibration& wearer);

/// Returns the ranges that were kept for this user, glove and hand; nullopt without a user, or if
/// there are none yet. Blocks. Error: bad_input, if the user has a calibration that was made by
/// poses, which must not be lost to ranges, or one that cannot be read.
NENDO_API Result<std::optional<hand::LearnedRanges>>
kept_ranges(const driver::GloveInfo& glove, Side side, const std::string& user);

/// Writes them, and returns the file's path; an empty path if no joint has taught any. Blocks.
/// Errors: those of kept_ranges() and of hand::write_calibration().
NENDO_API Result<std::filesystem::path> keep_ranges(const driver::GloveInfo& glove, Side side,
                                                    const std::string& user,
                                                    const hand::SensorRanges& ranges);

} // namespace nendo::sculpting
