#pragma once
// Clay: a third way of deforming, beside Type-1 and Type-2. Bodies, such as hands, push the surface
// out of themselves. What they touch becomes one-sided conditions on a CSRBF field, of which the
// one of least energy is taken (a complementarity problem), so that nothing is pulled. Friction
// takes the surface along, fingers that close hold it, and the volume comes back where nothing
// touches.

#include <cstdint>
#include <memory>
#include <span>

#include <nendo/deform/contact_part.hpp>
#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/sculpted_shape.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/deform/vertex_mask.hpp>

namespace nendo::deform {

/// Lengths in millimetres are those of the bodies.
struct ClayOptions {
  double units_per_mm = 1.0; ///< model units per millimetre, > 0
  double radius_mm = 25.0;   ///< the functions' radius, > 0: softness. About 2.5 fingers'.
  double friction = 0.5;     ///< Coulomb's coefficient, >= 0
  bool keeps_volume = true;  ///< only of closed, oriented surfaces
  /// Otherwise bodies carry, turn and roll the model by what sticks to them and presses it.
  bool lies_on_table = true;
  /// Two parts of a body that press from sides that face each other grab what is under
  /// them, until they have opened.
  bool grips = true;
  /// This number of the last bodies does not move, such as a table. They press nothing by
  /// themselves, and contacts() does not list them.
  std::size_t still_bodies = 0;
  int max_constraints = 256; ///< limit for one pass
  /// Of one call. When they are used up, the bodies' step is shortened, and the rest of their way
  /// waits for the next call. What has begun is always finished.
  int max_passes = 48;
  EvaluationOptions evaluation{};
  /// Vertices of weight 0 do not move, bit for bit. Bodies pass through what moves by less than
  /// half.
  std::shared_ptr<const VertexMask> mask{};
};

/// A place where a body touches the surface; model units.
struct ClayContact {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  float load_mm = 0.0F; ///< the pressure: by how much the clay would spring back there, up to 0.5
  float pressed_mm = 0.0F; ///< how deep the part came in this call, before the surface moved
  std::uint32_t body = 0;
  std::uint32_t part = 0; ///< the body's part
};

struct ClayReport {
  FieldStatus status = FieldStatus::ok;
  int sub_steps = 0;
  int passes = 0;            ///< those of all sub-steps; each is a field that does not fold
  int max_constraints = 0;   ///< the most in a pass
  int touching = 0;          ///< conditions that pushed in the last pass
  std::size_t distances = 0; ///< from a vertex to a part
  /// How deep a vertex still was in a body after the passes, before it was pushed straight out.
  double penetration_mm = 0.0;
  double behind_mm = 0.0;     ///< the way that waits for the next call
  std::size_t held = 0;       ///< places that bodies hold on to
  std::size_t kept_apart = 0; ///< vertices that moved as one, because their faces would have met
  double carried_mm = 0.0;    ///< the way of the model's middle as a rigid body
  double turned_rad = 0.0;    ///< and its turns, added up
  bool is_moved = false;      ///< something of the shape has changed
  double volume_change = 0.0; ///< relative to that when the bodies grabbed; 0 if none is kept
};

class NENDO_API ClayDeformer {
public:
  /// Allocates. `triangles` are the vertices of all triangles, three each; without any, or where
  /// they are no closed surface, no volume is kept. Call release() before another deformer works on
  /// `shape`, which must outlive this. `bodies` of `parts_per_body` parts each press.
  ClayDeformer(SculptedShape& shape, std::span<const std::uint32_t> triangles, std::size_t bodies,
               std::size_t parts_per_body, const ClayOptions& options);
  ~ClayDeformer();
  ClayDeformer(ClayDeformer&&) noexcept;
  ClayDeformer& operator=(ClayDeformer&&) noexcept;

  /// Sets where the bodies are, without deforming anything, and ends the stroke before, which
  /// can then be undone. `parts` are those of the first body, and then those of the next. The
  /// status is ok or not_finite, in which case nothing changes.
  FieldStatus begin(std::span<const ContactPart> parts);
  /// Does the same, but without ending the stroke before.
  FieldStatus grab(std::span<const ContactPart> parts);
  /// Call after begin() or grab(). Continues `before`'s contacts and grips for the same bodies; it
  /// was the previous deformer of this clay, perhaps with other triangles. The volume to keep is
  /// that of `before` if `keeps_volume`. Does nothing for other bodies. Does not allocate.
  void go_on_from(const ClayDeformer& before, bool keeps_volume) noexcept;
  /// Releases until the next begin() or grab(). With `is_step`, the stroke has ended.
  void release(bool is_step) noexcept;
  /// Moves the bodies from where they are to `parts`, in as many sub-steps as keep each from
  /// passing through a thin part, and deforms the shape. Does not allocate, lock or call the
  /// system. Its cost grows with the vertices near the bodies. If a number is not finite, nothing
  /// happens and the status is not_finite. Before begin() or grab(), this is begin().
  const ClayReport& press_to(std::span<const ContactPart> parts);

  /// Does what Type2Deformer::go() does; `parts` are where the bodies then are.
  FieldStatus go(HistoryMove move, std::span<const ContactPart> parts);

  const BlockLayout& layout() const noexcept { return shape_->layout(); }
  const BlockShape& shape() const noexcept { return shape_->shape(); }
  /// Returns what the last press_to() took.
  const ClayReport& report() const noexcept { return report_; }
  /// Returns the places where bodies touch the surface after the last press_to(): at most
  /// ClayOptions::max_constraints, evenly over what is touched.
  std::span<const ClayContact> contacts() const noexcept;
  /// Returns the shape's volume after the last call, in cubic model units; 0 if none is kept.
  double volume() const noexcept;

private:
  class Work;

  SculptedShape* shape_;
  std::unique_ptr<Work> work_;
  ClayReport report_;
};

} // namespace nendo::deform
