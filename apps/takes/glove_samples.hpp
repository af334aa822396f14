#pragma once
// The samples in a recording, one after another, each with the calibration with which its hand was
// recorded. It makes no difference whether a loop was recorded, too.

#include <filesystem>
#include <optional>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/hand/active_calibration.hpp>
#include <nendo/recording/take_reader.hpp>

namespace nendo::takes {

/// Tells whether a recorded hand has angles of its own: its calibration is not the default one of
/// such a glove, or is learned, or the hand is a simulated one, which the default is made for.
bool is_calibrated(const recording::Setup& setup, std::size_t glove);

class GloveSamples {
public:
  /// Opens a recording. Blocks. Errors: those of TakeReader::open().
  static Result<GloveSamples> open(const std::filesystem::path& path);

  /// Returns the sensors that any of the gloves has.
  SensorMask sensors() const;
  HostTime begun() const noexcept { return reader_.setup().begun_host; } ///< of the recording

  /// Reads the next sample. Returns false if there is none.
  bool next();
  const GloveSample& sample() const noexcept { return sample_; } ///< the latest
  /// Returns the calibration for the latest sample, or null if its hand was not calibrated
  /// (is_calibrated()).
  const hand::Calibration* calibration() const noexcept { return calibration_; }
  /// Returns true while nothing was missing in the recording.
  bool is_exact() const { return exact_ && reader_.chunks().damage_count() == 0; }

private:
  explicit GloveSamples(recording::TakeReader reader);

  recording::TakeReader reader_;
  std::vector<std::optional<hand::ActiveCalibration>> calibrations_; ///< by glove; nothing: none
  GloveSample sample_;
  const hand::Calibration* calibration_ = nullptr;
  bool exact_ = true;
};

} // namespace nendo::takes
