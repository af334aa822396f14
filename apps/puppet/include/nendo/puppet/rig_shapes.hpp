#pragma once
// The shapes of a puppet at given values of its functions, without hands and without a loop. They
// are made by the deformers that the loop has, so a check sees what a run shows.

#include <memory>
#include <span>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::puppet {

/// For one thread.
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

} // namespace nendo::puppet
