#pragma once
// The commands of a run, from keys, from the window's mouse and buttons, or from a browser. A
// command is a trivially copyable value, so that rings pass it without allocation. Also the
// settings that a client shows and requests.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>

#include <nendo/base/api.hpp>
#include <nendo/base/spsc_ring.hpp>
#include <nendo/base/units.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/wrist.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// Recordings keep the numbers, so new values are added at the end.
enum class Request : std::uint8_t {
  grab,    ///< the hands grab the model
  release, ///< the hands release the model; the shape stays
  commit,  ///< the shape becomes the rest shape, and the hands hold it again
  undo,    ///< reverts the last step (deform::HistoryMove)
  redo,    ///< reverts the last undo, if nothing was committed since
  reset,   ///< restores the loaded model; an undo reverts this
  /// hands that hold the model re-grab at their current poses, without a commit (Shaping::ask())
  regrab,
};

inline constexpr std::array requests{Request::grab,  Request::release, Request::commit,
                                     Request::undo,  Request::redo,    Request::reset,
                                     Request::regrab};

/// Returns whether a request is an undo, redo or reset. Shaping executes these in sequence.
constexpr bool goes_through_history(Request request) noexcept {
  return request == Request::undo || request == Request::redo || request == Request::reset;
}

NENDO_API std::string_view name_of(Request request) noexcept;
NENDO_API std::optional<Request> request_named(std::string_view name) noexcept;

/// The base of commands without data.
struct NoData {
  friend bool operator==(const NoData&, const NoData&) = default;
};
/// Changes the loop's settings from its next tick on (ChangeBroker::change_settings()).
struct ChangeSettings {
  LoopSettings settings;
  friend bool operator==(const ChangeSettings&, const ChangeSettings&) = default;
};
/// Subdivides the model (deform::subdivide()), and the loop continues with the result.
struct Subdivide : NoData {};
/// Adapts the model's triangles to the current shape (deform::Refiner).
struct Refine {
  /// No edge is split above this number.
  std::uint32_t max_vertices = std::uint32_t{1} << 22;
  friend bool operator==(const Refine&, const Refine&) = default;
};
/// Separates, opens or fuses places thinner than the edges (deform::change_topology()).
struct ChangeTopology : NoData {};
/// Begins or ends a recording to a file.
struct SetRecording {
  bool on = false;
  friend bool operator==(const SetRecording&, const SetRecording&) = default;
};
/// Writes the current shape to a new file.
struct SaveShape : NoData {};
/// Writes the played puppet to its file.
struct SavePuppet : NoData {};
/// Writes the most recent input to a file, if the run keeps it in memory.
struct SaveRecording : NoData {};
/// Marks this time in the recording. The shape does not depend on it.
struct Mark : NoData {};
/// Makes a hand, or one of its fingers, release its functions of a puppet, or grab them again
/// (puppet::RigPlayer::set_clutch()).
struct SetClutch {
  Side side = Side::left;
  std::uint8_t finger = puppet::RigPlayer::all_fingers;
  bool holds = true;
  friend bool operator==(const SetClutch&, const SetClutch&) = default;
};
/// Sets the input signal of a puppet's function. Functions that the puppet does not have are
/// ignored.
struct SetRole {
  std::uint16_t function = 0; ///< the index in puppet::Puppet::functions
  puppet::HandSignal input;
  friend bool operator==(const SetRole&, const SetRole&) = default;
};
/// Turns symmetry on or off. With symmetry, one hand plays both sides of a puppet or, without a
/// puppet, fingertips shape both sides of the model's plane of symmetry.
struct SetSymmetry {
  bool on = false;
  friend bool operator==(const SetSymmetry&, const SetSymmetry&) = default;
};
/// An edit of the masks, which protect parts of the model.
enum class MaskEdit : std::uint8_t {
  hold,   ///< protects a ball
  free,   ///< removes the balls with centres in that ball
  clear,  ///< removes all protection
  invert, ///< protects what was free, and frees what was protected
};
NENDO_API std::string_view name_of(MaskEdit edit) noexcept;
NENDO_API std::optional<MaskEdit> mask_edit_named(std::string_view name) noexcept;
/// Edits the masks of the fingertips, or of the played puppet.
struct NENDO_API SetMask {
  MaskEdit edit = MaskEdit::clear;
  std::array<double, 3> at{}; ///< the ball's centre on the undeformed model, model units
  double radius = 0.0;        ///< model units, > 0; the ball is protected by half at least
  bool is_usable() const noexcept;
  friend bool operator==(const SetMask&, const SetMask&) = default;
};
/// Fades a layer (Layer) in or out. `input` is the index of the loop's input.
struct SetLayer {
  std::uint8_t input = 0;
  bool on = true;
  friend bool operator==(const SetLayer&, const SetLayer&) = default;
};
/// Fades the layers of live gloves in, or out if they are in: punch in and out.
struct Punch : NoData {};
/// The cutting tool.
enum class Blade : std::uint8_t {
  wire,  ///< between the index fingertips; with one hand, between thumb and index finger
  knife, ///< from the tip of an index finger in its direction, as long as the model
};
/// Begins to draw a wire or knife through the model (WirePath), or ends it and cuts the model along
/// the swept surface. The hands release the model meanwhile.
struct DrawWire {
  bool on = false;
  Blade blade = Blade::wire;
  friend bool operator==(const DrawWire&, const DrawWire&) = default;
};
/// Joins the parts of the model, which must overlap (deform::join()).
struct JoinParts {
  double seam_width = 0.0; ///< model units, >= 0
  friend bool operator==(const JoinParts&, const JoinParts&) = default;
};
/// Copies a part, and places the copy beside it, or removes the part. The default part is the last
/// one that a hand grabbed (PartsState::chosen).
struct EditPart {
  bool removes = false;
  std::uint32_t part = deform::no_index; ///< an index in the newest model; no_index: the default
  friend bool operator==(const EditPart&, const EditPart&) = default;
};
/// Puts the wrists that trackers move back to where the hands were placed, with their headings
/// (hand::WristTracking::recentre()).
struct Recentre : NoData {};
/// Ends the run, which then writes its shape.
struct EndRun : NoData {};

