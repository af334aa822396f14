#pragma once
// Clay: a third deformation mode, beside Type-1 and Type-2. Bodies, such as hands, push the surface
// out of their interior. Contacts become unilateral constraints on a CSRBF field; the solver takes
// the field of least energy (a complementarity problem), so that no contact pulls. Friction drags
// the surface along, closing fingers grip it, and the volume is restored where nothing touches.

#include <cstdint>
#include <memory>
#include <span>

#include <nendo/deform/contact_part.hpp>
#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/sculpted_shape.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/deform/vertex_mask.hpp>

namespace nendo::deform {

/// Lengths in millimetres are at the scale of the bodies.
struct ClayOptions {
  double units_per_mm = 1.0; ///< model units per millimetre, > 0
  double radius_mm = 25.0;   ///< radius of the radial functions, > 0: softness
  double friction = 0.5;     ///< Coulomb friction coefficient, >= 0
  bool keeps_volume = true;  ///< applies only to closed, oriented surfaces
  /// If false, bodies carry, rotate and roll the model by friction and pressure.
  bool lies_on_table = true;
  /// Two parts of a body that press from opposite sides grip the surface between them until they
  /// open.
  bool grips = true;
  /// Number of bodies, at the end of the list, that do not move, such as a table. They exert no
  /// pressure by themselves, and contacts() does not list them.
  std::size_t still_bodies = 0;
  int max_constraints = 256; ///< limit per pass
  /// Limit per call. When it is reached, the bodies' step is shortened, and the rest of their path
  /// waits for the next call. A sub-step that has begun is always finished.
  int max_passes = 48;
  EvaluationOptions evaluation{};
  /// Vertices of weight 0 do not move, bit for bit. Bodies pass through vertices of weight below
  /// 1/2.
  std::shared_ptr<const VertexMask> mask{};
};

/// A contact between a body and the surface; positions are in model units.
struct ClayContact {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  float load_mm = 0.0F;    ///< pressure, as the distance of the clay's springback, up to 0.5
  float pressed_mm = 0.0F; ///< penetration depth of the part in this call, before the surface moved
  std::uint32_t body = 0;
  std::uint32_t part = 0; ///< index of the part in its body
};

struct ClayReport {
  FieldStatus status = FieldStatus::ok;
  int sub_steps = 0;
  int passes = 0;            ///< passes of all sub-steps; each applies one fold-free field
  int max_constraints = 0;   ///< max over all passes
  int touching = 0;          ///< active constraints in the last pass
  std::size_t distances = 0; ///< computed distances from a vertex to a part
  /// Max penetration depth of a vertex after the passes, before it was projected out of the body.
  double penetration_mm = 0.0;
  double remaining_path_mm = 0.0; ///< path length that waits for the next call
  std::size_t held = 0;           ///< number of points that bodies grip
  std::size_t kept_apart = 0;     ///< vertices moved together to prevent collisions of their faces
  double carried_mm = 0.0;        ///< path length of the model's centre in rigid motion
  double turned_rad = 0.0;        ///< sum of the rotation angles in rigid motion
  bool is_moved = false;          ///< the shape has changed
  double volume_change = 0.0;     ///< relative to the volume at the grab; 0 if no volume is kept
};

class NENDO_API ClayDeformer {
public:
  /// Allocates. `triangles` has three vertex indices per triangle; if it is empty or no closed
  /// surface, no volume is kept. Call release() before another deformer works on `shape`, which
  /// must outlive this one. `bodies` is the number of bodies, each of `parts_per_body` parts.
  ClayDeformer(SculptedShape& shape, std::span<const std::uint32_t> triangles, std::size_t bodies,
               std::size_t parts_per_body, const ClayOptions& options);
  ~ClayDeformer();
  ClayDeformer(ClayDeformer&&) noexcept;
  ClayDeformer& operator=(ClayDeformer&&) noexcept;

  /// Sets the bodies without deforming the shape, and ends the previous stroke, which can then be
  /// undone. `parts` lists the parts body by body. The status is ok, or not_finite, in which case
  /// nothing changes.
  FieldStatus begin(std::span<const ContactPart> parts);
  /// Does the same without ending the previous stroke.
  FieldStatus grab(std::span<const ContactPart> parts);
  /// Takes over the contacts and grips of `before`, the previous deformer of this clay, whose
  /// triangles may differ, and with `keeps_volume` also the volume to keep. Call after begin() or
  /// grab(). Does nothing if the bodies' numbers or scales differ. Does not allocate.
  void continue_from(const ClayDeformer& before, bool keeps_volume) noexcept;
  /// Releases the shape until the next begin() or grab(). With `is_step`, ends the stroke.
  void release(bool is_step) noexcept;
  /// Moves the bodies to `parts`, in sub-steps so short that no body passes through a thin part,
  /// and deforms the shape. Does not allocate, lock or make system calls. The cost grows with the
  /// number of vertices near the bodies. If a number is not finite, nothing changes and the status
  /// is not_finite. Before begin() or grab(), it does what begin() does.
  const ClayReport& press_to(std::span<const ContactPart> parts);

  /// Does what Type2Deformer::go() does; `parts` are the bodies afterwards.
  FieldStatus go(HistoryMove move, std::span<const ContactPart> parts);

  const BlockLayout& layout() const noexcept { return shape_->layout(); }
  const BlockShape& shape() const noexcept { return shape_->shape(); }
  /// Returns the report of the last press_to().
  const ClayReport& report() const noexcept { return report_; }
  /// Returns the contacts after the last press_to(): at most ClayOptions::max_constraints,
  /// distributed evenly over the contact areas.
  std::span<const ClayContact> contacts() const noexcept;
  /// Returns the shape's volume after the last call, in cubic model units; 0 if no volume is kept.
  double volume() const noexcept;

private:
  class Work;

  SculptedShape* shape_;
  std::unique_ptr<Work> work_;
  ClayReport report_;
};

} // namespace nendo::deform
