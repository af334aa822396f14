#pragma once
// The commands that a user gives to a run by keys, by the window's mouse and buttons, or by a
// browser. A command is a plain value of fixed size, so that it passes through rings without
// allocation.

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
  grab,   ///< the hands grab the model
  let_go, ///< and release it; what they have shaped stays
  commit, ///< the shape so far becomes the rest shape, and the hands hold it again
  undo,   ///< back to the rest shape before the last commit (deform::HistoryMove)
  redo,   ///< undoes the last undo, if nothing was committed since
  reset,  ///< back to the model as it was loaded, which an undo undoes
  /// The hands that hold the model re-grab where they are, without a commit
  /// (Shaping::ask()).
  take_hold,
};

inline constexpr std::array requests{Request::grab,     Request::let_go, Request::commit,
                                     Request::undo,     Request::redo,   Request::reset,
                                     Request::take_hold};

/// Returns whether a request undoes, redoes or resets: Shaping does these one after another.
constexpr bool goes_through_history(Request request) noexcept {
  return request == Request::undo || request == Request::redo || request == Request::reset;
}

NENDO_API std::string_view name_of(Request request) noexcept;
NENDO_API std::optional<Request> request_named(std::string_view name) noexcept;

/// Lets the loop continue with these settings from its next tick on
/// (DeformLoop::change_settings()).
struct ChangeSettings {
  LoopSettings settings;
  friend bool operator==(const ChangeSettings&, const ChangeSettings&) = default;
};
/// Makes a finer model of the present one (deform::subdivide()), with which the loop then
/// continues.
struct Subdivide {
  friend bool operator==(const Subdivide&, const Subdivide&) = default;
};
/// Adapts the model's triangles to the current shape (deform::Refiner).
struct Refine {
  /// No edge is split beyond it.
  std::uint32_t max_vertices = std::uint32_t{1} << 22;
  friend bool operator==(const Refine&, const Refine&) = default;
};
/// Separates, opens or fuses places thinner than the edges (deform::change_topology()).
struct ChangeTopology {
  friend bool operator==(const ChangeTopology&, const ChangeTopology&) = default;
};
/// Begins or ends a recording to a file.
struct SetRecording {
  bool on = false;
  friend bool operator==(const SetRecording&, const SetRecording&) = default;
};
/// Writes the present shape to a file of its own.
struct SaveShape {
  friend bool operator==(const SaveShape&, const SaveShape&) = default;
};
/// Writes the puppet that is played to its file.
struct SavePuppet {
  friend bool operator==(const SavePuppet&, const SavePuppet&) = default;
};
/// Writes the most recent input to a file, if the run keeps it in memory.
struct SaveRecording {
  friend bool operator==(const SaveRecording&, const SaveRecording&) = default;
};
/// Marks this moment in the recording, so that it is found again. The shape does not depend on it.
struct Mark {
  friend bool operator==(const Mark&, const Mark&) = default;
};
/// Lets a hand, or one of its fingers, release the functions of a puppet that it plays, or grab
/// them again (puppet::RigPlayer::set_clutch()).
struct SetClutch {
  Side side = Side::left;
  std::uint8_t finger = puppet::RigPlayer::all_fingers;
  bool holds = true;
  friend bool operator==(const SetClutch&, const SetClutch&) = default;
};
/// Lets a function of a puppet listen to another signal. Those that a puppet has not are passed
/// over.
struct SetRole {
  std::uint16_t function = 0; ///< the index in puppet::Puppet::functions
  puppet::HandSignal input;
  friend bool operator==(const SetRole&, const SetRole&) = default;
};
/// One hand plays both sides of a puppet, or each plays its own. Without a puppet, fingertips shape
/// both sides of the model's plane of symmetry, or only where they are.
struct SetSymmetry {
  bool on = false;
  friend bool operator==(const SetSymmetry&, const SetSymmetry&) = default;
};
/// An edit of the masks, which protect parts of the model.
enum class MaskEdit : std::uint8_t {
  hold,   ///< protects a ball
  free,   ///< removes the balls whose middle is in that ball
  clear,  ///< removes all protection
  invert, ///< protects what was free, and frees what was protected
};
NENDO_API std::string_view name_of(MaskEdit edit) noexcept;
NENDO_API std::optional<MaskEdit> mask_edit_named(std::string_view name) noexcept;
/// Edits the masks of the fingertips, or of the puppet that is played.
struct NENDO_API SetMask {
  MaskEdit edit = MaskEdit::clear;
  std::array<double, 3> at{}; ///< a place of the undeformed model, model units
  double radius = 0.0;        ///< model units, > 0; the ball is protected by half at least
  bool is_usable() const noexcept;
  friend bool operator==(const SetMask&, const SetMask&) = default;
};
/// Lets a layer (Layer) come in, or go out. The inputs of a loop are numbered in their order.
struct SetLayer {
  std::uint8_t input = 0;
  bool on = true;
  friend bool operator==(const SetLayer&, const SetLayer&) = default;
};
/// Lets the layers that live gloves play come in, or go out if they are in: punch in and out.
struct Punch {
  friend bool operator==(const Punch&, const Punch&) = default;
};
/// The cutting tool.
enum class Blade : std::uint8_t {
  wire,  ///< between both index fingertips, or, of one hand alone, between thumb and index finger
  knife, ///< from the tip of an index finger on, where it points to; as long as the model
};
/// Begins to draw a wire, or a knife, through the model (WirePath). Or ends that, and what it swept
/// then cuts the model. Meanwhile the hands release the model.
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
/// Puts a copy of a part beside it, or removes the part: the one that a hand holds, or has held
/// last (PartsState::chosen).
struct EditPart {
  bool removes = false;
  std::uint32_t part = deform::no_index; ///< or that one of the newest model
  friend bool operator==(const EditPart&, const EditPart&) = default;
};
/// Ends the run, which then writes its shape.
struct EndRun {
  friend bool operator==(const EndRun&, const EndRun&) = default;
};

