#pragma once
// The option --hand-length, which sets the size of a wearer's skeleton.

#include <optional>

#include <nendo/base/result.hpp>
#include <nendo/hand/skeleton.hpp>

#include "cli/command.hpp"

namespace nendo::gloves {

struct HandLength {
  std::optional<double> length_mm; ///< nullopt: not given

  /// Fails with usage if no hand is that long.
  Result<void> check() const;
  /// Returns a hand of the length that was given, with the proportions of `known`. Without a
  /// length it returns `known`.
  hand::HandSize size(const hand::HandSize& known) const noexcept;
};

void add_hand_length(cli::Command& command, HandLength& length);

} // namespace nendo::gloves
