#pragma once
// Long ways of fields that keep the volume. A field without divergence keeps it only while it is a
// velocity. So a way is cut into steps, each by the midpoint rule: a point is asked for the field
// half a step on, at the place where the field at its beginning leads by then. Both fields
// interpolate there, so start points reach their displacements exactly, step by step.

#include <array>

#include <nendo/base/api.hpp>
#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

/// Fields of one frame at most, where the volume is kept: two for each midpoint step.
inline constexpr int max_midpoint_fields = 64;

/// Call go(), then apply field() to the shape as long as next() is true, in the order in which
/// displace() applies several fields. A step has two, of which the first is halfway. After the
/// constructor nothing allocates, locks or calls the system, up to CsrbfSolver::lean_size points.
class NENDO_API MidpointChain {
public:
  /// Steps are a twentieth of the least radius, and the last is what remains, so that the shape is
  /// continuous in the way. A way longer than `max_steps` of them is cut into so many longer ones.
  MidpointChain(Eigen::Index points, Supports supports, CsrbfOptions csrbf, int max_steps);

  /// Freezes the start points (3 by points). On failure, the last good ones stay.
  FieldStatus grab(const Points& starts);
  /// Goes straight from the start points by these displacements (3 by points). If one is not
  /// usable, no step follows.
  FieldStatus go(const Points& displacements) noexcept;
  /// Makes the next field. Returns false if there is none, or if the step to it has no solution;
  /// status() is then the reason.
  bool next() noexcept;

  const CsrbfField& field() const noexcept { return fields_[is_halfway_ ? 0 : 1]; }
  /// Returns the worst status of all steps of the last way.
  FieldStatus status() const noexcept { return status_; }

private:
  FieldStatus make_step(double part) noexcept;

  Supports supports_;
  double max_length_;                  ///< the longest step
  std::array<CsrbfSolver, 2> solvers_; ///< one has the start points' factor
  std::size_t kept_ = 0;               ///< which is the start points'
  Points starts_, displacements_, places_, step_;
  std::array<CsrbfField, 2> fields_; ///< a step's fields: halfway, and the whole
  int max_steps_;
  double done_ = 0.0, part_ = 1.0; ///< shares of the way: done, and in a step
  bool is_halfway_ = false;        ///< the last field was the first of a step
  FieldStatus status_ = FieldStatus::singular;
};

} // namespace nendo::deform
