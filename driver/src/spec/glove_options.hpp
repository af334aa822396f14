#pragma once
// What a user may say about a glove that the glove itself may not: its hand, and numbers out of a
// short list.

#include <initializer_list>
#include <optional>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// The option's number, or the first of `known` where the option is missing. Error: usage, naming
/// all of them.
Result<int> number_option(const GloveSpec& spec, std::string_view key,
                          std::initializer_list<int> known);

/// `hand=left|right`; empty if the option is missing. Error: usage.
Result<std::optional<Side>> hand_option(const GloveSpec& spec);

/// Whose word on the hand counts: the glove's own, else the option's, else the caller's wish, else
/// right.
struct HandWishes {
  std::optional<Side> option;
  std::optional<Side> wanted;
};
struct ChosenHand {
  Side side = Side::right;
  std::string_view source; ///< glove, option, caller or assumed
};
ChosenHand choose_hand(std::optional<Side> glove, const HandWishes& wishes) noexcept;

/// Error: usage, if `spec` names no port; `example` is one that does.
Result<void> require_port(const GloveSpec& spec, std::string_view example);

} // namespace nendo::driver
