#pragma once
// Looks up what a glove says of itself.

#include <algorithm>
#include <string>
#include <string_view>

#include <nendo/driver/glove.hpp>

namespace nendo::test {

/// Returns a fact's value, or an empty text if the glove does not have that fact.
inline std::string fact(const driver::GloveInfo& info, std::string_view name) {
  const auto found =
      std::find_if(info.facts.begin(), info.facts.end(),
                   [&](const driver::DeviceFact& entry) { return entry.name == name; });
  return found == info.facts.end() ? "" : found->value;
}

} // namespace nendo::test
