#pragma once
// What a compiler makes of the field's sum by itself: a plain loop over arrays, for comparison with
// the library's. Compiled for AVX2; ask the processor before calling.

#include <cstddef>

namespace nendo::bench {

struct PlainCentre {
  float x, y, z;
  float inverse_radius;
  float coefficient_x, coefficient_y, coefficient_z; ///< times 4
};

/// Coordinates apart.
struct PlainPoints {
  float* x;
  float* y;
  float* z;
};

/// to = from + s(from) by Wendland's C2 function, for all of `count` vertices, whether a support
/// reaches them or not. `to` may be `from`.
void plain_displace(const PlainCentre* centres, std::size_t centre_count, const PlainPoints& from,
                    const PlainPoints& to, std::size_t count) noexcept;

} // namespace nendo::bench
