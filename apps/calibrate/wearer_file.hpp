#pragma once
// Whose calibration a guided session makes: the poses it takes, the fit that it needs, its file,
// and the poses that an unfinished session kept beside it. Terminal and window share this.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/hand/calibration_file.hpp>
#include <nendo/hand/calibration_fit.hpp>

#include "calibrate/guide.hpp"

namespace nendo::calibrate {

enum class CalibrationKind : std::uint8_t {
  full,
  quick,    ///< flat hand and fist only
  touch_up, ///< how far sensors have slipped since the wearer's calibration was made
};

struct CalibrationRequest {
  std::string user;
  CalibrationKind kind = CalibrationKind::full;
  hand::HandSize size{};       ///< an average hand's measures count as unknown
  SensorMask stiff{};          ///< sensors of joints that cannot take the poses
  std::filesystem::path out{}; ///< where to write; empty: where other commands find it
};

/// What the file says about the glove.
struct CalibratedGlove {
  Side side = Side::right;
  CountScale counts;
  SensorMask sensors;
  std::string model{};
  std::string serial{}; ///< empty: not known
};
CalibratedGlove calibrated_glove(const driver::GloveInfo& info);

struct FinishedCalibration {
  hand::CalibrationFit fit;
  hand::WearerCalibration wearer; ///< as it will be written
  std::vector<hand::PoseReading> readings;
  SensorMask sensors; ///< the glove's, without those that were left out
};

class WearerFile {
public:
  /// Finds the file and, for a touch-up, reads the calibration in it. Blocks. Errors: bad_input
  /// (nothing to touch up, or unreadable), failed (no folder for calibrations).
  static Result<WearerFile> find(const CalibrationRequest& request, const CalibratedGlove& glove);

  const std::filesystem::path& path() const noexcept { return path_; }
  std::span<const hand::PoseId> poses() const noexcept;
  hand::FitOptions fit_options() const;
  /// Returns a guide through poses(), without the sensors that a touched-up calibration left out.
  CalibrationGuide guide() const;

  /// Returns whether an earlier session kept poses. Blocks.
  bool has_kept() const;
  /// Continues from what an earlier session with this glove kept, if anything. Blocks. Error:
  /// bad_input.
  Result<void> restore(CalibrationGuide& guide);
  /// Keeps the guide's poses for restore(), and returns how many there are. If there are none, it
  /// removes those that restore() took. Blocks. Error: failed.
  Result<std::size_t> keep(const CalibrationGuide& guide) const;
  /// Removes what an earlier session kept. Blocks.
  void forget_kept() const;

  /// Fits the poses of the guide. Takes up to some seconds. Errors: those of
  /// hand::fit_calibration().
  Result<FinishedCalibration> fit(const CalibrationGuide& guide) const;
  /// Writes the file, forgets the kept poses, and returns the path of the previous version; empty
  /// if there was none. Blocks. Errors: those of hand::write_calibration().
  Result<std::filesystem::path> write(const FinishedCalibration& finished) const;

private:
  WearerFile() = default;
  Result<void> begin_with_known(const std::filesystem::path& stored);
  std::filesystem::path kept_path() const;
  void note_quality(FinishedCalibration& finished, const hand::CountRanges& free_motion,
                    std::size_t slot) const;

  CalibrationRequest request_;
  hand::WearerCalibration about_; ///< everything but the calibration itself, unless touched up
  SensorMask sensors_;
  std::filesystem::path path_;
  std::optional<hand::WearerCalibration> known_; ///< what is touched up
  bool restored_ = false;
};

} // namespace nendo::calibrate
