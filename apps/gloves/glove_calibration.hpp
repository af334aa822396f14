#pragma once
// The options by which a command chooses the calibration of a glove and the size of the hand.

#include <optional>

#include <nendo/base/result.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/sculpting/find_wearer.hpp>

#include "cli/command.hpp"

namespace nendo::gloves {

using sculpting::CalibrationOptions;

/// Adds the options --user, --calibration and --adapt; for commands that take two gloves also
/// --left-user and --right-user.
void add_calibration_options(cli::Command& command, CalibrationOptions& options, bool two_gloves);

/// Fails with usage if the options contradict each other. Call it before a glove is opened.
Result<void> check(const CalibrationOptions& options);

/// The option --hand-length, which sets the size of a wearer's skeleton.
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
