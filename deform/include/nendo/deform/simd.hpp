#pragma once
// Selects the vector instructions that evaluate fields. By default, the best set of the processor
// is selected at run time.

#include <string_view>
#include <vector>

#include <nendo/base/api.hpp>

namespace nendo::deform {

/// Returns the instruction sets that this program contains and this processor can run, the best
/// first: "AVX3" (AVX-512), "AVX2", "SSE4", "SSE2", "NEON", "EMU128" (no vector instructions).
NENDO_API std::vector<std::string_view> simd_names();

/// Uses this instruction set from now on, or the best one if the name is empty. Returns false if it
/// is not one of simd_names(). It must not be called while another thread evaluates a field.
NENDO_API bool use_simd(std::string_view name);

} // namespace nendo::deform
