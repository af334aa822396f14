#pragma once
// What --adapt has learned of a wearer: the ranges of joints, kept as a calibration of the method
// "adapted", and how far a calibrated glove has slipped.

#include <filesystem>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/hand/calibration_file.hpp>
#include <nendo/hand/calibration_store.hpp>
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

/// Returns the ends that the sensors reached when this calibration was made for a glove with the
/// counts of `glove`. Error: bad_input, if it does not have them, or is of another kind of glove.
NENDO_API Result<hand::CalibratedRange> ends_of(const hand::StoredCalibration& file,
                                                const driver::GloveInfo& glove);

struct KeptSlips {
  std::filesystem::path path; ///< the calibration's file
  bool is_changed = false;    ///< false: no sensor has slipped by hand::min_slip_counts()
};

/// Writes the user's calibration, from which slips were learned, with the sensors' offsets and ends
/// moved by them; the previous file is kept beside it. Blocks. Errors: bad_input, if the
/// calibration is gone, and those of hand::write_calibration().
NENDO_API Result<KeptSlips> keep_slips(const driver::GloveInfo& glove, Side side,
                                       const std::string& user,
                                       const hand::SensorAngles& slips_counts);

} // namespace nendo::sculpting
