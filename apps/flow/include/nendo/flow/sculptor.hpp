#pragma once
// One interface for all deformation modes, so that the loop does not depend on them.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <nendo/base/result.hpp>
#include <nendo/deform/brush.hpp>
#include <nendo/deform/surface_deformer.hpp>
#include <nendo/deform/surface_field.hpp>
#include <nendo/deform/type1.hpp>
#include <nendo/deform/type2.hpp>
#include <nendo/flow/clay_hands.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// With type1, the start points are frozen and the rest shape is deformed again each tick. With
/// type2, the fingertips' paths are followed piece by piece. With clay, whole hands press the
/// surface out of themselves. With parts, hands take parts of the model and move them.
enum class Mode : std::uint8_t { type1, type2, clay, parts };
inline constexpr std::uint8_t mode_count = 4;
inline constexpr std::string_view mode_names =
    "type1, type2, clay or parts"; ///< all modes, for messages

/// Returns whether whole hands shape in this mode. Otherwise points do, and a puppet may play.
constexpr bool is_by_hands(Mode mode) noexcept {
  return mode == Mode::clay || mode == Mode::parts;
}

NENDO_API std::string_view name_of(Mode mode) noexcept;
NENDO_API std::optional<Mode> mode_named(std::string_view name) noexcept;

/// The points of a hand that hold the model in type 1: its five fingertips, or points all over its
/// bones and its palm (hand/held_points.hpp). Type 2, and what keeps the volume, are for
/// fingertips.
enum class Hold : std::uint8_t { fingertips, hand };

NENDO_API std::string_view name_of(Hold hold) noexcept; ///< "tips" or "hand"
NENDO_API std::optional<Hold> hold_named(std::string_view name) noexcept;

/// CsrbfOptions::merge_fraction of fingertips, which meet: the exact solution for two that nearly
/// touch would tear the surface between them.
inline constexpr double fingertip_merge_fraction = 0.05;

struct NENDO_API SculptorOptions {
  Mode mode = Mode::type1;
  Hold hold = Hold::fingertips;
  /// The length of a piece of type 2's path, in model units: sculpting::set_supports() chooses it
  /// by the radii, as the default suits no model.
  double piece_length = 0.05;
  /// But for its brushes. Its radii are in model units: sculpting::usual_supports().
  deform::DeformerOptions deformer{.csrbf = {.merge_fraction = fingertip_merge_fraction}};
  /// The brushes of each hand's fingers, thumb to little finger, in type 2; a puppet's points pull.
  std::array<deform::Brush, 5> brushes{};
  double brush_strength = deform::usual_brush_strength;
  /// The x of a plane, in model units: the second half of the control points are the mirror images
  /// of the first, and so are hands that press clay.
  std::optional<double> mirror{};
  /// The model's rings, which some brushes need (needs_rings()).
  std::shared_ptr<const deform::VertexRings> rings{};
  /// If set, distances are measured along the surface at rest. Then nothing keeps the volume, and
  /// links need not be.
  std::shared_ptr<const deform::SurfaceField> surface{};
  /// The hands that press clay or move parts, and the model that is clay, or its parts. A loop sets
  /// them. Without hands, as with a puppet, both modes shape as type 1 does.
  std::shared_ptr<const HandBodies> bodies{};
  std::shared_ptr<const ClayModel> clay{};
  std::shared_ptr<const deform::ModelParts> parts{};

  /// Returns whether a brush does something that needs the triangles about each vertex.
  bool needs_rings() const noexcept;
  /// Returns how many points of a hand hold the model; not of a puppet.
  Eigen::Index points_of_hand() const noexcept;
};

/// Reads the name of a brush, or five with commas between. Returns nothing if it is neither.
NENDO_API std::optional<std::array<deform::Brush, 5>> parse_brushes(std::string_view text) noexcept;
/// Returns such a text.
NENDO_API std::string in_words(const std::array<deform::Brush, 5>& brushes);

class NENDO_API Sculptor {
public:
  /// Works on a shape that other sculptors work on before or after it. `shape`, which has the
  /// history, must outlive it.
  Sculptor(deform::SculptedShape& shape, Eigen::Index control_points,
           const SculptorOptions& options);

  Mode mode() const noexcept;

  Eigen::Index control_points() const noexcept { return control_points_; }

  /// Returns whether fields() describes the last update completely. It does not where distances are
  /// along the surface, where a brush or a whole hand changed something, or with a mask.
  bool is_described_by_fields() const noexcept;

  /// Lets the fingertips grab the model at `tips` (3 by control_points, model units).
  deform::FieldStatus grab(const deform::Points& tips) noexcept;
  /// Does the same in the middle of a step, after release(false).
  deform::FieldStatus continue_grab(const deform::Points& tips) noexcept;
  /// Call after continue_grab(). Hands in clay hold on to what they hold in `before`, and if
  /// `keeps_volume`, the clay keeps the same volume as there.
  void go_on_from(const Sculptor& before, bool keeps_volume) noexcept;
  /// Writes the shape for the fingertips' present places into `out`; blocks that `out` already has
  /// are not written again. Wait-free, except that it may wait for a second thread to finish its
  /// part. It does not allocate if `out` has the right size.
  deform::FieldStatus update(const deform::Points& tips, deform::BlockShape& out) noexcept {
    return shape_to(tips, false, out);
  }
  /// Does what update() does, and completes the stroke up to `tips`.
  deform::FieldStatus finish(const deform::Points& tips, deform::BlockShape& out) noexcept {
    return shape_to(tips, true, out);
  }
  /// Makes the shape that finish() gave the rest shape, which the fingertips then hold where they
  /// are. It must be called after finish() with the same tips. If the equations have no solution,
  /// nothing changes. It does not allocate.
  deform::FieldStatus commit(const deform::Points& tips) noexcept;

