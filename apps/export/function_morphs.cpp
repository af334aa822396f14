#include "export/function_morphs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/deform/surface_field.hpp>
#include <nendo/deform/type1.hpp>

namespace nendo::exporting {

using deform::Points;
using Eigen::Index;

namespace {

/// Rounding of the solvers' where nothing moves, in parts of the diagonal; far below what a float
/// shows. Without it, targets would not be sparse.
constexpr double min_displacement = 1e-9;

/// What each function does to each vertex, by distances along the surface.
std::vector<Eigen::Matrix3Xf> ways_along(const deform::SurfaceField& field,
                                         const puppet::Rig& rig) {
  const Eigen::MatrixXf weights = field.weights();
  std::vector<Eigen::Matrix3Xf> ways;
  for (std::size_t at = 0; at < rig.puppet().functions.size(); ++at)
    ways.emplace_back(rig.vectors_of(at).cast<float>() * weights);
  return ways;
}

/// The same by distances through the air. Returns nothing if there is no solution.
std::vector<Eigen::Matrix3Xf> ways_through_air(const deform::DeformerOptions& options,
                                               const puppet::Rig& rig, const Points& original) {
  deform::DeformerOptions plain = options;
  plain.injective.reset(); // one field, however far it goes
  plain.evaluation = {.threads = 1, .weight_bytes = 0};
  plain.undo_bytes = 0;
  plain.undo_memory = nullptr;
  deform::Type1Deformer deformer(original, rig.starts().cols(), plain);
  if (!is_solved(deformer.grab(rig.starts()))) return {};
  deform::BlockShape shape = deformer.rest();
  std::vector<Eigen::Matrix3Xf> ways;
  for (std::size_t at = 0; at < rig.puppet().functions.size(); ++at) {
    if (!is_solved(deformer.apply(rig.starts() + rig.vectors_of(at), shape))) return {};
    Points moved = original;
    for (const deform::CsrbfField& field : deformer.fields().fields())
      deform::displace(field, moved, moved);
    ways.emplace_back((moved - original).cast<float>());
  }
  return ways;
}

void add_targets(std::size_t at, const puppet::Function& function, const Eigen::Matrix3Xf& way,
                 std::vector<FunctionMorphs::Target>& targets) {
  const auto add = [&](std::string name, double limit) {
    const auto value = static_cast<float>(std::copysign(std::max(1.0, std::abs(limit)), limit));
    targets.push_back({std::move(name), at, value, value * way});
  };
  if (function.most > 0.0 || function.least == 0.0) add(function.name, function.most);
  if (function.least < 0.0) add(function.name + "_negative", function.least);
}

} // namespace

std::optional<FunctionMorphs> FunctionMorphs::make(const takes::PlayedPuppet& puppet,
                                                   const deform::BlockLayout& layout,
                                                   const flow::Frame& first,
                                                   const Points& vertices) {
  if (puppet.sculptor.mode != flow::Mode::type1) return std::nullopt;
  // What midpoint steps make is not linear in the functions' values.
  if (puppet.sculptor.deformer.csrbf.keeps_volume()) return std::nullopt;
  const puppet::Rig& rig = *puppet.rig;
  std::vector<Eigen::Matrix3Xf> ways =
      puppet.sculptor.surface ? ways_along(*puppet.sculptor.surface, rig)
                              : ways_through_air(puppet.sculptor.deformer, rig, layout.original());
  if (ways.empty()) return std::nullopt;
  const auto least = static_cast<float>(min_displacement * layout.diagonal());
  std::vector<Target> targets;
  for (std::size_t at = 0; at < ways.size(); ++at) {
    Eigen::Matrix3Xf& way = ways[at];
    for (Index v = 0; v < way.cols(); ++v)
      if (way.col(v).norm() < least) way.col(v).setZero();
    add_targets(at, rig.puppet().functions[at], way, targets);
  }
  const bool finite = std::all_of(targets.begin(), targets.end(),
                                  [](const Target& target) { return target.way.allFinite(); });
  if (!finite) return std::nullopt;
  FunctionMorphs morphs(std::move(targets), layout);
  Eigen::Matrix3Xf rest = vertices.cast<float>() - morphs.moved_by(morphs.weights_of(first));
  const double apart = (rest - morphs.rest_).cast<double>().colwise().norm().maxCoeff();
  if (!(apart <= morphs.max_)) morphs.rest_ = std::move(rest);
  return morphs;
}

FunctionMorphs::FunctionMorphs(std::vector<Target> targets, const deform::BlockLayout& layout)
    : targets_(std::move(targets)), rest_(layout.original().cast<float>()),
      max_(ControlMorphs::max_error * layout.diagonal()) {}

std::vector<float> FunctionMorphs::weights_of(const flow::Frame& frame) const {
  std::vector<float> weights;
  for (const Target& target : targets_)
    weights.push_back(target.weight_at(frame.functions[target.function]));
  return weights;
}

Eigen::Matrix3Xf FunctionMorphs::moved_by(std::span<const float> weights) const {
  Eigen::Matrix3Xf moved = Eigen::Matrix3Xf::Zero(3, rest_.cols());
  for (std::size_t at = 0; at < targets_.size(); ++at)
    if (weights[at] > 0.0F) moved += weights[at] * targets_[at].way;
  return moved;
}

Eigen::Matrix3Xf FunctionMorphs::displacement(std::size_t frame) const {
  return moved_by(std::span(weights_).subspan(frame * targets_.size(), targets_.size()));
}

bool FunctionMorphs::add(const flow::Frame& frame, const Points& vertices) {
  const std::vector<float> weights = weights_of(frame);
  const Eigen::Matrix3Xf moved = rest_ + moved_by(weights);
  const double error = (moved.cast<double>() - vertices).colwise().norm().maxCoeff();
  if (!(error <= max_)) return false; // also if it is not a number
  greatest_error_ = std::max(greatest_error_, error);
  weights_.insert(weights_.end(), weights.begin(), weights.end());
  return true;
}

} // namespace nendo::exporting
