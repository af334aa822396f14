#pragma once
// A take as key poses. For each hand, it has joint angles and the place of the wrist at some times.
// It also has the requests to the model, the changes of settings, and all options on which the
// shape depends.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/flow/shaping.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/recording/setup.hpp>

namespace nendo::timeline {

struct Key {
  double time_s = 0.0;
  hand::JointAngles angles;
  Eigen::Vector3d wrist_m = Eigen::Vector3d::Zero(); ///< where the forearm ends, on the stage
  Eigen::Quaterniond wrist_turn = Eigen::Quaterniond::Identity(); ///< nearly of unit length

  Eigen::Isometry3d wrist_pose() const noexcept;
};

/// These return true if all numbers of both have the same bits.
bool same_bits(double one, double other) noexcept;
bool same_bits(const Key& one, const Key& other) noexcept;

struct HandTrack {
  Side side = Side::right;
  hand::HandSize size;
  std::vector<Key> keys; ///< at least one, in rising order of times

  hand::HandSkeleton skeleton() const { return hand::HandSkeleton(side, size); }
};

struct Event {
  double time_s = 0.0;
  flow::Request request = flow::Request::grab;
  /// The event is a change to these, and `request` means nothing. They have no filter, because keys
  /// are poses that were filtered.
  std::optional<flow::LoopSettings> settings{};
  bool subdivides = false; ///< the event makes the model finer, and `request` means nothing
};

bool same_bits(const Event& one, const Event& other) noexcept;
/// Returns what the event does, in words: "commit", "type2, wendland-c4, radius 12 cm".
std::string in_words(const Event& event);

/// Times begin at 0, when the hands take hold of the unchanged model.
struct Timeline {
  std::string take;             ///< the recording's file name, for people; may be empty
  std::string mesh;             ///< the model's file
  recording::ShapeSum mesh_sum; ///< identifies the model
  double units_per_metre = 1.0; ///< from the stage to the model
  double rate_hz = 90.0;        ///< of the frames that are made from the timeline
  double duration_s = 0.0;      ///< of the last frame
  bool held = true;             ///< the hands hold the model at first
  bool pull_is_step = false;    ///< LoopOptions::pull_is_step; false in files that do not tell
  flow::SculptorOptions sculptor;
  /// One or two, of different sides. Their order numbers the own supports of fingertips.
  std::vector<HandTrack> hands;
  std::vector<Event> events; ///< in order of their times, which may be equal

  HandTrack* track(Side side) noexcept;
  const HandTrack* track(Side side) const noexcept;
  std::size_t key_count() const noexcept;
};

inline constexpr std::size_t most_keys = 1'000'000; ///< of a hand
inline constexpr std::size_t most_events = 1'000'000;
inline constexpr double longest_s = 1e6;
inline constexpr double farthest_m = 1e3;

/// Checks counts, the order of times, and the ranges of all numbers. Returns what is wrong, in one
/// line without the file's name, or an empty text if the timeline can be played.
std::string complaint_about(const Timeline& timeline);
std::string complaint_about(const Key& key);

} // namespace nendo::timeline
