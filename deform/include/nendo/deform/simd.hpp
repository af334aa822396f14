#pragma once
// Which vector instructions evaluate the field. The best that the processor has is chosen at run
// time.

#include <string_view>
#include <vector>

namespace nendo::deform {

/// What this program contains and this processor can run, the best first: "AVX3" (AVX-512), "AVX2",
/// "SSE4", "SSE2", "NEON", "EMU128" (none).
std::vector<std::string_view> simd_names();

/// Uses this one from now on, or the best for an empty name; false if it is not one of
/// simd_names(). For comparisons: not while another thread evaluates.
bool use_simd(std::string_view name);

} // namespace nendo::deform
