#include "field/block_order.hpp"

#include <algorithm>
#include <tuple>

#include <nendo/deform/vertex_blocks.hpp>

#include "simd/field_kernels.hpp"

namespace nendo::deform {

namespace {

/// Enough of a place to choose neighbours by, which is not to be fetched from afar.
struct Place {
  Eigen::Vector3f at;
  std::uint32_t index;
};
using Places = std::vector<Place>::iterator;

/// In shares of the model's largest side: numbers that float holds.
std::vector<Place> places_of(const Points& points) {
  const auto [lowest, highest] = finite_box_of(points);
  const double half = (highest / 2.0 - lowest / 2.0).maxCoeff();
  std::vector<Place> places;
  places.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Place place{Eigen::Vector3f::Zero(), static_cast<std::uint32_t>(i)};
    if (half > 0.0) place.at = ((points.col(i) / 2.0 - lowest / 2.0) / half).cast<float>();
    places.push_back(place);
  }
  return places;
}

Eigen::Index longest_side(Places begin, Places end) noexcept {
  Eigen::Vector3f low = begin->at;
  Eigen::Vector3f high = low;
  for (Places place = begin; place != end; ++place) {
    low = low.cwiseMin(place->at);
    high = high.cwiseMax(place->at);
  }
  Eigen::Index longest = 0;
  (high - low).maxCoeff(&longest);
  return longest;
}

/// Half of the blocks, in whole groups of those that are asked for together while there are
/// several.
std::size_t left_blocks(std::size_t blocks) noexcept {
  if (blocks < 2 * group_size) return blocks / 2;
  return (blocks / 2 + group_size / 2) / group_size * group_size;
}

void halve(Places begin, Places end) {
  const auto count = static_cast<std::size_t>(end - begin);
  if (count <= block_size) {
    std::sort(begin, end, [](const Place& a, const Place& b) { return a.index < b.index; });
    return;
  }
  const Eigen::Index axis = longest_side(begin, end);
  const std::size_t left = left_blocks(block_count_of(count)) * block_size;
  const Places middle = begin + static_cast<std::ptrdiff_t>(left);
  // Equal coordinates by their indices: so the order is the same with every library.
  std::nth_element(begin, middle, end, [axis](const Place& a, const Place& b) {
    return std::tie(a.at[axis], a.index) < std::tie(b.at[axis], b.index);
  });
  halve(begin, middle);
  halve(middle, end);
}

} // namespace

std::vector<std::uint32_t> block_order(const Points& points) {
  std::vector<Place> places = places_of(points);
  const Places finite =
      std::stable_partition(places.begin(), places.end(), [&points](const Place& place) {
        return points.col(place.index).allFinite();
      });
  halve(places.begin(), finite);
  std::vector<std::uint32_t> order;
  order.reserve(places.size());
  for (const Place& place : places)
    order.push_back(place.index);
  return order;
}

} // namespace nendo::deform
