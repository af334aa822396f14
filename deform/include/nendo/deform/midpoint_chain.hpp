#pragma once
// Long paths of fields that keep the volume. A divergence-free field keeps the volume only as a
// velocity. So a path is divided into steps, each by the midpoint rule: the first field moves a
// point by half a step, and the second field is evaluated at this position. Both fields interpolate
// the control vectors, so start points reach their displacements exactly in each step.

#include <array>

#include <nendo/base/api.hpp>
#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

/// Max number of fields per frame if the volume is kept: two per midpoint step.
inline constexpr int max_midpoint_fields = 64;

/// Call go(), then apply field() to the shape while next() returns true, as displace() applies
/// several fields. A step has two fields, of which the first is halfway. Up to
/// CsrbfSolver::lean_size points, only the constructor allocates, locks or makes system calls.
class NENDO_API MidpointChain {
public:
  /// The step length is a twentieth of the smallest radius, and the last step is the remainder, so
  /// that the shape is continuous in the path. A path of more than `max_steps` steps is divided
  /// into `max_steps` longer ones.
  MidpointChain(Eigen::Index points, Supports supports, CsrbfOptions csrbf, int max_steps);

  /// Freezes the start points (3 by points). On failure, the previous start points are kept.
  FieldStatus grab(const Points& starts);
  /// Begins a straight path from the start points by these displacements (3 by points). If one is
  /// not usable, the path has no steps.
  FieldStatus go(const Points& displacements) noexcept;
  /// Computes the next field. Returns false if no field is left, or if its step has no solution;
  /// status() is then the reason.
  bool next() noexcept;

  const CsrbfField& field() const noexcept { return fields_[is_halfway_ ? 0 : 1]; }
  /// Returns the worst status of all steps of the last path.
  FieldStatus status() const noexcept { return status_; }

private:
  FieldStatus make_step(double part) noexcept;

  Supports supports_;
  double max_length_;                  ///< the longest step
  std::array<CsrbfSolver, 2> solvers_; ///< one has the start points' factor
  std::size_t kept_ = 0;               ///< index of the start points' solver
  Points starts_, displacements_, places_, step_;
  std::array<CsrbfField, 2> fields_; ///< a step's fields: halfway and full
  int max_steps_;
  double done_ = 0.0, part_ = 1.0; ///< fractions of the path: completed, and per step
  bool is_halfway_ = false;        ///< the last field was the first of a step
  FieldStatus status_ = FieldStatus::singular;
};

} // namespace nendo::deform
