#pragma once
// The samples in a recording, one after another, each with the calibration with which its hand was
// recorded. It makes no difference whether a loop was recorded.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/hand/wearer.hpp>
#include <nendo/recording/take_reader.hpp>

namespace nendo::takes {

/// Returns whether a recorded hand has angles of its own: its calibration is not the default one of
/// such a glove, or is learned, or the hand is a simulated one, which the default is made for.
bool is_calibrated(const recording::Setup& setup, std::size_t glove);
/// Returns the same for the hand that shapes as that side; nothing if there is none.
std::optional<bool> is_calibrated(const recording::Setup& setup, Side side);

class GloveSamples {
public:
  /// Opens a recording. Blocks. Errors: those of TakeReader::open().
  static Result<GloveSamples> open(const std::filesystem::path& path);

  /// Returns the sensors that any of the gloves has.
  SensorMask sensors() const;
  const recording::Setup& setup() const noexcept { return reader_.setup(); }

  /// Reads the next sample. Returns false if there is none.
  bool next();
  const GloveSample& sample() const noexcept { return sample_; } ///< the latest
  std::size_t glove() const noexcept { return glove_; }          ///< that sent it
  /// Returns the calibration for the latest sample, or null if the description of its hand is
  /// damaged. It may be an average hand's.
  const hand::Calibration* calibration() const noexcept { return calibration_; }
  /// Returns the sensors of the latest sample that are left out, because they are stuck.
  SensorMask left_out() const noexcept {
    return calibration_ == nullptr ? SensorMask{}
                                   : gloves_[glove_].calibration.left_out(sample_.side);
  }
  /// Returns whether it is the wearer's own (takes::is_calibrated()).
  bool is_calibrated() const noexcept {
    return calibration_ != nullptr && gloves_[glove_].is_calibrated;
  }
  /// Returns true while nothing was missing in the recording.
  bool is_exact() const { return exact_ && reader_.chunks().damage_count() == 0; }

private:
  struct Glove {
    hand::ActiveCalibration calibration;
    bool is_calibrated;
  };
  explicit GloveSamples(recording::TakeReader reader);

  recording::TakeReader reader_;
  std::vector<Glove> gloves_;
  GloveSample sample_;
  std::size_t glove_ = 0;
  const hand::Calibration* calibration_ = nullptr;
  bool exact_ = true;
};

} // namespace nendo::takes
