#include "bench/plain_deformer.hpp"

namespace nendo::bench {

bool can_run_plain() noexcept {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return true;
#endif
}

PlainDeformer::Arrays::Arrays(const deform::Points& points)
    : x(static_cast<std::size_t>(points.cols())), y(x), z(x) {
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    x[at] = static_cast<float>(points(0, i));
    y[at] = static_cast<float>(points(1, i));
    z[at] = static_cast<float>(points(2, i));
  }
}

PlainDeformer::PlainDeformer(const deform::Points& mesh, const deform::Points& starts,
                             double radius)
    : starts_(starts), radii_(Eigen::VectorXd::Constant(starts.cols(), radius)), solver_({}),
      rest_(mesh), shape_(mesh), centres_(static_cast<std::size_t>(starts.cols())) {
  solver_.build(starts_, radii_);
}

void PlainDeformer::type1(const deform::Points& ends) {
  step_ = ends - starts_;
  displace(rest_, shape_);
}

void PlainDeformer::type2(const deform::Points& from, const deform::Points& to) {
  solver_.build(from, radii_);
  step_ = to - from;
  displace(shape_, shape_);
}

void PlainDeformer::displace(Arrays& from, Arrays& to) {
  solver_.solve(step_, field_);
  for (Eigen::Index i = 0; i < field_.centres.cols(); ++i) {
    const Eigen::Vector3f c = field_.centres.col(i).cast<float>();
    const Eigen::Vector3f a = (4.0 * field_.coefficients.col(i)).cast<float>();
    centres_[static_cast<std::size_t>(i)] = {
        c[0], c[1], c[2], static_cast<float>(1.0 / field_.radii[i]), a[0], a[1], a[2]};
  }
  plain_displace(centres_.data(), centres_.size(), from.view(), to.view(), from.x.size());
}

} // namespace nendo::bench
