#pragma once
// Exports a take of a puppet exactly, as morph targets. A puppet of Type-1 is linear: a shape is
// the rest shape plus the sum of M_f over all functions f, each times its value, where M_f is what
// the function does to the model at a value of 1. So each function is a target with its name, and
// the weights of a frame are the values. A commit leaves such a sum as it is if distances are
// measured along the surface, because the field stays that of the surface at rest.
//
// Blender keeps weights between 0 and 1 (its importer widens the range for the first key only). So
// a function that may go below 0 has a second target, which leads the other way. Where a limit is
// beyond 1, the target is what the function does at that limit.

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "export/control_morphs.hpp"
#include "takes/frame_source.hpp"

namespace nendo::exporting {

class FunctionMorphs {
public:
  struct Target {
    std::string name;     ///< the function's, and "_negative" if it is for values below 0
    std::size_t function; ///< of the puppet
    float value;          ///< of the function at a weight of 1: 1, or a limit beyond 1
    Eigen::Matrix3Xf way; ///< of each vertex at that value, in the mesh's order, model units

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
  double max_; ///< of an error, model units
  std::vector<float> weights_;
  double greatest_error_ = 0.0;
};

} // namespace nendo::exporting
