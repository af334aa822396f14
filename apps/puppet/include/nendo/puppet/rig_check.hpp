#pragma once
// What can be wrong with a puppet though its file can be read: triangles that turn over, and sides
// that are not alike. Along a surface no theorem keeps a field from folding, so this looks at the
// triangles at the functions' limits.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::puppet {

/// The shapes of a puppet at given values of its functions, without hands and without a loop. They
/// are made by the deformers that the loop has, so a check sees what a run shows. For one thread.
class NENDO_API RigShapes {
public:
  /// Solves for the field. Error: bad_input (points are too near to each other for their radii; it
  /// names them). `model` must have a face. Allocates.
  static Result<std::unique_ptr<RigShapes>> make(std::shared_ptr<const Rig> rig,
                                                 const deform::Mesh& model);
  ~RigShapes();
  RigShapes(const RigShapes&) = delete;
  RigShapes& operator=(const RigShapes&) = delete;

  /// Returns the vertices, 3 by #vertices, where the functions have these values, which no limit
  /// changes. Functions beyond the last value have 0. Allocates.
  deform::Points at(std::span<const double> values);
  /// The same, for one function alone.
  deform::Points at(std::size_t function, double value);
  /// The same, in the blocks of the model's layout, until the next call.
  const deform::BlockShape& blocks_at(std::span<const double> values);
  /// The same, where the points are at these places, 3 by #points.
  const deform::BlockShape& blocks_with(const deform::Points& points);
  /// Returns the condition of the field's equations in the 1-norm (SurfaceField); 0 where distances
  /// are through the air, whose equations are solvable whatever the points are.
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

/// The triangles of the model where one function, or two, are at a limit.
struct LimitCheck {
  AtLimit one;
  std::optional<AtLimit> other{};
  std::size_t moved = 0;  ///< triangles with a corner that moves
  std::size_t turned = 0; ///< those whose normal turns by more than 90 degrees
};

/// Two functions that are each other's mirror image, both at their greatest values.
struct TwinCheck {
  std::size_t left = 0;
  std::size_t right = 0;
  /// The farthest that a vertex is from the mirror image of its twin, as a part of the diagonal.
  double apart = 0.0;
};

struct NENDO_API RigCheck {
  /// Of the moved triangles of one function alone, so many may turn over: rolling lips do.
  static constexpr double max_turned = 0.005;
  /// Twins are symmetric within this part of the diagonal, and what the model itself lacks.
  static constexpr double symmetric_within = 1e-6;
  /// A vertex has a mirror image if there is a vertex within this part of the diagonal.
  static constexpr double image_within = 0.005;

  std::vector<LimitCheck> alone;
  std::vector<LimitCheck> pairs; ///< pairs of functions whose signals differ
  std::vector<TwinCheck> twins;
  std::size_t lone_vertices = 0; ///< the model's vertices without a mirror image
  /// The farthest that a vertex of the model at rest is from the mirror image of its own image, as
  /// a part of the diagonal.
  double model_apart = 0.0;

  static bool folds(const LimitCheck& limit) noexcept {
    return static_cast<double>(limit.turned) > max_turned * static_cast<double>(limit.moved);
  }
  bool are_symmetric(const TwinCheck& pair) const noexcept {
    return pair.apart <= symmetric_within + 2.0 * model_apart;
  }
  bool passes() const noexcept; ///< no function alone folds
};

/// Makes a shape for each limit of each function, and of each pair. `model` is the rig's.
/// Allocates.
NENDO_API RigCheck check_rig(RigShapes& shapes, const deform::Mesh& model);

/// Returns for each point (3 by N) the numbers of those that are where its mirror image about x = 0
/// is, within the tolerance. Parts of a model may touch, so there may be several.
NENDO_API std::vector<std::vector<std::uint32_t>> mirror_images(const deform::Points& points,
                                                                double tolerance);

} // namespace nendo::puppet
