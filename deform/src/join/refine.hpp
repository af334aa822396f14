#pragma once
// Keeps the triangles of a surface fair while it changes: long edges are split, short ones are
// collapsed, and edges are flipped where that makes triangles fairer. Quasi-uniform sampling in the
// manner of Stanculescu, Chaine and Cani, "Freestyle: Sculpting meshes with self-adaptive
// topology", 2011.
//
// Points that no operation takes away keep their places bit for bit: a split adds a point in the
// middle of an edge, and a collapse lets one end go into the other. The same calls give the same
// bits.

#include <cstddef>
#include <vector>

#include "join/live_surface.hpp"

namespace nendo::deform {

struct RefineLimits {
  double longest = 0.0;     ///< an edge that is longer is split; > 0
  double shortest = 0.0;    ///< one that is shorter is collapsed; at most longest / 2
  double thin = 0.0;        ///< faces that are lower may fold: they say little of the shape
  double min_cosine = 0.5;  ///< the least cosine of the angle by which a collapse turns a face
  std::size_t budget = 500; ///< splits and collapses in one call
  std::size_t max_points = 4000000; ///< no splits beyond it
  bool only_splits = false;         ///< what never makes the surface meet itself
};

struct RefineCounts {
  std::size_t splits = 0, collapses = 0, flips = 0;
  std::size_t left = 0; ///< edges out of limits for which there was no budget
};

/// Which points may be worked at. The lists have one entry for each point of the surface, and grow
/// with it.
struct RefineZone {
  /// How coarse the surface may be at a point: edges there are looked at, and the limits of their
  /// lengths are multiplied by this; 0: they are not looked at. Of an edge's ends the lesser counts
  /// that is not 0. A new point has the mean of both, or 0 if one has.
  std::vector<float> coarseness;
  /// How firmly a point holds its place: 2 always, and of two at a short edge the one that holds
  /// less goes into the other. New points have 0.
  std::vector<char> hold;
  /// Where the surface has changed since all edges were looked at; empty: look at all. refine()
  /// sets it, so that its next call looks only there.
  std::vector<char> active{};
};

/// Returns how many edges in the zone are too long or too short, and may be worked at.
std::size_t unfit_edges(const LiveSurface& surface, const RefineZone& zone,
                        const RefineLimits& limits);

/// Goes once over the edges in the zone: splits, the longest first, then collapses, the shortest
/// first, then flips. Edges of the same length are taken in the order of their points. Call it
/// again until nothing was done, for edges that are several times too long. Allocates.
RefineCounts refine(LiveSurface& surface, RefineZone& zone, const RefineLimits& limits);

} // namespace nendo::deform
