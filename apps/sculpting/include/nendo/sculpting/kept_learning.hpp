#pragma once
// Stores the results of --adapt: the ranges of joints, as a calibration of the method "adapted",
// and the slips of a calibrated glove.

#include <filesystem>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/hand/calibration_file.hpp>
#include <nendo/hand/calibration_store.hpp>
#include <nendo/hand/slip_adaptation.hpp>

namespace nendo::sculpting {

/// Returns whether a calibration was written by keep_ranges().
NENDO_API bool is_kept_ranges(const hand::WearerCalibration& wearer);

/// Returns the stored ranges of this user, glove and hand; nullopt without a user, or if there are
/// none. Blocks. Error: bad_input (the user has a calibration by poses, which ranges must not
/// replace, or an unreadable one).
NENDO_API Result<std::optional<hand::LearnedRanges>>
kept_ranges(const driver::GloveInfo& glove, Side side, const std::string& user);

/// Writes the ranges, and returns the file's path; empty if no joint's range was learned. Blocks.
/// Errors: those of kept_ranges() and of hand::write_calibration().
NENDO_API Result<std::filesystem::path> keep_ranges(const driver::GloveInfo& glove, Side side,
                                                    const std::string& user,
                                                    const hand::SensorRanges& ranges);

/// Returns the end counts of the sensors from the time of this calibration. Error: bad_input (the
/// file does not have them, or is for another type of glove).
NENDO_API Result<hand::CalibratedRange> ends_of(const hand::StoredCalibration& file,
                                                const driver::GloveInfo& glove);

struct KeptSlips {
  std::filesystem::path path; ///< the calibration's file
  bool is_changed = false;    ///< false: no sensor has slipped by hand::min_slip_counts()
};

/// Applies the learned slips to the offsets and ends of the user's calibration, and writes it;
/// keeps the previous file beside it. Blocks. Errors: bad_input (the calibration is missing), and
/// those of hand::write_calibration().
NENDO_API Result<KeptSlips> keep_slips(const driver::GloveInfo& glove, Side side,
                                       const std::string& user,
                                       const hand::SensorAngles& slips_counts);

} // namespace nendo::sculpting
