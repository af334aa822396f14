#pragma once
// The frames of recordings.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/flow/hand_input.hpp>
#include <nendo/hand/wearer.hpp>
#include <nendo/recording/loop_replay.hpp>
#include <nendo/recording/take_reader.hpp>

#include "takes/frame_source.hpp"

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

/// The frames of a recording, whose loop runs again tick by tick.
class RecordedFrames final : public FrameSource {
public:
  /// Opens a recording. `model` must come from recorded_model(). The whole recording is read once
  /// to find its duration. Blocks. Errors: those of TakeReader::open() and LoopReplay::make();
  /// bad_input (no tick in it).
  static Result<std::unique_ptr<RecordedFrames>> open(const std::filesystem::path& path,
                                                      const deform::Mesh& model);

  const deform::Mesh& model(std::uint32_t version) const override {
    return replay_->loop().changes().model(version)->mesh;
  }
  const deform::BlockLayout& layout(std::uint32_t version) const override {
    return replay_->loop().changes().layout(version);
  }
  bool has_one_model() const override { return has_one_model_; }
  std::optional<PlayedPuppet> puppet() const override;
  const puppet::Rig* masks() const override {
    return replay_->loop().changes().first_puppet() == nullptr
               ? replay_->loop().changes().puppet(0).get()
               : nullptr;
  }
  double rate_hz() const override { return rate_hz_; }
  double duration_s() const override { return duration_s_; }
  bool next() override;
  const flow::Frame& frame() const override { return replay_->loop().frames().front(); }
  double time_s() const override { return time_s_; }
  std::optional<bool> is_calibrated(Side side) const override {
    return takes::is_calibrated(reader_.setup(), side);
  }
  bool is_exact() const override {
    return replay_->is_exact() && reader_.chunks().damage_count() == 0;
  }

  const recording::Setup& setup() const noexcept { return reader_.setup(); }

private:
  explicit RecordedFrames(recording::TakeReader reader) : reader_(std::move(reader)) {}

  recording::TakeReader reader_;
  std::unique_ptr<recording::LoopReplay> replay_;
  double rate_hz_ = 0.0;
  double duration_s_ = 0.0;
  double time_s_ = 0.0;
  bool has_one_model_ = true;
};

/// The frames of a recording in which there are gloves and no loop, as `nendo record` makes it: the
/// hands alone, a frame for each sample of either hand. There is no model, so model() is empty. A
/// glove knows no place in space, so the hands lie side by side on the stage, backs upwards, with
/// the fingers pointing away from the operator.
class GloveFrames final : public FrameSource {
public:
  /// How far the ends of the forearms are from the middle of the stage.
  static constexpr double wrist_aside_m = 0.12;

  /// Opens a recording. It is read once to find its duration. Blocks. Errors: those of
  /// TakeReader::open(); bad_input (no glove, or no sample).
  static Result<std::unique_ptr<GloveFrames>> open(const std::filesystem::path& path);

  const deform::Mesh& model(std::uint32_t) const override { return model_; }
  const deform::BlockLayout& layout(std::uint32_t) const override { return layout_; }
  /// Returns the rate of the fastest glove.
  double rate_hz() const override { return rate_hz_; }
  double duration_s() const override { return duration_s_; }
  bool next() override;
  const flow::Frame& frame() const override { return frame_; }
  double time_s() const override { return time_s_; }
  std::optional<bool> is_calibrated(Side side) const override {
    return takes::is_calibrated(reader_.setup(), side);
  }
  bool is_exact() const override { return exact_ && reader_.chunks().damage_count() == 0; }

private:
  explicit GloveFrames(recording::TakeReader reader);
  void show(const flow::GloveHand& hand) noexcept;
  void note_silence(HostTime now) noexcept;

  recording::TakeReader reader_;
  deform::Mesh model_;
  deform::BlockLayout layout_;
  std::vector<flow::GloveHand> hands_; ///< indexed by the numbers of their gloves
  flow::Frame frame_;
  bool exact_ = true;
  double rate_hz_ = 0.0;
  double duration_s_ = 0.0;
  double time_s_ = 0.0;
};

} // namespace nendo::takes
