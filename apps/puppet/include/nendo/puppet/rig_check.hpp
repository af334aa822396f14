#pragma once
// Checks a readable puppet for flipped triangles and asymmetric sides. No theorem excludes folds of
// a field along a surface, so the check inspects the triangles at the functions' limits.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::puppet {

/// The shapes of a puppet at given function values, without hands and without a loop. The loop's
/// deformers make them, so a check sees the shapes of a run. For one thread.
class NENDO_API RigShapes {
public:
  /// Solves for the field. Error: bad_input (points are too close for their radii; the message
  /// names them). `model` must have a face. Allocates.
  static Result<std::unique_ptr<RigShapes>> make(std::shared_ptr<const Rig> rig,
                                                 const deform::Mesh& model);
  ~RigShapes();
  RigShapes(const RigShapes&) = delete;
  RigShapes& operator=(const RigShapes&) = delete;

  /// Returns the vertices, 3 by #vertices, for these function values, which are not clamped.
  /// Functions without a value have 0. Allocates.
  deform::Points at(std::span<const double> values);
  /// Does the same for one function; the others have 0.
  deform::Points at(std::size_t function, double value);
  /// Does the same in blocks of the model's layout, which are valid until the next call.
  const deform::BlockShape& blocks_at(std::span<const double> values);
  /// Does the same for these point positions, 3 by #points.
  const deform::BlockShape& blocks_with(const deform::Points& points);
  /// Returns the condition number of the field's equations in the 1-norm (SurfaceField); 0 for
  /// straight distances, whose equations are always solvable.
  double condition() const noexcept;
  const Rig& rig() const noexcept;

private:
  struct Parts;
  explicit RigShapes(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// One function at one of its limits.
struct AtLimit {
  std::size_t function = 0;
  double value = 0.0;
};

/// Counts of the model's triangles with one function, or two, at a limit.
struct LimitCheck {
  AtLimit one;
  std::optional<AtLimit> other{};
  std::size_t moved = 0;  ///< triangles with a corner that moves
  std::size_t turned = 0; ///< moved triangles whose normal rotates by more than 90 degrees
};

/// Two functions that are mirror images of each other, both at their max values.
struct TwinCheck {
  std::size_t left = 0;
  std::size_t right = 0;
  /// Max distance of a vertex from the mirror image of its twin, as a fraction of the diagonal.
  double apart = 0.0;
};

struct NENDO_API RigCheck {
  /// Max fraction of one function's moved triangles that may flip, because rolling lips do.
  static constexpr double max_turned = 0.005;
  /// Tolerance for symmetric twins, as a fraction of the diagonal, beside the model's own
  /// asymmetry.
  static constexpr double symmetric_within = 1e-6;
  /// Max distance of a mirror image from the exact mirror position, as a fraction of the diagonal.
  static constexpr double image_within = 0.005;

  std::vector<LimitCheck> alone;
  std::vector<LimitCheck> pairs; ///< pairs of functions whose signals differ
  std::vector<TwinCheck> twins;
  std::size_t lone_vertices = 0; ///< the model's vertices without a mirror image
  /// Max distance, on the model at rest, of a vertex from the mirror position of its image, as a
  /// fraction of the diagonal.
  double model_apart = 0.0;

  static bool folds(const LimitCheck& limit) noexcept {
    return static_cast<double>(limit.turned) > max_turned * static_cast<double>(limit.moved);
  }
  bool are_symmetric(const TwinCheck& pair) const noexcept {
    return pair.apart <= symmetric_within + 2.0 * model_apart;
  }
  bool passes() const noexcept; ///< no single function folds
};

/// Checks the shape at each limit of each function, and of each pair. `model` must be the rig's.
/// Allocates.
NENDO_API RigCheck check_rig(RigShapes& shapes, const deform::Mesh& model);

/// Returns for each point (3 by N) the indices of the points at its mirror position about x = 0,
/// within the tolerance. There may be several, because parts of a model may touch.
NENDO_API std::vector<std::vector<std::uint32_t>> mirror_images(const deform::Points& points,
                                                                double tolerance);

} // namespace nendo::puppet
