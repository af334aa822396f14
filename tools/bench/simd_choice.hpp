#pragma once
// The --simd option of the benchmarks of the deformation.

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/deform/simd.hpp>

#include "cli/command.hpp"

namespace nendo::bench {

inline void add_simd_option(cli::Command& command, std::string& name) {
  command.add_option("--simd", name,
                     "Vector instructions to use instead of the best: AVX3, AVX2, SSE4, ...");
}

/// Chooses the instruction set. An empty name means the best one. Error: usage, naming the
/// sets of this machine.
inline Result<void> choose_simd(const std::string& name) {
  if (deform::use_simd(name)) return {};
  std::string names;
  for (const auto each : deform::simd_names())
    names += " " + std::string(each);
  return Error{Errc::usage, "--simd " + name + ": this machine has" + names};
}

} // namespace nendo::bench
