#pragma once
// How far a calibrated glove has slipped, as --adapt learns it: what it begins from, and what is
// kept of it.

#include <filesystem>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/hand/calibration_store.hpp>
#include <nendo/hand/slip_adaptation.hpp>

namespace nendo::sculpting {

/// Returns the ends that the sensors reached when this calibration was made for a glove with the
/// counts of `glove`. Error: bad_input, if it does not tell them, or is of another kind of glove.
NENDO_API Result<hand::CalibratedRange> ends_of(const hand::StoredCalibration& file,
                                                const driver::GloveInfo& glove);

/// What became of slips.
struct KeptSlips {
  std::filesystem::path path; ///< of the calibration
  bool is_changed = false;    ///< false: no sensor has slipped by hand::min_slip_counts()
};

/// Writes the user's calibration, from which slips were learned, with the sensors' offsets and ends
/// moved by them; the one before stays beside it. Blocks. Errors: bad_input, if the calibration is
/// gone, and those of hand::write_calibration().
NENDO_API Result<KeptSlips> keep_slips(const driver::GloveInfo& glove, Side side,
                                       const std::string& user,
                                       const hand::SensorAngles& slips_counts);

} // namespace nendo::sculpting
