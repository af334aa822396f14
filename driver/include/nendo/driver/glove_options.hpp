#pragma once
// For drivers, in this library and in programs: parsers of options in a GloveSpec, for properties
// that a glove may not report: its hand, and numbers and words from a short list.

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// Fails with the error `usage` if `spec` has an option that is not `known`. The message names the
/// option and all known ones.
NENDO_API Result<void> allow_options(const GloveSpec& spec,
                                     std::initializer_list<std::string_view> known);

/// Returns the option's number, or the first of `known` if the option is missing. Error: usage,
/// naming all of `known`.
NENDO_API Result<int> number_option(const GloveSpec& spec, std::string_view key,
                                    std::initializer_list<int> known);

/// Returns the option's word, or the first of `known` if the option is missing. Error: usage,
/// naming all of `known`. `known` must contain literals.
NENDO_API Result<std::string_view> word_option(const GloveSpec& spec, std::string_view key,
                                               std::initializer_list<std::string_view> known);

/// Returns the side of `hand=left|right`, or nullopt if the option is missing. Error: usage.
NENDO_API Result<std::optional<Side>> hand_option(const GloveSpec& spec);

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

/// Fails with the error `usage` if `spec` names no port. `example` is a specification that names
/// one.
NENDO_API Result<void> require_port(const GloveSpec& spec, std::string_view example);

} // namespace nendo::driver
