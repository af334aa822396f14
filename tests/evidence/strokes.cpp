#include "evidence/strokes.hpp"

#include <utility>

namespace nendo::evidence {

using deform::Points;

namespace {

constexpr Eigen::Index fingertips = 10;
constexpr double min_distance = 0.25; // of the radius, between fingertips when they grab

Eigen::Vector3d direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

Points random_vertices(std::mt19937& random, const Points& vertices, double radius) {
  std::uniform_int_distribution<Eigen::Index> pick(0, vertices.cols() - 1);
  Points tips(3, fingertips);
  for (Eigen::Index i = 0; i < fingertips;) {
    tips.col(i) = vertices.col(pick(random));
    const auto distances = (tips.leftCols(i).colwise() - tips.col(i)).colwise().norm();
    if (i == 0 || distances.minCoeff() >= min_distance * radius) ++i;
  }
  return tips;
}

} // namespace

Stroke type1_stroke(std::mt19937& random, const Points& vertices, double radius, double longest) {
  std::uniform_real_distribution<double> length(0.0, longest * radius);
  const Points starts = random_vertices(random, vertices, radius);
  Points ends = starts;
  for (Eigen::Index i = 0; i < fingertips; ++i)
    ends.col(i) += length(random) * direction(random);
  return {{starts, ends}, radius};
}

Stroke type2_stroke(std::mt19937& random, const Points& vertices, double radius, double longest) {
  constexpr int samples = 24;
  std::uniform_real_distribution<double> length(0.0, longest * radius / samples);
  Points tips = random_vertices(random, vertices, radius);
  Points headings(3, fingertips);
  Eigen::VectorXd steps(fingertips);
  for (Eigen::Index i = 0; i < fingertips; ++i) {
    headings.col(i) = direction(random);
    steps[i] = length(random);
  }
  Stroke stroke{{tips}, radius};
  for (int sample = 0; sample < samples; ++sample) {
    for (Eigen::Index i = 0; i < fingertips; ++i) {
      headings.col(i) = (headings.col(i) + 0.4 * direction(random)).normalized();
      tips.col(i) += steps[i] * headings.col(i);
    }
    stroke.way.push_back(tips);
  }
  return stroke;
}

Points at_once(const Stroke& stroke, Points shape) {
  deform::CsrbfSolver solver({});
  deform::CsrbfField field;
  const Eigen::VectorXd radii = Eigen::VectorXd::Constant(fingertips, stroke.radius);
  for (std::size_t k = 1; k < stroke.way.size(); ++k) {
    if (!is_solved(solver.build(stroke.way[k - 1], radii))) continue;
    if (!is_solved(solver.solve(stroke.way[k] - stroke.way[k - 1], field))) continue;
    displace(field, shape, shape);
  }
  return shape;
}

Followed in_chains(const Stroke& stroke, const Points& shape) {
  deform::InjectiveChain chain(fingertips, deform::one_radius(stroke.radius), {}, {});
  Followed followed{.shape = shape};
  deform::DeterminantProbe probe;
  probe.start(shape);
  chain.grab(stroke.way.front());
  for (std::size_t k = 1; k < stroke.way.size(); ++k) {
    chain.from_here(stroke.way[k]); // with two places the same as from_start()
    while (chain.next()) {
      probe.advance(chain.field());
      displace(chain.field(), followed.shape, followed.shape);
    }
    followed.links += chain.report().links;
    followed.reached = chain.report().reached;
    followed.held = followed.held || chain.report().held_pairs > 0;
  }
  followed.min_determinant = probe.min_determinant();
  return followed;
}

} // namespace nendo::evidence
