#pragma once
// How a solver orders and stores its equations. It chooses by the number of start points; tests and
// benchmarks choose themselves, to compare the ways.

#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

/// The order in which start points are eliminated: as they are given, along an octree, or by
/// approximate minimum degree on top of the octree. Minimum degree fills the factor least but takes
/// longer to find. by_size takes the octree's order below 800 points.
enum class PointOrder { by_size, as_given, octree, minimum_degree };

/// How the matrix is stored. by_size stores it densely up to a hundred start points, and where most
/// of them meet.
enum class Storage { by_size, dense, sparse };

struct SolverChoices {
  PointOrder order = PointOrder::by_size;
  Storage storage = Storage::by_size;
};

/// Returns a solver with these choices.
NENDO_API CsrbfSolver solver_with(const CsrbfOptions& options, const SolverChoices& choices);

} // namespace nendo::deform
