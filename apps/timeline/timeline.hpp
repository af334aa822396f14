#pragma once
// A take as key poses. For each hand, it has joint angles and the place of the wrist at some times.
// It also has what people asked for meanwhile, and all options on which the shape depends.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/base/result.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/puppet/rig.hpp>
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

/// Returns whether the command makes another version of the model.
bool changes_model(const flow::Command& command) noexcept;

struct Event {
  double time_s = 0.0;
  /// A Request, ChangeSettings (without a filter, because keys are poses that were filtered),
  /// Subdivide, Refine, Mark, or, with a puppet, SetClutch, SetRole or SetSymmetry. These three
  /// find the hands as they were in the previous frame. Without a puppet, ChangePuppet names other
  /// `masks`, JoinParts, ChangeTopology or EditPart (with its part) changes the model, and so does
  /// ChangeModel of a cut, whose number is that of the wire in `wires`.
  flow::Command command = flow::Request::grab;
};

bool same_bits(const Event& one, const Event& other) noexcept;
bool same_bits(const puppet::FunctionState& one, const puppet::FunctionState& other) noexcept;

/// Times begin at 0, when the hands grab the unchanged model.
struct Timeline {
  std::string take;             ///< the recording's file name, for people; may be empty
  std::string mesh;             ///< the model's file
  recording::ShapeSum mesh_sum; ///< identifies the model
  double units_per_metre = 1.0; ///< from the stage to the model
  double rate_hz = 90.0;        ///< rate of the frames that are made from the timeline
  double duration_s = 0.0;      ///< time of the last frame
  bool held = true;             ///< the hands hold the model at first
  /// A field along the surface is not in files. Without it, a player makes it of the puppet.
  flow::SculptorOptions sculptor;
  /// The puppet that the hands play. Null: they touch the model with their fingertips.
  std::shared_ptr<const puppet::Rig> rig{};
  puppet::RigState rig_state; ///< at 0 s; has all functions
  /// Without a puppet: the masks of the fingertips, and whether these are mirrored, by their
  /// numbers. The first is in effect at 0 s. Null: there are none; empty: there never are.
  std::vector<std::shared_ptr<const puppet::Rig>> masks{};
  /// Wires and knives that cut the model, in its units.
  std::vector<std::vector<deform::WirePlace>> wires{};
  /// One or two, of different sides. Without a puppet, their order numbers the own supports.
  std::vector<HandTrack> hands;
  std::vector<Event> events; ///< in order of their times, which may be equal

  HandTrack* track(Side side) noexcept;
  const HandTrack* track(Side side) const noexcept;
  std::size_t key_count() const noexcept;
  /// Returns how many points have radii of their own at 0 s: fingertips, with their mirror images,
  /// or those of the puppet.
  Eigen::Index point_count() const noexcept;
  /// Returns the masks with that number; null: none.
  const puppet::Rig* masks_numbered(std::size_t number) const noexcept {
    return number < masks.size() ? masks[number].get() : nullptr;
  }
};

/// Returns the state of a puppet that has not been played yet.
puppet::RigState first_state(const puppet::Rig& rig);

/// The name of a finger, or of several (SetClutch::finger): "thumb" to "little", "palm", "all".
std::string_view clutched_name(std::uint8_t finger) noexcept;
std::optional<std::uint8_t> clutched_named(std::string_view name) noexcept;

/// Returns what the event does, in words: "commit", "type1, wendland-c4, may fold, radius 12 cm
/// (0.3)", "the left index finger releases".
std::string in_words(const Timeline& timeline, const Event& event);

inline constexpr std::size_t max_keys = 1'000'000; ///< max number per hand
inline constexpr std::size_t max_events = 1'000'000;
inline constexpr double longest_s = 1e6;
inline constexpr double farthest_m = 1e3;

/// Checks counts, the order of times, and the ranges of all numbers. Returns what is wrong, in one
/// line without the file's name, or an empty text if the timeline can be played.
std::string complaint_about(const Timeline& timeline);
std::string complaint_about(const Key& key);

struct KeyRef {
  Side side = Side::right;
  std::size_t key = 0; ///< counted from 0

  friend bool operator==(const KeyRef&, const KeyRef&) = default;
};

/// Returns null if there is no such key.
const Key* find_key(const Timeline& timeline, const KeyRef& key) noexcept;
/// Returns the hand's key at exactly that time.
std::optional<KeyRef> key_at(const Timeline& timeline, Side side, double time_s) noexcept;
/// Return the nearest key after or before time_s, either of the hand of that side or of any hand.
std::optional<KeyRef> key_after(const Timeline& timeline, double time_s,
                                std::optional<Side> side = std::nullopt) noexcept;
std::optional<KeyRef> key_before(const Timeline& timeline, double time_s,
                                 std::optional<Side> side = std::nullopt) noexcept;

inline constexpr std::string_view file_ending = ".timeline.toml";
inline constexpr std::uint64_t max_file_bytes = std::uint64_t{1} << 26;

// Keys that are always true: a timeline without them was made by an unreleased program, whose rules
// were others.
inline constexpr std::string_view pull_rule = "pull_is_step";
constexpr std::string_view rule_of_sculptor(bool is_puppet) noexcept {
  return is_puppet ? "type2_along_surface" : "clay_scales_few_vertices";
}

/// Returns the timeline as text. The same timeline always gives the same text, and reading the text
/// gives the same bits. Error: failed (complaint_about() has a complaint, a file name is not UTF-8,
/// or there are too many keys for a file).
Result<std::string> timeline_text(const Timeline& timeline);
/// Parses the text of a timeline. Error: bad_input (not TOML, another version, unknown or missing
/// names, or complaint_about() has a complaint). The message begins with `name` and the line.
Result<Timeline> parse_timeline(std::string_view text, std::string_view name);

/// Reads a timeline. Errors: those of parse_timeline() and read_file(). Blocks.
Result<Timeline> read_timeline(const std::filesystem::path& path);
/// Writes the file atomically and replaces an existing one. Error: failed. Blocks.
Result<void> write_timeline(const std::filesystem::path& path, const Timeline& timeline);
/// Returns whether a file is a timeline, by the ending of its name only.
bool is_timeline(const std::filesystem::path& path);

} // namespace nendo::timeline
