#pragma once
// Takes as morph targets: exact ones of takes that are linear in control vectors or in the
// functions of a puppet, and key shapes of all others.

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <nendo/flow/frame.hpp>

#include "takes/frame_source.hpp"

namespace nendo::exporting {

/// Exports a take of Type-1 exactly, as morph targets. As long as the fingertips keep hold, the
/// start points are frozen, and the rest shape is displaced by sum_j u_j(x) w_j, with an influence
/// u_j for each start point and its control vector w_j (nendo/deform/field.hpp). The displacement
/// is linear in the vectors, so it is given by targets along the axes for each vector and by their
/// weights over time.
///
/// With one radius, u_j is 1 at its start point and 0 at the others. With several radii there are
/// more functions than start points, and each function has its own targets instead.
class ControlMorphs {
public:
  /// A shape that differs by more than this fraction of the model's diagonal is not linear in the
  /// control vectors. Type-1 keeps its own shapes within the same bound.
  static constexpr double max_error = 1e-5;

  /// weights: how far each vertex follows, which stays linear (deform::VertexMask); empty: all do.
  explicit ControlMorphs(const deform::BlockLayout& layout, Eigen::VectorXd weights = {});

  /// Adds a frame with its vertices, in the mesh's order. Returns false if the take is not linear
  /// (commits, several links, polynomials, Type-2). The frames before remain, and no other may be
  /// added then.
  bool add(const flow::Frame& frame, const deform::Points& vertices);

  /// Returns the greatest error of the frames so far, in model units. It is measured in 32-bit
  /// floats, as a reader of the targets computes them.
  double greatest_error() const noexcept { return greatest_error_; }
  /// Returns how far each vertex is from the model at rest, in the frame with that number from 0:
  /// 3 by #vertices.
  Eigen::Matrix3Xf displacement(std::size_t frame) const;
  /// Returns one row for each control vector and one column for each vertex. The influence is zero
  /// where no support reaches.
  const Eigen::MatrixXf& influences() const noexcept { return influences_; }
  /// Returns the largest absolute coordinate of all control vectors. It is 0 if nothing ever moved.
  float greatest_vector() const noexcept;
  /// Returns the control vectors of each frame, one after another: x y z of the first, and so on.
  std::vector<float> vectors() const;

private:
  bool set_basis(const deform::CsrbfField& field);
  Eigen::Matrix3Xf vectors_of(const deform::CsrbfField& field) const;

  const deform::BlockLayout& layout_;
  Eigen::VectorXd weights_;
  Eigen::Matrix3Xf rest_;
  deform::Points centres_; ///< the basis; empty until a frame has a field
  bool cardinal_ = false;  ///< otherwise the functions themselves are the basis
  Eigen::MatrixXf influences_;
  std::size_t still_ = 0;      ///< frames before the basis was known
  std::vector<float> vectors_; ///< the later frames, one after another
  double greatest_error_ = 0.0;
};

/// Exports a take of a puppet exactly, as morph targets. A puppet of Type-1 is linear: a shape is
/// the rest shape plus the sum of M_f over all functions f, each times its value, where M_f is what
/// the function does to the model at a value of 1. So each function is a target with its name, and
/// the weights of a frame are the values. A commit leaves such a sum as it is if distances are
/// measured along the surface, because the field stays that of the surface at rest.
///
/// Blender keeps weights between 0 and 1 (its importer widens the range for the first key only). So
/// a function that may go below 0 has a second target, which leads the other way. Where a limit is
/// beyond 1, the target is what the function does at that limit.
class FunctionMorphs {
public:
  struct Target {
    std::string name;     ///< the function's, and "_negative" if it is for values below 0
    std::size_t function; ///< index in the puppet
    float value;          ///< the function's value at a weight of 1: 1, or a limit beyond 1
    Eigen::Matrix3Xf
        way; ///< displacement of each vertex at that value, in the mesh's order, model units

    float weight_at(float of_function) const noexcept {
      return std::max(0.0F, of_function / value);
    }
  };

  /// Makes the targets of all functions, whether the take uses them or not. Returns nothing if the
  /// puppet is not linear (Type-2), or if the field cannot be solved. `layout` must be that of the
  /// puppet's model. With a frame and its vertices, the rest shape is what these are without the
  /// functions, where that is not the model itself: something was shaped before, as by a puppet
  /// that was edited since. Allocates.
  static std::optional<FunctionMorphs> make(const takes::PlayedPuppet& puppet,
                                            const deform::BlockLayout& layout,
                                            const flow::Frame& first,
                                            const deform::Points& vertices);

  /// Adds a frame with its vertices, in the mesh's order. Returns false if a vertex differs from
  /// the sum by more than ControlMorphs::max_error of the model's diagonal. The frames before
  /// remain then.
  bool add(const flow::Frame& frame, const deform::Points& vertices);

  /// Returns the greatest error of the frames so far, in model units. It is measured in 32-bit
  /// floats, as a reader of the targets computes them.
  double greatest_error() const noexcept { return greatest_error_; }
  /// Returns how far each vertex is from the rest shape, in the frame with that number from 0: 3 by
  /// #vertices.
  Eigen::Matrix3Xf displacement(std::size_t frame) const;
  /// Returns the rest shape, 3 by #vertices, in the mesh's order, model units.
  const Eigen::Matrix3Xf& rest() const noexcept { return rest_; }
  const std::vector<Target>& targets() const noexcept { return targets_; }
  /// Returns the weights of all targets, one frame after another, from 0 to 1.
  const std::vector<float>& weights() const noexcept { return weights_; }

private:
  FunctionMorphs(std::vector<Target> targets, const deform::BlockLayout& layout);
  std::vector<float> weights_of(const flow::Frame& frame) const;
  Eigen::Matrix3Xf moved_by(std::span<const float> weights) const;

  std::vector<Target> targets_;
  Eigen::Matrix3Xf rest_;
  double max_; ///< error limit, model units
  std::vector<float> weights_;
  double greatest_error_ = 0.0;
};

/// Reduces a motion of many vertices to a few key shapes, between which vertices are interpolated
/// linearly. A shape becomes a key where interpolation without it would exceed the tolerance.
class KeyShapes {
public:
  using Shape = Eigen::Matrix3Xf; ///< 3 by #vertices, places or displacements
  /// Receives the keys in the order of time.
  using Keep = std::function<void(float time_s, const Shape& shape)>;

  /// `tolerance` is the greatest error of a vertex. Frames between two keys are kept in memory, at
  /// most `max_bytes` and `max_between` frames.
  KeyShapes(double tolerance, Keep keep, std::size_t max_bytes = std::size_t{256} << 20);
  static constexpr std::size_t max_between = 62;

  /// Adds the next frame. Its time must be greater than the previous one.
  void add(float time_s, Shape shape);
  /// Makes the last frame a key. Nothing may be added afterwards.
  void finish();

  /// Returns the greatest measured error of a vertex over all frames between the keys.
  double greatest_error() const noexcept { return greatest_error_; }

private:
  struct Moment {
    float time_s;
    Shape shape;
  };

  double error_between() const;
  void end_at(std::size_t moment);

  double tolerance_;
  Keep keep_;
  std::size_t max_bytes_;
  std::vector<Moment> window_;  ///< the latest key and all frames since
  double straight_error_ = 0.0; ///< from the key to the last but one, or to the last
  double greatest_error_ = 0.0;
};

} // namespace nendo::exporting
