#pragma once
// The frames of a timeline, and the model that it shapes.

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <nendo/base/result.hpp>

#include "takes/frame_source.hpp"
#include "takes/model_files.hpp"
#include "timeline/player.hpp"

namespace nendo::takes {

class TimelineFrames final : public FrameSource {
public:
  /// Reads the model from the file that the timeline names, or from `mesh` if that is not empty.
  /// Blocks. Errors: those of timeline::read_timeline(), recorded_model(),
  /// timeline::Player::make().
  static Result<std::unique_ptr<TimelineFrames>> open(const std::filesystem::path& path,
                                                      const std::string& mesh = {});

  /// Plays a timeline that is in memory. Errors: those of timeline::Player::make().
  static Result<std::unique_ptr<TimelineFrames>> make(timeline::Timeline timeline,
                                                      const deform::Mesh& model);

  const deform::Mesh& model(std::uint32_t version) const override {
    return player_->model(version)->mesh;
  }
  const deform::BlockLayout& layout(std::uint32_t version) const override {
    return player_->layout(version);
  }
  bool has_one_model() const override {
    const auto& events = player_->timeline().events;
    return std::none_of(events.begin(), events.end(), [](const timeline::Event& event) {
      return timeline::changes_model(event.command);
    });
  }
  std::optional<PlayedPuppet> puppet() const override {
    const auto& rig = player_->timeline().rig;
    if (!rig) return std::nullopt;
    return PlayedPuppet{rig, player_->sculptor_options()};
  }
  const puppet::Rig* masks() const override { return player_->timeline().masks_numbered(0); }
  double rate_hz() const override { return player_->timeline().rate_hz; }
  double duration_s() const override { return player_->last_time_s(); }
  bool next() override { return player_->next(); }
  const flow::Frame& frame() const override { return player_->frame(); }
  double time_s() const override { return player_->time_s(); }

  timeline::Player& player() noexcept { return *player_; }

private:
  explicit TimelineFrames(std::unique_ptr<timeline::Player> player) : player_(std::move(player)) {}

  std::unique_ptr<timeline::Player> player_;
};

/// Reads the model as TimelineFrames::open() does, with the same errors.
Result<RecordedModel> timeline_model(const timeline::Timeline& timeline,
                                     const std::string& mesh = {});

/// Returns the x coordinate of the model's middle on the stage, in metres. It is the default plane
/// of timeline::mirror().
double middle_plane_m(const timeline::Timeline& timeline, const deform::Mesh& model);

} // namespace nendo::takes
