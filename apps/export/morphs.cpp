#include "export/morphs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/surface_field.hpp>
#include <nendo/deform/type1.hpp>

namespace nendo::exporting {

using deform::CsrbfField;
using deform::Points;
using Eigen::Index;

namespace {

// Rounding of the solver's where a support does not reach; far below what a float shows.
constexpr double min_influence = 1e-9;

bool is_one_radius(const CsrbfField& field) {
  return (field.radii.array() == field.radii[0]).all();
}

/// One field for each start point that moves it by 1 along x, and no other.
std::vector<CsrbfField> cardinal_fields(const CsrbfField& field) {
  deform::CsrbfSolver solver({.kernel = field.kernel});
  if (solver.build(field.centres, field.radii) != deform::FieldStatus::ok) return {};
  std::vector<CsrbfField> fields;
  for (Index j = 0; j < field.centres.cols(); ++j) {
    deform::Points unit = deform::Points::Zero(3, field.centres.cols());
    unit(0, j) = 1.0;
    if (solver.solve(unit, fields.emplace_back()) != deform::FieldStatus::ok) return {};
  }
  return fields;
}

/// One for each function of the field.
std::vector<CsrbfField> single_fields(const CsrbfField& field) {
  std::vector<CsrbfField> fields(static_cast<std::size_t>(field.centres.cols()));
  for (Index j = 0; j < field.centres.cols(); ++j) {
    CsrbfField& one = fields[static_cast<std::size_t>(j)];
    one.kernel = field.kernel;
    one.centres = field.centres.col(j);
    one.radii = field.radii.segment<1>(j);
    one.coefficients = Eigen::Vector3d::UnitX();
  }
  return fields;
}

} // namespace

ControlMorphs::ControlMorphs(const deform::BlockLayout& layout, Eigen::VectorXd weights)
    : layout_(layout), weights_(std::move(weights)), rest_(layout.original().cast<float>()) {}

bool ControlMorphs::set_basis(const CsrbfField& field) {
  std::vector<CsrbfField> fields;
  cardinal_ = false;
  if (is_one_radius(field)) {
    fields = cardinal_fields(field);
    cardinal_ = !fields.empty();
  }
  if (!cardinal_) fields = single_fields(field);
  const deform::Points& original = layout_.original();
  influences_.resize(static_cast<Index>(fields.size()), original.cols());
  for (Index j = 0; j < influences_.rows(); ++j) {
    const CsrbfField& one = fields[static_cast<std::size_t>(j)];
    for (Index v = 0; v < original.cols(); ++v) {
      const double weight = weights_.size() == 0 ? 1.0 : weights_[v];
      const double influence = weight * one.displacement_at(original.col(v)).x();
      influences_(j, v) =
          std::abs(influence) < min_influence ? 0.0F : static_cast<float>(influence);
    }
  }
  centres_ = field.centres;
  return influences_.allFinite();
}

Eigen::Matrix3Xf ControlMorphs::vectors_of(const CsrbfField& field) const {
  if (!cardinal_) return field.coefficients.cast<float>();
  Eigen::Matrix3Xf vectors(3, centres_.cols());
  for (Index j = 0; j < centres_.cols(); ++j)
    vectors.col(j) = field.displacement_at(centres_.col(j)).cast<float>();
  return vectors;
}

bool ControlMorphs::add(const flow::Frame& frame, const deform::Points& vertices) {
  const auto fields = frame.fields.fields();
  if (fields.size() > 1 || frame.rest_changes > 0) return false;
  const CsrbfField* const field = fields.empty() ? nullptr : &fields.front();
  if (field != nullptr) {
    if (field->centres.cols() == 0 || !field->polynomial.isZero(0.0)) return false;
    if (centres_.cols() == 0 && !set_basis(*field)) return false;
    if (field->centres.cols() != centres_.cols() || field->centres != centres_) return false;
  }
  Eigen::Matrix3Xf moved = rest_;
  Eigen::Matrix3Xf vectors; // none before the basis is known
  if (centres_.cols() > 0) {
    vectors.setZero(3, influences_.rows());
    if (field != nullptr) vectors = vectors_of(*field);
    moved.noalias() += vectors * influences_;
  }
  const double error = (moved.cast<double>() - vertices).colwise().norm().maxCoeff();
  if (!(error <= max_error * layout_.diagonal())) return false; // also if it is not a number
  greatest_error_ = std::max(greatest_error_, error);
  if (centres_.cols() == 0) ++still_;
  vectors_.insert(vectors_.end(), vectors.data(), vectors.data() + vectors.size());
  return true;
}

Eigen::Matrix3Xf ControlMorphs::displacement(std::size_t frame) const {
  // The basis may be that of a frame that could not be added.
  if (frame < still_) return Eigen::Matrix3Xf::Zero(3, rest_.cols());
  const Index width = influences_.rows();
  const auto begin = static_cast<Index>(frame - still_) * 3 * width;
  return Eigen::Map<const Eigen::Matrix3Xf>(vectors_.data() + begin, 3, width) * influences_;
}

float ControlMorphs::greatest_vector() const noexcept {
  float greatest = 0.0F;
  for (const float coordinate : vectors_)
    greatest = std::max(greatest, std::abs(coordinate));
  return greatest;
}

std::vector<float> ControlMorphs::vectors() const {
  std::vector<float> all(still_ * static_cast<std::size_t>(3 * influences_.rows()), 0.0F);
  all.insert(all.end(), vectors_.begin(), vectors_.end());
  return all;
}

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
  if (!std::ranges::all_of(targets, [](const Target& target) { return target.way.allFinite(); }))
    return std::nullopt;
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

KeyShapes::KeyShapes(double tolerance, Keep keep, std::size_t max_bytes)
    : tolerance_(tolerance), keep_(std::move(keep)), max_bytes_(max_bytes) {}

/// Of the window's inner frames, if its first and its last one are keys.
double KeyShapes::error_between() const {
  const Moment& from = window_.front();
  const Moment& to = window_.back();
  float worst = 0.0F;
  for (std::size_t at = 1; at + 1 < window_.size(); ++at) {
    const float share = (window_[at].time_s - from.time_s) / (to.time_s - from.time_s);
    const float squared = ((1.0F - share) * from.shape + share * to.shape - window_[at].shape)
                              .colwise()
                              .squaredNorm()
                              .maxCoeff();
    worst = std::max(worst, squared);
    if (std::sqrt(static_cast<double>(worst)) > tolerance_) break; // it will not be kept
  }
  return std::sqrt(static_cast<double>(worst));
}

void KeyShapes::add(float time_s, Shape shape) {
  const auto shape_bytes = static_cast<std::size_t>(shape.size()) * sizeof(float);
  window_.push_back({time_s, std::move(shape)});
  if (window_.size() == 1) keep_(time_s, window_.front().shape);
  if (window_.size() <= 2) return;
  const double error = error_between();
  if (!(error <= tolerance_)) {
    end_at(window_.size() - 2);
    return;
  }
  straight_error_ = error;
  if (window_.size() >= max_between + 2 || window_.size() * shape_bytes > max_bytes_)
    end_at(window_.size() - 1);
}

/// That frame becomes a key, up to which straight_error_ holds.
void KeyShapes::end_at(std::size_t moment) {
  greatest_error_ = std::max(greatest_error_, std::exchange(straight_error_, 0.0));
  keep_(window_[moment].time_s, window_[moment].shape);
  window_.erase(window_.begin(), window_.begin() + static_cast<std::ptrdiff_t>(moment));
}

void KeyShapes::finish() {
  if (window_.size() > 1) end_at(window_.size() - 1);
}

} // namespace nendo::exporting
