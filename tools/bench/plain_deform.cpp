#include "bench/plain_deform.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::bench {

namespace {

/// Sums of so many vertices stay in the first cache while the centres pass over them.
constexpr std::size_t tile = 256;

struct Sums {
  float x[tile], y[tile], z[tile];
};

void add_centre(const PlainCentre& centre, const PlainPoints& from, std::size_t begin,
                std::size_t size, Sums& sums) noexcept {
  const float* const x = from.x + begin;
  const float* const y = from.y + begin;
  const float* const z = from.z + begin;
  for (std::size_t n = 0; n < size; ++n) {
    const float dx = x[n] - centre.x;
    const float dy = y[n] - centre.y;
    const float dz = z[n] - centre.z;
    const float t = std::sqrt(dx * dx + dy * dy + dz * dz) * centre.inverse_radius;
    const float o = std::max(0.0F, 1.0F - t);
    const float w = o * o * (o * o) * (1.25F - o);
    sums.x[n] += w * centre.coefficient_x;
    sums.y[n] += w * centre.coefficient_y;
    sums.z[n] += w * centre.coefficient_z;
  }
}

} // namespace

void plain_displace(const PlainCentre* centres, std::size_t centre_count, const PlainPoints& from,
                    const PlainPoints& to, std::size_t count) noexcept {
  for (std::size_t begin = 0; begin < count; begin += tile) {
    const std::size_t size = std::min(tile, count - begin);
    Sums sums{};
    for (std::size_t c = 0; c < centre_count; ++c)
      add_centre(centres[c], from, begin, size, sums);
    for (std::size_t n = 0; n < size; ++n) {
      to.x[begin + n] = from.x[begin + n] + sums.x[n];
      to.y[begin + n] = from.y[begin + n] + sums.y[n];
      to.z[begin + n] = from.z[begin + n] + sums.z[n];
    }
  }
}

} // namespace nendo::bench
