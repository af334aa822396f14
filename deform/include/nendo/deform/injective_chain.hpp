#pragma once
// Deforming without folding (the fourth item of the paper's outlook): the straight way of the start
// points is cut into links. Each link is a field with its centres where the points then are, and so
// short that x -> x + s(x) is a homeomorphism; the chain of links is one. Where paths cross,
// no link would be short enough, so those points are held apart (LeastGap).

#include <array>
#include <memory>
#include <span>

#include <nendo/base/api.hpp>
#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/jacobian.hpp>

namespace nendo::deform {

class LeastGap;

/// Two fingertips separated by a wall, because their paths cross.
struct HeldPair {
  Eigen::Index first = 0; ///< column of the fingertip on the wall's upper side; less than `second`
  Eigen::Index second = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< unit length, from the second to the first
  double gap = 0.0;                                 ///< along the normal, in model units
  double push = 0.0; ///< how far each is kept from its wanted place, in model units
};

struct InjectiveOptions {
  double max_bound = 0.9; ///< largest Lipschitz bound of a link; below 1
  int max_links = 64;     ///< limit for one call
  double min_gap = 0.05;  ///< in least radii of a point; 0 lets points come as near as they like
};

struct ChainReport {
  FieldStatus status = FieldStatus::ok;
  int links = 0;                ///< how many links were made
  double whole_bound = 0.0;     ///< Lipschitz bound of the first link's field, had it not been cut
  double bound = 0.0;           ///< the largest of the links'
  double min_determinant = 1.0; ///< the chain's, round the points; see DeterminantProbe
  int held_pairs = 0;           ///< pairs that are kept from their wanted places
  bool reached = true;          ///< false if `max_links` were not enough for the whole way
};

/// Call one of the two ways of going, then apply field() to the shape as long as next() is true:
///   for (chain.from_start(ends); chain.next();) displace(chain.field(), shape, shape);
/// After the constructor nothing allocates, locks or calls the system, up to CsrbfSolver::lean_size
/// points; next() then takes a bounded time.
class NENDO_API InjectiveChain {
public:
  InjectiveChain(Eigen::Index points, Supports supports, CsrbfOptions csrbf,
                 InjectiveOptions options);
  ~InjectiveChain();
  InjectiveChain(InjectiveChain&&) noexcept;
  InjectiveChain& operator=(InjectiveChain&&) noexcept;

  /// Freezes the start points (3 by points). On failure, the last good ones stay.
  FieldStatus grab(const Points& starts);
  /// Type-1: goes from the start points straight to `ends` (3 by points). The links are for the
  /// rest shape and depend on nothing else. If an end is not finite, the chain goes where it went
  /// last.
  FieldStatus from_start(const Points& ends) noexcept;
  /// Type-2: continues from where the chain has come to, with the existing walls, in at most
  /// `max_links` links. The links are for the shape as it is now. If an end is not finite, no link
  /// follows.
  FieldStatus from_here(const Points& ends, int max_links) noexcept;
  FieldStatus from_here(const Points& ends) noexcept { return from_here(ends, options_.max_links); }

  /// Makes the next link's field. Returns false if there is none; the report is then complete.
  bool next() noexcept;

  /// Returns the solver that is built for the start points. To solve with it does not disturb the
  /// chain.
  CsrbfSolver& start_solver() noexcept { return solvers_[kept_]; }
  /// Returns the field of the link made last.
  const CsrbfField& field() const noexcept { return field_; }
  const ChainReport& report() const noexcept { return report_; }
  /// Returns where the chain has come to. Points that are held are not at their wanted places.
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
  std::size_t kept_ = 0;               ///< which is the start points'
  bool grabbed_ = false;
  bool at_start_ = false; ///< places_ are the start points
  bool ended_ = true;
  int max_links_ = 0;
  Points starts_;
  Eigen::VectorXd radii_; ///< the least at each point
  Points places_;
  Points wanted_;  ///< the ends that were asked for
  Points allowed_; ///< and those that the walls permit
  Points step_;
  Points tips_; ///< where the link leads that is being made
  double link_bound_ = 0.0;
  std::unique_ptr<LeastGap> gaps_;
  DeterminantProbe probe_;
  CsrbfField field_;
  CsrbfField piece_; ///< up to the next corner of the way
  ChainReport report_;
};

} // namespace nendo::deform