/// The hands stop shaping at the end of a tick, while a new model is made of the shape. After the
/// ChangeModel that follows, they continue where they stopped.
struct HoldStill : NoData {};
/// The origin of a model. Recordings keep the numbers.
enum class ModelSource : std::uint8_t {
  kept,       ///< a stored version, for an undo or a redo
  subdivided, ///< the previous model, subdivided
  refined,    ///< the previous model, refined for its current shape
  cut,        ///< the previous shape, cut by the last drawn wire
  joined,     ///< the previous shape, with all its parts joined
  copied,     ///< the previous shape, with a copy of one of its parts
  removed,    ///< the previous shape, without one of its parts
  topology,   ///< the previous shape, with changed topology where it was thin
};
/// Returns whether the previous shape becomes the rest shape of such a model.
constexpr bool is_of_shape(ModelSource source) noexcept {
  return source >= ModelSource::cut;
}
/// The loop continues with another version of the model (ModelVersion::number).
struct ChangeModel {
  std::uint32_t number = 0;
  ModelSource source = ModelSource::kept;
  std::uint32_t max_vertices = 0; ///< Refine::max_vertices, for `refined`
  double seam_width = 0.0;        ///< JoinParts::seam_width, for `joined`
  std::uint32_t part = 0;         ///< the copied or removed part (deform::ModelParts)
  bool is_new() const noexcept { return source != ModelSource::kept; }
  friend bool operator==(const ChangeModel&, const ChangeModel&) = default;
};

/// The loop continues with another puppet (ChangeBroker::change_puppet()). Only for the log and its
/// replay.
struct ChangePuppet {
  std::uint32_t number = 0; ///< ChangeBroker::puppet()
  friend bool operator==(const ChangePuppet&, const ChangePuppet&) = default;
};

/// A loop executes Request, WristMove, Recentre, SetLayer, DrawWire and puppet commands at the
/// beginning of its next tick, and logs a Mark. The code that runs the loop executes all others.
/// HoldStill, ChangeModel and ChangePuppet are only for the log.
using Command =
    std::variant<Request, WristMove, ChangeSettings, SetRecording, SaveShape, SaveRecording, EndRun,
                 Subdivide, HoldStill, ChangeModel, Mark, SetClutch, SetRole, SetSymmetry, SetLayer,
                 Punch, ChangePuppet, SavePuppet, SetMask, Refine, DrawWire, JoinParts, EditPart,
                 ChangeTopology, Recentre>;
static_assert(std::is_trivially_copyable_v<Command>);

