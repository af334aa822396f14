#pragma once
// A common interface of all deformation modes, which the loop uses.

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

namespace nendo::puppet {
class Rig;
} // namespace nendo::puppet

namespace nendo::flow {

/// type1: each tick deforms the rest shape from fixed start points. type2: deforms along the
/// fingertips' paths, piece by piece. clay: whole hands press the surface. parts: hands grab parts
/// of the model and move them.
enum class Mode : std::uint8_t { type1, type2, clay, parts };
inline constexpr std::uint8_t mode_count = 4;

/// Returns whether whole hands shape in this mode. In other modes control points do, also a
/// puppet's.
constexpr bool is_by_hands(Mode mode) noexcept {
  return mode == Mode::clay || mode == Mode::parts;
}

NENDO_API std::string_view name_of(Mode mode) noexcept;
NENDO_API std::optional<Mode> mode_named(std::string_view name) noexcept;

/// The points of a hand that hold the model in type 1: its five fingertips, or points on its bones
/// and palm (hand/held_points.hpp). Type 2 and keep_volume need fingertips.
enum class Hold : std::uint8_t { fingertips, hand };

NENDO_API std::string_view name_of(Hold hold) noexcept; ///< "tips" or "hand"
NENDO_API std::optional<Hold> hold_named(std::string_view name) noexcept;

/// CsrbfOptions::merge_fraction for fingertips: the exact solution for two that nearly touch would
/// tear the surface between them.
inline constexpr double fingertip_merge_fraction = 0.05;

struct NENDO_API SculptorOptions {
  Mode mode = Mode::type1;
  Hold hold = Hold::fingertips;
  /// The length of a piece of type 2's path, in model units: sculpting::set_supports() computes it
  /// from the radii; the default suits no model.
  double piece_length = 0.05;
  /// All but `brushes`. Radii are in model units: sculpting::usual_supports().
  deform::DeformerOptions deformer{.csrbf = {.merge_fraction = fingertip_merge_fraction}};
  /// The brushes of each hand's fingers, thumb to little finger, in type 2. A puppet's points
  /// always pull.
  std::array<deform::Brush, 5> brushes{};
  double brush_strength = deform::usual_brush_strength;
  /// The x of the mirror plane, in model units. The second half of the control points are the
  /// mirror images of the first half; hands that press clay are also mirrored.
  std::optional<double> mirror{};
  /// The model's vertex rings, for brushes with needs_rings().
  std::shared_ptr<const deform::VertexRings> rings{};
  /// If set, distances are measured along the rest surface. Then keep_volume and injective have no
  /// effect.
  std::shared_ptr<const deform::SurfaceField> surface{};
  /// Hands for the modes clay and parts, and the model as clay or as parts. A loop sets them.
  /// Without hands, as with a puppet, both modes act as type 1.
  std::shared_ptr<const HandBodies> bodies{};
  std::shared_ptr<const ClayModel> clay{};
  std::shared_ptr<const deform::ModelParts> parts{};

  /// Returns whether a brush needs the triangles around each vertex.
  bool needs_rings() const noexcept;
  /// Returns the number of points of a hand that hold the model, without a puppet.
  Eigen::Index points_of_hand() const noexcept;
};

/// Parses one brush name, or five separated by commas. Returns nothing if the text is invalid.
NENDO_API std::optional<std::array<deform::Brush, 5>> parse_brushes(std::string_view text) noexcept;
/// Returns a text for parse_brushes().
NENDO_API std::string in_words(const std::array<deform::Brush, 5>& brushes);

class NENDO_API Sculptor {
public:
  /// `shape` has the undo history, and must outlive this. Sculptors can use a shape in turn.
  Sculptor(deform::SculptedShape& shape, Eigen::Index control_points,
           const SculptorOptions& options);

  Mode mode() const noexcept;

  Eigen::Index control_points() const noexcept { return control_points_; }

  /// Returns whether fields() completely describes the last update: not with distances along the
  /// surface, brushes, whole hands or masks.
  bool is_described_by_fields() const noexcept;

