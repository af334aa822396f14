#pragma once
// For drivers of gloves, in this library and in programs: the option for the hand, which a glove
// may not report.

#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>
#include <nendo/driver/device_spec.hpp>

namespace nendo::driver {

/// Returns the side of `hand=left|right`, or nullopt if the option is missing. Error: usage.
NENDO_API Result<std::optional<Side>> hand_option(const DeviceSpec& spec);

/// Inputs of choose_hand(): it takes the option's side, else the glove's, else the wanted side,
/// else right.
struct SideOptions {
  std::optional<Side> option;
  std::optional<Side> wanted;
};
struct ChosenHand {
  Side side = Side::right;
  std::string_view source; ///< glove, option, caller or assumed
};
NENDO_API ChosenHand choose_hand(std::optional<Side> glove, const SideOptions& wishes) noexcept;

/// Returns a message for the user if the option contradicts the glove, else an empty string.
NENDO_API std::string hand_override(std::optional<Side> glove, const SideOptions& wishes);

} // namespace nendo::driver