/// Returns the change of the model that the command requests, without a number; nothing if it
/// requests none.
constexpr std::optional<ChangeModel> model_asked_by(const Command& command) noexcept {
  if (std::holds_alternative<Subdivide>(command)) return ChangeModel{0, ModelSource::subdivided};
  if (const auto* refine = std::get_if<Refine>(&command))
    return ChangeModel{0, ModelSource::refined, refine->max_vertices};
  if (std::holds_alternative<ChangeTopology>(command)) return ChangeModel{0, ModelSource::topology};
  if (const auto* join = std::get_if<JoinParts>(&command))
    return ChangeModel{0, ModelSource::joined, 0, join->seam_width};
  if (const auto* edit = std::get_if<EditPart>(&command))
    return ChangeModel{0, edit->removes ? ModelSource::removed : ModelSource::copied, 0, 0.0,
                       edit->part};
  return std::nullopt;
}
/// Returns the command that requests a change. The change must be is_new(), and not a cut, which
/// needs a wire.
constexpr Command asking_for(const ChangeModel& change) noexcept {
  if (change.source == ModelSource::copied || change.source == ModelSource::removed)
    return EditPart{change.source == ModelSource::removed, change.part};
  if (change.source == ModelSource::joined) return JoinParts{change.seam_width};
  if (change.source == ModelSource::topology) return ChangeTopology{};
  if (change.source == ModelSource::refined) return Refine{change.max_vertices};
  return Subdivide{};
}

/// The asking thread pushes commands, and the loop's thread takes them.
using CommandRing = SpscRing<Command>;

/// Returns whether the command controls a puppet's player.
constexpr bool is_for_puppet(const Command& command) noexcept {
  return std::holds_alternative<SetClutch>(command) || std::holds_alternative<SetRole>(command) ||
         std::holds_alternative<SetSymmetry>(command);
}

/// Returns whether a running loop executes the command itself.
constexpr bool is_for_loop(const Command& command) noexcept {
  return std::holds_alternative<Request>(command) || std::holds_alternative<WristMove>(command) ||
         std::holds_alternative<Mark>(command) || std::holds_alternative<SetLayer>(command) ||
         std::holds_alternative<DrawWire>(command) || std::holds_alternative<Recentre>(command) ||
         is_for_puppet(command);
}

/// The settings that a client shows: the requested ones until the loop has had time to take them,
/// then those in effect. Asking thread; does not allocate.
class NENDO_API PendingSettings {
public:
  static constexpr std::array kernels{deform::Wendland::c0, deform::Wendland::c2,
                                      deform::Wendland::c4, deform::Wendland::c6};
  static constexpr HostClock::duration patience = std::chrono::seconds(1);

  LoopSettings now; ///< the chosen settings, which widgets write

  /// Call it with each frame's settings. Returns true if `now` has changed.
  bool follow(const LoopSettings& in_effect) noexcept;
  /// Returns the command for `now`; nothing if it was already requested.
  std::optional<Command> ask() noexcept;

  /// With `is_puppet`, skips the modes that need hands.
  void next_mode(bool is_puppet) noexcept;
  void next_kernel() noexcept;
  /// Gives all fingers the next brush, skipping Brush::none, and sets type 2.
  void next_brush() noexcept;
  /// Adds 1/4 to keep_volume; 1 wraps to 0.
  void next_volume() noexcept;
  void toggle_hold() noexcept { now.hold = now.hold == Hold::hand ? Hold::fingertips : Hold::hand; }
  void toggle_folding() noexcept { now.injective = !now.injective; }
  void toggle_filter() noexcept {
    const bool is_off = now.filter.kind == hand::FilterKind::off;
    now.filter.kind = is_off ? hand::FilterKind::one_euro : hand::FilterKind::off;
  }
  /// Scale all radii by 1.1 or 1/1.1, within the range.
  void enlarge_radii() noexcept { scale_radii(1.1); }
  void reduce_radii() noexcept { scale_radii(1.0 / 1.1); }
  /// Change the brushes' strength by +-0.1; below 0 their effect is reversed.
  void strengthen() noexcept { add_strength(0.1); }
  void weaken() noexcept { add_strength(-0.1); }

private:
  void scale_radii(double factor) noexcept;
  void add_strength(double more) noexcept;

  LoopSettings asked_;
  HostTime asked_at_{};
};

} // namespace nendo::flow
