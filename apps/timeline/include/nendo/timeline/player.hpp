#pragma once
// A timeline's frames, one after another and without a clock: poses from its keys, fingertips from
// poses, and of those the shape, as the loop makes it.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/timeline/hand_curve.hpp>
#include <nendo/timeline/timeline.hpp>

namespace nendo::timeline {

class Player {
public:
  /// Over `model`, which ought to be the timeline's (Timeline::mesh_sum). Error: bad_input (a
  /// complaint_about(), or hands that cannot take hold of the model), without the file's name.
  static Result<std::unique_ptr<Player>> make(Timeline timeline, const deform::Mesh& model);

  /// Makes the next frame, the first one at 0 s; false: there is none. Allocates for undo.
  bool next();
  /// There is a next frame, and its time is not after this one, but for rounding.
  bool has_frame_by(double time_s) const noexcept;
  const flow::Frame& frame() const noexcept { return frame_; } ///< not before next()
  double time_s() const noexcept;                              ///< of it
  /// Of the frame that comes last.
  double last_time_s() const noexcept;
  std::uint64_t frame_count() const noexcept { return frames_; } ///< in all
  const flow::LoopStats& stats() const noexcept { return stats_; }
  const deform::BlockLayout& layout() const noexcept { return shaping_.sculptor().layout(); }
  const Timeline& timeline() const noexcept { return timeline_; }
  /// The shape as it stands, nothing of a stroke left out. 3 by #vertices.
  deform::Points final_shape() { return shaping_.final_shape(tips_); }

private:
  struct Hand {
    hand::HandSkeleton skeleton;
    HandCurve curve;
    std::size_t slot;
  };

  Player(Timeline timeline, const deform::Mesh& model);
  double time_of(std::uint64_t frame) const noexcept;
  void pose_hands(double time_s);
  bool ask_what_is_due(double time_s);
  void describe(std::uint64_t number);

  Timeline timeline_;
  std::vector<Hand> hands_;
  deform::Points tips_;
  flow::Shaping shaping_;
  flow::Frame frame_;
  flow::LoopStats stats_;
  std::size_t next_event_ = 0;
  std::uint64_t made_ = 0;   ///< frames
  std::uint64_t frames_ = 0; ///< in all
};

} // namespace nendo::timeline
