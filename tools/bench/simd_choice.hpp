#pragma once
// The --simd option of the deformation's benches.

#include <string>

#include <nendo/base/result.hpp>
#include <nendo/deform/simd.hpp>

namespace nendo::bench {

/// Chooses the instruction set. An empty name means the best one. Error: usage, naming those that
/// this machine has.
inline Result<void> choose_simd(const std::string& name) {
  if (deform::use_simd(name)) return {};
  std::string names;
  for (const auto each : deform::simd_names())
    names += " " + std::string(each);
  return Error{Errc::usage, "--simd " + name + ": this machine has" + names};
}

} // namespace nendo::bench
