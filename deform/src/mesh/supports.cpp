#include <nendo/deform/supports.hpp>

#include <algorithm>
#include <cassert>

#include <nendo/base/text.hpp>

#include "geometry/usable.hpp"

namespace nendo::deform {
namespace {

bool is_positive(double value) noexcept {
  return value > 0.0 && is_usable(value);
}

bool is_valid(const Support& support) noexcept {
  return is_positive(support.radius) && is_positive(support.weight);
}

/// Returns the radius that `choose` prefers to each of the others.
template <class Choose>
double chosen_radius(const Supports& supports, Choose choose) noexcept {
  double chosen = supports.shared.front().radius;
  for (const Support& support : supports.shared)
    chosen = choose(chosen, support.radius);
  for (const OwnSupport& own : supports.own)
    chosen = choose(chosen, own.support.radius);
  return chosen;
}

/// Expects `own` in its place. Own functions of the shared radius alone change nothing: with A the
/// shared matrix, A (w a + W A a) = M a = g, so their sum is A^-1 g whatever W is.
void share(Supports& supports, std::optional<Support> common) {
  auto& own = supports.own;
  assert(!own.empty());
  const auto radius = [](const OwnSupport& one) { return one.support.radius; };
  double least = radius(own.front());
  for (const OwnSupport& one : own)
    least = std::min(least, radius(one));
  const Support shared = common.value_or(Support{least, default_common_weight});
  const bool all_same = std::all_of(
      own.begin(), own.end(), [&](const OwnSupport& one) { return radius(one) == shared.radius; });
  supports.shared.assign(1, all_same ? Support{shared.radius, 1.0} : shared);
  if (all_same) own.clear();
}

} // namespace

double min_radius(const Supports& supports) noexcept {
  return chosen_radius(supports, [](double a, double b) { return std::min(a, b); });
}

double max_radius(const Supports& supports) noexcept {
  return chosen_radius(supports, [](double a, double b) { return std::max(a, b); });
}

Eigen::Index Supports::functions(Eigen::Index points) const noexcept {
  return points * static_cast<Eigen::Index>(shared.size()) + static_cast<Eigen::Index>(own.size());
}

bool Supports::are_usable() const noexcept {
  return std::all_of(shared.begin(), shared.end(), is_valid) &&
         std::all_of(own.begin(), own.end(),
                     [](const OwnSupport& one) { return is_valid(one.support); });
}

bool reach_all_of(const Box& box, const Points& starts, const Supports& supports) {
  const bool has_size = (box.lowest.array() < box.highest.array()).any();
  if (starts.cols() == 0 || !has_size) return false;
  double shared = 0.0;
  for (const Support& support : supports.shared)
    shared = std::max(shared, support.radius);
  Eigen::VectorXd reach = Eigen::VectorXd::Constant(starts.cols(), shared);
  for (const OwnSupport& own : supports.own)
    reach[own.point] = std::max(reach[own.point], own.support.radius);
  for (Eigen::Index at = 0; at < starts.cols(); ++at) {
    const Eigen::Vector3d start = starts.col(at);
    const auto farthest =
        (start - box.lowest).cwiseAbs().cwiseMax((start - box.highest).cwiseAbs());
    if (farthest.stableNorm() > reach[at]) return false;
  }
  return true;
}

Supports with_common(std::vector<OwnSupport> own, std::optional<Support> common) {
  Supports supports;
  supports.own = std::move(own);
  share(supports, common);
  return supports;
}

void assign_radii(Supports& out, const Eigen::VectorXd& radii) {
  if (radii.size() == 0) {
    out.shared.assign(1, Support{});
    out.own.clear();
    return;
  }
  out.own.resize(static_cast<std::size_t>(radii.size()));
  for (Eigen::Index i = 0; i < radii.size(); ++i)
    out.own[static_cast<std::size_t>(i)] = {i, {radii[i], 1.0}};
  share(out, {});
}

std::optional<std::vector<Support>> parse_supports(std::string_view text) {
  std::vector<Support> supports;
  for (bool more = true; more;) {
    more = text.find('+') != std::string_view::npos;
    const std::string_view part = cut(text, '+');
    const std::size_t colon = part.find(':');
    const auto radius = to_number(part.substr(0, colon));
    const auto weight =
        colon == std::string_view::npos ? std::optional(1.0) : to_number(part.substr(colon + 1));
    if (!radius || !weight || !is_valid({*radius, *weight})) return std::nullopt;
    supports.push_back({*radius, *weight});
  }
  return supports;
}

std::optional<Supports> parse_supports_by_point(std::string_view text, Eigen::Index points) {
  std::vector<std::vector<Support>> lists;
  for (bool more = true; more;) {
    more = text.find(',') != std::string_view::npos;
    auto list = parse_supports(cut(text, ','));
    if (!list) return std::nullopt;
    lists.push_back(std::move(*list));
  }
  if (lists.size() == 1) return Supports{std::move(lists.front()), {}};
  if (points <= 0 || points % static_cast<Eigen::Index>(lists.size()) != 0) return std::nullopt;
  std::vector<OwnSupport> own;
  for (Eigen::Index point = 0; point < points; ++point)
    for (const Support& support : lists[static_cast<std::size_t>(point) % lists.size()])
      own.push_back({point, support});
  return with_common(std::move(own));
}

} // namespace nendo::deform
