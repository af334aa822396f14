#pragma once
// Reduces a pose for each frame to a few keys.

#include <filesystem>
#include <limits>
#include <span>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/recording/setup.hpp>

#include "timeline/timeline.hpp"

namespace nendo::timeline {

/// How far the points of a puppet are off where the hand that plays it is off.
class PointSway {
public:
  /// Of the functions that listen to that hand at any time. Without a puppet there are none.
  PointSway(const Timeline& timeline, Side side);

  /// Returns the numbers of that hand to which functions listen.
  Eigen::VectorXd signals(const puppet::HandState& hand) const;
  /// Returns how far any point is off where the signals are `one` in place of `other`, in metres on
  /// the stage. It is a bound: limits of functions, and ways that cancel each other, make it less.
  double off_m(const Eigen::VectorXd& one, const Eigen::VectorXd& other) const;
  /// Returns the times at which functions may grab the hands. If hands are off there, so
  /// are the values from then on.
  const std::vector<double>& held_at_s() const noexcept { return held_at_s_; }

private:
  void add(const Timeline& timeline, std::size_t function, const puppet::HandSignal& input,
           bool moves_twin);

  std::vector<puppet::HandSignal> inputs_;
  Eigen::MatrixXd
      reach_m_; ///< displacement of each point, for a unit of each input; #points by #inputs
  std::vector<double> held_at_s_;
};

/// The greatest allowed distance between a frame and the curve through the keys. With 0, every
/// frame that is not exactly on the curve becomes a key.
struct Tolerance {
  double angle_rad =
      std::numeric_limits<double>::infinity(); ///< limit of any joint, and the wrist's turn
  double tip_m = std::numeric_limits<double>::infinity(); ///< limit of any fingertip, and the wrist
  double point_m = std::numeric_limits<double>::infinity(); ///< limit of any point of a puppet
};

struct Deviation {
  double angle_rad = 0.0; ///< as in Tolerance
  double tip_m = 0.0;
  double point_m = 0.0; ///< PointSway::off_m()
};

struct Reduction {
  std::vector<Key> keys;
  std::size_t frames = 0;
  Deviation worst; ///< max deviation of a frame from the HandCurve of the keys
};

/// Returns keys for the frames, which must fulfil the conditions of HandTrack::keys. The first and
/// the last frame become keys. As long as the curve is too far off, the worst frame between two
/// keys becomes a key. At the end, keys that are not needed are removed. With `sway`, the points of
/// the puppet that the hand plays count, and the frames at which its functions grab, and
/// those before them, stay keys.
Reduction reduce_keys(const hand::HandSkeleton& skeleton, std::span<const Key> frames,
                      const Tolerance& tolerance, const PointSway* sway = nullptr);

struct MadeTimeline {
  Timeline timeline;
  std::vector<Reduction> hands; ///< in the order of the timeline's hands, without their keys
  bool exact = false;           ///< nothing was missing in the recording
  bool has_last_puppet = false; ///< the puppet was edited on the way; the timeline has the last one
};

/// Runs the recorded loop of `setup` again over `model`, which should be its own. The hands' angles
/// become keys; requests, what the wrist switch did, commands of a puppet, and marks become
/// events. The points of a puppet are off by the tolerance at most, by both hands together. The key
/// at 0 s is the pose in which a hand grabbed, one period before the first tick. Blocks. Errors:
/// those of TakeReader::open() and LoopReplay::make(); bad_input (no tick, or more than `most`
/// frames or events; a puppet that was begun on the way; a setup that begins in the middle of a
/// run, which takes::begin_with_first_shape() changes). A timeline has one puppet. Where a take has
/// several, because one was edited on the way, it is the last one, from the beginning on. Functions
/// that it has not are left out, and so are undos and redos of edits.
Result<MadeTimeline> timeline_of_take(const std::filesystem::path& take,
                                      const recording::Setup& setup, const deform::Mesh& model,
                                      const Tolerance& tolerance, std::size_t most = max_keys);
/// Does the same with the recording's own setup.
Result<MadeTimeline> timeline_of_take(const std::filesystem::path& take, const deform::Mesh& model,
                                      const Tolerance& tolerance, std::size_t most = max_keys);
static_assert(max_keys == max_events);

} // namespace nendo::timeline
