#pragma once
// Which instruction sets the vector code is compiled for. Left out: SSSE3, because few processors
// have that and not SSE4; vectors whose size is not known when compiling, because kernels keep
// arrays of them. The lowest of each architecture always stays.

// Without instructions that we know: one lane at a time. Highway's emulation of four takes Clang
// minutes to compile with sanitizers.
#define HWY_BROKEN_EMU128 1
#if defined(__aarch64__)
// NEON is all that is left there: nothing is to be chosen when running. Highway would otherwise
// compile for processors with AES, which a Raspberry Pi 4 has not, and GCC 12 does not carry such a
// choice into the constructors that it writes itself.
#define TOOLCHAIN_MISS_SYS_AUXV_H
#endif
#include <hwy/detect_targets.h>

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS                                                                       \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