  /// Ends the stroke and releases the shape, which stays as update() made it last, for another
  /// sculptor to grab. With `is_step`, undo can go back before the stroke; without, it
  /// becomes one step with the next. It does not allocate.
  void release(bool is_step) noexcept;
  /// Does the same, but in type 1 drops the pull since the fingertips grabbed.
  void drop(bool is_step) noexcept;
  /// Changes the rest shape, or the shape of the strokes. The fingertips then hold it at `tips`. If
  /// the equations have no solution, nothing changes. It does not allocate.
  deform::FieldStatus go(deform::HistoryMove move, const deform::Points& tips) noexcept;
  /// Undoes what the fingertips have shaped since the last commit, or in this stroke, as a step
  /// of its own (Type1Deformer::take_back; in other modes an undo). Otherwise as go().
  deform::FieldStatus take_back(const deform::Points& tips) noexcept;

  /// Returns how often the fingertips grabbed a shape at the tips that a function was given.
  std::uint64_t holds() const noexcept { return holds_; }

  /// Returns the shape that remains when no hand holds the model: the rest shape, or the shape at
  /// the end of the last stroke.
  const deform::BlockShape& rest() const noexcept { return shape_->shape(); }

  /// Returns the fields of the last update: for type 1 they displace the rest shape, for type 2 the
  /// previous shape.
  const deform::FieldSequence& fields() const noexcept;
  /// Writes what the last update() did along the surface: for type 1 from the rest shape to this
  /// shape, for type 2 from the previous shape. Clears `move` if no distances are measured there.
  /// Allocates only if `move` is too small.
  void write_move(deform::SurfaceMove& move) const noexcept;
  bool has_space(const deform::SurfaceMove& move) const noexcept; ///< enough for write_move()
  /// Returns a move that is large enough for write_move(). Allocates.
  deform::SurfaceMove space_for_move() const;
  /// Returns whether the last update() moved anything.
  bool moves_anything() const noexcept;
  /// Returns what the last update() needed to stay injective; all 0 without `injective`.
  deform::ChainReport report() const noexcept;
  /// Returns the hands in clay; null in other modes.
  const ClayHands* clay() const noexcept { return std::get_if<ClayHands>(&deformer_); }
  /// Returns the hands that move parts; null in other modes.
  const PartHands* parts() const noexcept { return std::get_if<PartHands>(&deformer_); }

private:
  deform::FieldStatus shape_to(const deform::Points& tips, bool ends,
                               deform::BlockShape& out) noexcept;
  deform::FieldStatus counted(deform::FieldStatus status) noexcept {
    if (is_solved(status)) ++holds_;
    return status;
  }

  deform::SculptedShape* shape_;
  std::variant<deform::Type1Deformer, deform::Type2Deformer, deform::SurfaceDeformer, ClayHands,
               PartHands>
      deformer_;
  Eigen::Index control_points_;
  std::uint64_t holds_ = 0;
};

/// Returns whether hands play that puppet, which may be null. Otherwise fingertips touch the model.
NENDO_API bool is_played(const puppet::Rig* rig) noexcept;
/// Returns the number of control points that hands move with that puppet; null: without one.
NENDO_API Eigen::Index control_points_of(const puppet::Rig* rig, const SculptorOptions& sculptor,
                                         Eigen::Index hands) noexcept;
/// Returns how many points have radii of their own: the puppet's, or fingertips and their images,
/// even if other points of the hands hold the model.
NENDO_API Eigen::Index supported_points(const puppet::Rig* rig, Eigen::Index hands) noexcept;
/// Returns the x of the plane, in model units, on both sides of which the fingertips shape;
/// nothing: of none.
NENDO_API std::optional<double> mirror_of(const puppet::Rig* rig) noexcept;
/// Returns whether a tick can solve for that puppet's points without allocating. Error, bad_input:
/// there are more than deform::CsrbfSolver::lean_size. Where distances go along the surface, any
/// number is good, because their field is solved for beforehand.
NENDO_API Result<void> check_points(const puppet::Rig* rig);
/// Puts the puppet's masks on that model, and whether it mirrors, into the options. Allocates.
NENDO_API void set_masks(const puppet::Rig* rig, const deform::Mesh& model,
                         const deform::BlockLayout& layout, SculptorOptions& sculptor);
/// Returns the field of a puppet along that model's surface, with the kernel and the radii of these
/// options; null if it measures distances through the air, or no hand plays it. Error: as
/// SurfaceField::make(). Allocates.
NENDO_API Result<std::shared_ptr<const deform::SurfaceField>>
surface_for(const puppet::Rig& rig, const deform::Mesh& model, const deform::BlockLayout& layout,
            const deform::DeformerOptions& options);

} // namespace nendo::flow
