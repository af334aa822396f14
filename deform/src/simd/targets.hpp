#pragma once
// Chooses the instruction sets for which the vector code is compiled. SSSE3 is left out, because
// few processors have it without SSE4. Vectors of a size unknown at compile time are left out,
// because kernels keep arrays of vectors. The lowest set of each architecture always stays.

// Without known vector instructions, the code uses one lane at a time, because Clang takes minutes
// to compile Highway's emulation of four lanes with sanitizers.
#define HWY_BROKEN_EMU128 1
#if defined(__aarch64__)
// Only NEON is left there, so nothing is chosen at run time. Otherwise Highway would compile for
// processors with AES, which a Raspberry Pi 4 has not, and GCC 12 does not apply such a choice to
// the constructors that it generates.
#define TOOLCHAIN_MISS_SYS_AUXV_H
#endif
#include <hwy/detect_targets.h>

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS                                                                       \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
