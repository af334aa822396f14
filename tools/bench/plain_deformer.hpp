#pragma once
// Both types of deformation by the plain loop (plain_deform.hpp). The equations are solved as the
// deformers do it.

#include <array>
#include <vector>

#include <nendo/deform/csrbf.hpp>

#include "bench/deform_frames.hpp"
#include "bench/plain_deform.hpp"

namespace nendo::bench {

/// Returns true if the processor has the instructions for which the plain loop is compiled.
bool can_run_plain() noexcept;

class PlainDeformer {
public:
  PlainDeformer(const deform::Points& mesh, const deform::Points& starts, double radius);

  void type1(const deform::Points& ends);
  void type2(const deform::Points& from, const deform::Points& to);
  /// Makes the n-th stroke of Type-2, there and back as Strokes makes them.
  void stroke(const std::array<deform::Points, poses>& ends, std::size_t n) {
    const deform::Points& end = ends[n / 2 % poses];
    n % 2 == 0 ? type2(starts_, end) : type2(end, starts_);
  }

private:
  struct Arrays {
    explicit Arrays(const deform::Points& points);
    PlainPoints view() noexcept { return {x.data(), y.data(), z.data()}; }

    std::vector<float> x, y, z;
  };

  void displace(Arrays& from, Arrays& to);

  deform::Points starts_, step_;
  Eigen::VectorXd radii_;
  deform::CsrbfSolver solver_;
  deform::CsrbfField field_;
  Arrays rest_, shape_;
  std::vector<PlainCentre> centres_;
};

} // namespace nendo::bench
