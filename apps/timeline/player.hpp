#pragma once
// Plays a timeline frame by frame, without a clock. Its keys make hand poses, and its events
// changes; the loop's own core makes the shape of them.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/flow/change_broker.hpp>
#include <nendo/flow/shaping_core.hpp>

#include "timeline/hand_curve.hpp"
#include "timeline/timeline.hpp"

namespace nendo::timeline {

class Player {
public:
  /// `model` should be the timeline's (Timeline::mesh_sum), and any field along the surface
  /// (SculptorOptions::surface) must be of it. Error: bad_input, without the file's name, if
  /// complaint_about() has a complaint, the puppet does not fit the model, or the hands cannot grab
  /// it.
  static Result<std::unique_ptr<Player>> make(Timeline timeline, const deform::Mesh& model);

  /// Makes the next frame, the first one at 0 s. Returns false if there is none. Allocates for
  /// undo.
  bool next();
  /// Returns true if there is a next frame that is not later than time_s, except for rounding.
  bool has_frame_by(double time_s) const noexcept;
  const flow::Frame& frame() const noexcept { return frame_; } ///< not before next()
  double time_s() const noexcept;                              ///< the time of frame()
  /// Returns the time of the timeline's last frame.
  double last_time_s() const noexcept;
  std::uint64_t frame_count() const noexcept { return frames_; } ///< in all
  const flow::LoopStats& stats() const noexcept { return stats_; }
  /// Returns a version of the model (Frame::model), or null.
  std::shared_ptr<const flow::ModelVersion> model(std::uint32_t number) const noexcept {
    return changes_.model(number);
  }
  const deform::BlockLayout& layout(std::uint32_t version = 0) const noexcept {
    return changes_.layout(version);
  }
  /// Returns the timeline, now with a field along the surface if its puppet needs one. Another
  /// player of it over the same model then need not make that again.
  const Timeline& timeline() const noexcept { return timeline_; }
  /// Returns the options in effect.
  const flow::SculptorOptions& sculptor_options() const noexcept {
    return changes_.sculptor_options();
  }
  /// Returns the present shape, 3 by #vertices. It includes a stroke that has not ended.
  deform::Points final_shape() { return core_.final_shape(); }

private:
  Player(Timeline timeline, const deform::Mesh& model, const flow::CoreOptions& options);
  double time_of(std::uint64_t frame) const noexcept;
  void pose_hands(double time_s);
  flow::ShapingCore::Hands hands() const noexcept;
  bool ask_what_is_due(double time_s);
  void ask(const Event& event);
  void make_changes();
  void make_model(const flow::ChangeModel& change);
  void finish_change();
  void describe(std::uint64_t number);

  Timeline timeline_;
  std::vector<MovingHand> hands_;
  std::array<puppet::HandState, 2> poses_; ///< indexed by slot
  flow::ChangeBroker changes_;
  flow::ShapingCore core_;
  flow::Frame frame_;
  flow::LoopStats stats_;
  std::size_t next_event_ = 0;
  std::optional<flow::LoopSettings> settings_due_;
  std::optional<std::uint32_t> masks_due_;     ///< their number
  std::optional<flow::ChangeModel> model_due_; ///< its number is that of a wire, or none
  bool was_refused_ = false;                   ///< a change in this frame
  std::uint64_t made_ = 0;                     ///< frames
  std::uint64_t frames_ = 0;                   ///< in all
};

} // namespace nendo::timeline
