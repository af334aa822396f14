#pragma once
// The kernel sum_s w_s psi(d / r_s) that all start points share.

#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

/// Returns the square of a distance, or a little more because of rounding. It serves to compare
/// squared distances before their roots are taken.
constexpr double squared_or_more(double distance) noexcept {
  return distance * distance * (1.0 + 1e-12);
}

class SharedKernel {
public:
  SharedKernel(Wendland kernel, const Supports& supports) noexcept
      : kernel_(kernel), first_(supports.shared.front()), supports_(&supports.shared) {
    for (const Support& support : supports.shared)
      reach_ = support.radius > reach_ ? support.radius : reach_;
  }

  double at(double distance) const noexcept {
    double sum = first_.weight * wendland(kernel_, distance / first_.radius);
    for (std::size_t s = 1; s < supports_->size(); ++s) {
      const Support& support = (*supports_)[s];
      sum += support.weight * wendland(kernel_, distance / support.radius);
    }
    return sum;
  }
  /// Returns the distance from which on the kernel is 0.
  double reach() const noexcept { return reach_; }

private:
  Wendland kernel_;
  Support first_;
  const std::vector<Support>* supports_;
  double reach_ = 0.0;
};

} // namespace nendo::deform