/// The hands stop shaping at the end of a tick. Requested only while a new model is built from the
/// shape; the ChangeModel that follows lets them continue where they have stopped.
struct HoldStill {
  friend bool operator==(const HoldStill&, const HoldStill&) = default;
};
/// The origin of a model. Recordings keep the numbers.
enum class ModelSource : std::uint8_t {
  kept,       ///< an earlier version, to which an undo or a redo leads
  subdivided, ///< the previous model, subdivided
  refined,    ///< the previous model, refined for its shape
  cut,        ///< the previous shape, cut by the wire that was drawn last
  joined,     ///< the previous shape, with all its parts joined
  copied,     ///< the previous shape, with a copy of one of its parts
  removed,    ///< the previous shape, without one of its parts
  topology,   ///< the previous shape, changed where it was thin
};
/// Returns whether such a model is made of the previous shape, which becomes its rest.
constexpr bool is_of_shape(ModelSource source) noexcept {
  return source >= ModelSource::cut;
}
/// The loop continues with another version of the model (ModelVersion::number).
struct ChangeModel {
  std::uint32_t number = 0;
  ModelSource source = ModelSource::kept;
  std::uint32_t max_vertices = 0; ///< Refine::max_vertices, if it is refined
  double seam_width = 0.0;        ///< JoinParts::seam_width, if it is joined
  std::uint32_t part = 0;         ///< that is copied or removed (deform::ModelParts)
  bool is_new() const noexcept { return source != ModelSource::kept; }
  friend bool operator==(const ChangeModel&, const ChangeModel&) = default;
};

/// The loop continues with another puppet (DeformLoop::change_puppet()). For the log and its replay
/// only.
struct ChangePuppet {
  std::uint32_t number = 0; ///< DeformLoop::puppet()
  friend bool operator==(const ChangePuppet&, const ChangePuppet&) = default;
};

/// A loop executes Request, WristMove, SetLayer, DrawWire and commands of puppets at the beginning
/// of its next tick, and logs a Mark. The code that runs the loop executes all others. HoldStill,
/// ChangeModel and ChangePuppet are only for the log.
using Command =
    std::variant<Request, WristMove, ChangeSettings, SetRecording, SaveShape, SaveRecording, EndRun,
                 Subdivide, HoldStill, ChangeModel, Mark, SetClutch, SetRole, SetSymmetry, SetLayer,
                 Punch, ChangePuppet, SavePuppet, SetMask, Refine, DrawWire, JoinParts, EditPart,
                 ChangeTopology>;
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
/// Returns the command that asks for such a change, which is_new() and is no cut: that is asked for
/// by a wire.
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

/// Returns whether it is about how a puppet is played.
constexpr bool is_for_puppet(const Command& command) noexcept {
  return std::holds_alternative<SetClutch>(command) || std::holds_alternative<SetRole>(command) ||
         std::holds_alternative<SetSymmetry>(command);
}

/// Returns whether a running loop executes the command itself.
constexpr bool is_for_loop(const Command& command) noexcept {
  return std::holds_alternative<Request>(command) || std::holds_alternative<WristMove>(command) ||
         std::holds_alternative<Mark>(command) || std::holds_alternative<SetLayer>(command) ||
         std::holds_alternative<DrawWire>(command) || is_for_puppet(command);
}

/// Shows the requested settings until a loop has had time to take them, and then those in effect,
/// by whichever client they were requested. Asking thread; does not allocate.
class NENDO_API WantedSettings {
public:
  static constexpr std::array kernels{deform::Wendland::c0, deform::Wendland::c2,
                                      deform::Wendland::c4, deform::Wendland::c6};
  static constexpr HostClock::duration patience = std::chrono::seconds(1);

  LoopSettings now; ///< the chosen settings; widgets write here

  /// To be called with each frame's settings. Returns true if other settings are chosen by that.
  bool follow(const LoopSettings& in_effect) noexcept;
  /// Returns the command for the chosen settings, if they were not requested yet.
  std::optional<Command> ask() noexcept;

  /// The points of a puppet do not press clay.
  void next_mode(bool is_puppet) noexcept;
  void next_kernel() noexcept;
  /// Gives all fingers the next brush, none left out; brushes are of type 2.
  void next_brush() noexcept;
  /// A quarter more of clay; from 1 to 0.
  void next_volume() noexcept;
  void toggle_hold() noexcept { now.hold = now.hold == Hold::hand ? Hold::fingertips : Hold::hand; }
  void toggle_folding() noexcept { now.injective = !now.injective; }
  void toggle_filter() noexcept {
    const bool is_off = now.filter.kind == hand::FilterKind::off;
    now.filter.kind = is_off ? hand::FilterKind::one_euro : hand::FilterKind::off;
  }
  /// Make all radii larger, or smaller, by a tenth, within the range.
  void enlarge_radii() noexcept { scale_radii(1.1); }
  void reduce_radii() noexcept { scale_radii(1.0 / 1.1); }
  bool has_one_radius() const noexcept; ///< all fingers have the same
  bool has_one_brush() const noexcept;
  /// Make the brushes stronger, or weaker and then their opposites, by a tenth of the most.
  void strengthen() noexcept { add_strength(0.1); }
  void weaken() noexcept { add_strength(-0.1); }

private:
  void scale_radii(double factor) noexcept;
  void add_strength(double more) noexcept;

  LoopSettings asked_;
  HostTime asked_at_{};
};

} // namespace nendo::flow
