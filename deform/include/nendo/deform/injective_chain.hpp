#pragma once
// Deforms without folding (the fourth item of the paper's outlook): the straight path of the start
// points is cut into links. Each link is a field centred at the current points, and so short that x
// -> x + s(x) is a homeomorphism; so is the chain of links. Where paths cross, no link would be
// short enough, so these points are kept apart (MinGap).

#include <array>
#include <memory>
#include <span>

#include <nendo/base/api.hpp>
#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/jacobian.hpp>

namespace nendo::deform {

class MinGap;

/// Two fingertips separated by a wall, because their paths cross.
struct HeldPair {
  Eigen::Index first = 0; ///< column of the fingertip on the wall's upper side; less than `second`
  Eigen::Index second = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< unit length, from the second to the first
  double gap = 0.0;                                 ///< along the normal, in model units
  double push = 0.0; ///< distance of each from its requested position, in model units
};

struct InjectiveOptions {
  double max_bound = 0.9; ///< largest Lipschitz bound of a link; below 1
  int max_links = 64;     ///< limit per call
  double min_gap = 0.05;  ///< as a fraction of a point's smallest radius; 0: no min distance
};

struct ChainReport {
  FieldStatus status = FieldStatus::ok;
  int links = 0;                ///< number of links made
  double whole_bound = 0.0;     ///< Lipschitz bound of the first field before the path was cut
  double bound = 0.0;           ///< max Lipschitz bound of the links
  double min_determinant = 1.0; ///< min of the chain near the points; see DeterminantProbe
  int held_pairs = 0;           ///< pairs that are kept from their requested positions
  bool reached = true;          ///< false if `max_links` were not enough for the whole path
};

/// Call from_start() or from_here(), then apply field() to the shape while next() returns true:
///   for (chain.from_start(ends); chain.next();) displace(chain.field(), shape, shape);
/// Up to CsrbfSolver::lean_size points, only the constructor allocates, locks or makes system
/// calls, and next() takes a bounded time.
class NENDO_API InjectiveChain {
public:
  InjectiveChain(Eigen::Index points, Supports supports, CsrbfOptions csrbf,
                 InjectiveOptions options);
  ~InjectiveChain();
  InjectiveChain(InjectiveChain&&) noexcept;
  InjectiveChain& operator=(InjectiveChain&&) noexcept;

  /// Freezes the start points (3 by points). On failure, the previous start points are kept.
  FieldStatus grab(const Points& starts);
  /// Type-1: moves straight from the start points to `ends` (3 by points). The links apply to the
  /// rest shape and depend on nothing else. If an end is not finite, the previous ends are used.
  FieldStatus from_start(const Points& ends) noexcept;
  /// Type-2: continues from the current positions, with the existing walls, in at most `max_links`
  /// links. The links apply to the current shape. If an end is not finite, no link follows.
  FieldStatus from_here(const Points& ends, int max_links) noexcept;
  FieldStatus from_here(const Points& ends) noexcept { return from_here(ends, options_.max_links); }

  /// Computes the next link's field. Returns false if no link is left; the report is then complete.
  bool next() noexcept;

  /// Returns the solver that is built for the start points. Solving with it does not affect the
  /// chain.
  CsrbfSolver& start_solver() noexcept { return solvers_[kept_]; }
  /// Returns the field of the last link.
  const CsrbfField& field() const noexcept { return field_; }
  const ChainReport& report() const noexcept { return report_; }
  /// Returns the current positions of the points. Held points are not at their requested positions.
  const Points& places() const noexcept { return places_; }
  /// Returns all walls. A pair is held if its `push` is positive.
  std::span<const HeldPair> walls() const noexcept;

private:
  FieldStatus go(int max_links) noexcept;
  FieldStatus make_link() noexcept;
  void extend(double part, bool first) noexcept;
  bool end(FieldStatus status) noexcept;

  Supports supports_;
  CsrbfOptions csrbf_;
  InjectiveOptions options_;
  std::array<CsrbfSolver, 2> solvers_; ///< one has the start points' factor, the other a link's
  std::size_t kept_ = 0;               ///< index of the start points' solver
  bool grabbed_ = false;
  bool at_start_ = false; ///< places_ are the start points
  bool ended_ = true;
  int max_links_ = 0;
  Points starts_;
  Eigen::VectorXd radii_; ///< smallest radius of each point
  Points places_;
  Points wanted_;  ///< requested ends
  Points allowed_; ///< ends that the walls permit
  Points step_;
  Points tips_; ///< ends of the current link
  double link_bound_ = 0.0;
  std::unique_ptr<MinGap> gaps_;
  DeterminantProbe probe_;
  CsrbfField field_;
  CsrbfField piece_; ///< field up to the next corner of the path
  ChainReport report_;
};

} // namespace nendo::deform
