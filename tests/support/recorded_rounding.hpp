#pragma once
// Says whether this machine can repeat, bit for bit, what another one has recorded.

#include <nendo/deform/simd.hpp>

namespace nendo::test {

/// The recordings in tests were made by a program of GCC 12 with 256-bit or 512-bit vectors, whose
/// fused products round once. Other compilers fuse other products, and other instruction sets none,
/// so their shapes differ in the last bits.
inline bool rounds_as_recorded() {
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ == 12
  const auto best = deform::simd_names().front();
  return best == "AVX2" || best == "AVX3";
#else
  return false;
#endif
}

} // namespace nendo::test
