#pragma once
// Settings as text, each by its name, as PROTOCOL.md has them in both directions. All of it is made
// from the description of the settings (flow/setting.hpp).

#include <cstdint>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/flow/loop_settings.hpp>

namespace nendo::web {

/// The settings that a client names. It does not change the others.
struct NamedSettings {
  flow::LoopSettings values;
  std::uint32_t named = 0; ///< bit k: the k-th setting of flow::for_each_setting()

  /// Gives these settings the values of those that are named.
  void apply_to(flow::LoopSettings& settings) const noexcept;

  friend bool operator==(const NamedSettings&, const NamedSettings&) = default;
};

/// Reads a text such as "mode=type2 radius_m=0.1,0.1,0.1,0.1,0.05", with single spaces between.
/// Allocates only for an error. Error: bad_input, naming the setting and what can be used.
Result<NamedSettings> parse_named_settings(std::string_view text);

/// Returns such a text, which has all settings. Allocates.
std::string text_of(const flow::LoopSettings& settings);

} // namespace nendo::web
