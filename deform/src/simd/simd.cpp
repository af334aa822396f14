#include <nendo/deform/simd.hpp>

#include "simd/targets.hpp"

#include <hwy/targets.h>

namespace nendo::deform {

std::vector<std::string_view> simd_names() {
  std::vector<std::string_view> names;
  for (const auto target : hwy::SupportedAndGeneratedTargets())
    names.emplace_back(hwy::TargetName(target));
  return names;
}

bool use_simd(std::string_view name) {
  hwy::SetSupportedTargetsForTest(0); // back to all
  if (name.empty()) return true;
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    if (name != hwy::TargetName(target)) continue;
    hwy::SetSupportedTargetsForTest(target);
    return true;
  }
  return false;
}

} // namespace nendo::deform
