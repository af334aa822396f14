#pragma once
// The field's sum as a plain loop over arrays, which the compiler vectorises by itself. It is
// compared with the library's code. It is compiled for AVX2: check can_run_plain() before calling
// it.

#include <cstddef>

namespace nendo::bench {

struct PlainCentre {
  float x, y, z;
  float inverse_radius;
  float coefficient_x, coefficient_y, coefficient_z; ///< times 4
};

/// Points as separate arrays of coordinates.
struct PlainPoints {
  float* x;
  float* y;
  float* z;
};

/// Computes to = from + s(from) by Wendland's C2 function for all `count` vertices, also for those
/// that no support reaches. `to` may be `from`.
void plain_displace(const PlainCentre* centres, std::size_t centre_count, const PlainPoints& from,
                    const PlainPoints& to, std::size_t count) noexcept;

} // namespace nendo::bench
