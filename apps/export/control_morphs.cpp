#include "export/control_morphs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/deform/csrbf.hpp>

namespace nendo::exporting {

using deform::CsrbfField;
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

} // namespace nendo::exporting
