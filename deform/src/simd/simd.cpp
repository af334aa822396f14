#include <nendo/deform/simd.hpp>

#include <cstdint>

#include "simd/targets.hpp"

#include <hwy/targets.h>

namespace nendo::deform {
namespace {

/// Where only one is compiled, that is used: Highway is not asked, which on arm64 knows no
/// processor without AES.
std::vector<std::int64_t> usable_targets() {
  if constexpr (HWY_TARGETS == HWY_STATIC_TARGET) return {HWY_STATIC_TARGET};
  return hwy::SupportedAndGeneratedTargets();
}

} // namespace

std::vector<std::string_view> simd_names() {
  std::vector<std::string_view> names;
  for (const auto target : usable_targets())
    names.emplace_back(hwy::TargetName(target));
  return names;
}

bool use_simd(std::string_view name) {
  if constexpr (HWY_TARGETS != HWY_STATIC_TARGET) hwy::SetSupportedTargetsForTest(0); // back to all
  if (name.empty()) return true;
  for (const auto target : usable_targets()) {
    if (name != hwy::TargetName(target)) continue;
    if constexpr (HWY_TARGETS != HWY_STATIC_TARGET) hwy::SetSupportedTargetsForTest(target);
    return true;
  }
  return false;
}

} // namespace nendo::deform
