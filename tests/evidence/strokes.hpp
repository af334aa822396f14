#pragma once
// Violent random strokes, and what they make of points: at once, as the paper has it, and in
// injective chains.

#include <random>
#include <vector>

#include <nendo/deform/injective_chain.hpp>

namespace nendo::evidence {

/// Ten fingertips on vertices, a quarter of the radius from each other at least; each takes its own
/// random way.
struct Stroke {
  std::vector<deform::Points> way; ///< 3 by 10 each; Type-1 has two, start and end
  double radius = 0.0;
};

/// Each fingertip goes in any direction, evenly up to `longest` radii.
Stroke type1_stroke(std::mt19937& random, const deform::Points& vertices, double radius,
                    double longest);
/// As that, but curved: 24 samples, between which the directions turn at random.
Stroke type2_stroke(std::mt19937& random, const deform::Points& vertices, double radius,
                    double longest);

/// One field a sample of the way.
deform::Points at_once(const Stroke& stroke, deform::Points shape);

struct Followed {
  deform::Points shape;
  int links = 0;
  double min_determinant = 1.0; ///< at the vertices, of the whole stroke
  bool reached = true;          ///< all ways to their ends
  bool held = false;            ///< some pair was held at some time
};
Followed in_chains(const Stroke& stroke, const deform::Points& shape);

} // namespace nendo::evidence