  /// Grabs the model at `tips` (3 by control_points, model units).
  deform::FieldStatus grab(const deform::Points& tips) noexcept;
  /// Does the same in the middle of a step, after release(false).
  deform::FieldStatus continue_grab(const deform::Points& tips) noexcept;
  /// Call after continue_grab(). Hands in clay keep their contacts of `before` and, with
  /// `keeps_volume`, the clay's target volume.
  void continue_from(const Sculptor& before, bool keeps_volume) noexcept;
  /// Writes the shape for the current `tips` to `out`, except blocks that `out` already has.
  /// Wait-free, except that it may wait for a second thread to finish its part. It does not
  /// allocate if `out` has the right size.
  deform::FieldStatus update(const deform::Points& tips, deform::BlockShape& out) noexcept {
    return shape_to(tips, false, out);
  }
  /// Does what update() does, and completes the stroke up to `tips`.
  deform::FieldStatus finish(const deform::Points& tips, deform::BlockShape& out) noexcept {
    return shape_to(tips, true, out);
  }
  /// Makes the shape of finish() the rest shape, and grabs it at `tips`. Call it after finish()
  /// with the same tips. If the equations have no solution, nothing changes. Does not allocate.
  deform::FieldStatus commit(const deform::Points& tips) noexcept;

  /// Ends the stroke and releases the shape, as of the last update(), for another sculptor. With
  /// `is_step`, the stroke is an undo step; otherwise it forms one step with the next stroke. Does
  /// not allocate.
  void release(bool is_step) noexcept;
  /// Does the same, but in type 1 discards the deformation since the grab.
  void drop(bool is_step) noexcept;
  /// Moves the shape through its history, and grabs it at `tips`. If the equations have no
  /// solution, nothing changes. Does not allocate.
  deform::FieldStatus apply_history(deform::HistoryMove move, const deform::Points& tips) noexcept;
  /// Undoes the shaping since the last commit, or of this stroke, as its own step
  /// (Type1Deformer::take_back; in other modes an undo). Otherwise like apply_history().
  deform::FieldStatus undo_uncommitted(const deform::Points& tips) noexcept;

  /// Returns the number of successful grabs.
  std::uint64_t holds() const noexcept { return holds_; }

  /// Returns the shape without hands: the rest shape, or the shape after the last stroke.
  const deform::BlockShape& rest() const noexcept { return shape_->shape(); }

  /// Returns the fields of the last update: in type 1 they displace the rest shape, in type 2 the
  /// previous shape.
  const deform::FieldSequence& fields() const noexcept;
  /// Writes the last update()'s move along the surface: in type 1 from the rest shape, in type 2
  /// from the previous shape. Clears `move` if distances are not along the surface. Allocates only
  /// if `move` is too small.
  void write_move(deform::SurfaceMove& move) const noexcept;
  bool has_space(const deform::SurfaceMove& move) const noexcept; ///< enough for write_move()
  /// Returns a move with space for write_move(). Allocates.
  deform::SurfaceMove space_for_move() const;
  /// Returns whether the last update() moved any vertex.
  bool moves_anything() const noexcept;
  /// Returns the last update()'s report on injectivity; all 0 without `injective`.
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

/// Returns whether hands play the puppet, which may be null; otherwise fingertips touch the model.
NENDO_API bool is_played(const puppet::Rig* rig) noexcept;
/// Returns the number of control points for hands with that puppet, or without one (null).
NENDO_API Eigen::Index control_points_of(const puppet::Rig* rig, const SculptorOptions& sculptor,
                                         Eigen::Index hands) noexcept;
/// Returns the number of points with radii: the puppet's, or fingertips and their mirror images,
/// even if other points of hands hold the model.
NENDO_API Eigen::Index supported_points(const puppet::Rig* rig, Eigen::Index hands) noexcept;
/// Returns the x of the fingertips' mirror plane, in model units; nothing: no plane.
NENDO_API std::optional<double> mirror_of(const puppet::Rig* rig) noexcept;
/// Returns whether a tick can solve for that puppet's points without allocating. Error: bad_input
/// (more than deform::CsrbfSolver::lean_size points). With distances along the surface, the number
/// is not limited, because that field is solved beforehand.
NENDO_API Result<void> check_points(const puppet::Rig* rig);
/// Sets the puppet's masks for that model, and its mirror, in the options. Allocates.
NENDO_API void set_masks(const puppet::Rig* rig, const deform::Mesh& model,
                         const deform::BlockLayout& layout, SculptorOptions& sculptor);
/// Returns the field of a puppet along that model's surface, with the kernel and the radii of these
/// options; null if its distances are straight, or it is not played. Errors: those of
/// SurfaceField::make(). Allocates.
NENDO_API Result<std::shared_ptr<const deform::SurfaceField>>
surface_for(const puppet::Rig& rig, const deform::Mesh& model, const deform::BlockLayout& layout,
            const deform::DeformerOptions& options);

} // namespace nendo::flow
