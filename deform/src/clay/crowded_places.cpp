#include "clay/crowded_places.hpp"

#include <algorithm>

#include "simd/contact_kernels.hpp"

namespace nendo::deform {

namespace {

constexpr float no_place = 1e18F; // its square is finite

} // namespace

CrowdedPlaces::CrowdedPlaces(std::size_t most) {
  for (auto& row : rows_)
    row.assign((most + place_lanes - 1) / place_lanes * place_lanes, no_place);
}

void CrowdedPlaces::clear() noexcept {
  for (auto& row : rows_)
    std::fill_n(row.begin(), count_, no_place);
  count_ = 0;
}

bool CrowdedPlaces::add(const Eigen::Vector3f& at, const Eigen::Vector3f& normal,
                        float squared) noexcept {
  const std::array<float, 6> place{at.x(), at.y(), at.z(), normal.x(), normal.y(), normal.z()};
  const PlaceRows rows{rows_[0].data(), rows_[1].data(), rows_[2].data(),
                       rows_[3].data(), rows_[4].data(), rows_[5].data()};
  if (is_crowded(rows, count_, place, squared)) return false;
  for (std::size_t row = 0; row < place.size(); ++row)
    rows_[row][count_] = place[row];
  ++count_;
  return true;
}

} // namespace nendo::deform
