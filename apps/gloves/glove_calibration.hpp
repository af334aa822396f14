#pragma once
// Which calibration the glove at hand gets: the one that is asked for, the stored one, the default,
// or what is learned while the glove is used.

#include <optional>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/hand/active_calibration.hpp>
#include <nendo/hand/skeleton.hpp>

#include "cli/command.hpp"

namespace nendo::gloves {

struct CalibrationOptions {
  std::string user;        ///< empty: whoever
  std::string calibration; ///< a NAME of `nendo calibration`, or "none"; empty: what is stored
  bool adapt = false;      ///< learn the wearer's ranges instead
};

/// A wearer's hand, as far as it is known; otherwise an average one.
struct KnownHand {
  hand::Calibration calibration;
  hand::HandSize size;
};

/// For the glove at hand, and for one of the other side in its place.
struct KnownHands {
  Side side = Side::right; ///< of `own`
  KnownHand own;
  KnownHand swapped;
  std::optional<CountScale> adapt; ///< ranges are to be learned of a glove with such counts

  const KnownHand& of(Side wanted) const noexcept { return wanted == side ? own : swapped; }
  const KnownHand& not_of(Side side_now) const noexcept { return side_now == side ? swapped : own; }
  hand::ActiveCalibration in_force() const noexcept {
    if (adapt) return hand::ActiveCalibration(*adapt);
    return {side, own.calibration, swapped.calibration};
  }
};

/// The serial number that the glove tells; empty: none.
std::string serial_of(const driver::GloveInfo& glove);

/// --user, --calibration and --adapt.
void add_calibration_options(cli::Command& command, CalibrationOptions& options);

/// Error: usage, if they contradict each other. To be asked before a glove is opened.
Result<void> check(const CalibrationOptions& options);

/// `own` is for the hand that the glove is sewn for, `side`. Says in one line on standard error
/// which file it is; a simulated glove gets a stored one only if it is asked for, a
/// replayed one has that with which it was recorded. `swapped` is
/// chosen without a word: a stored one, or the default. Blocks. Errors: bad_input (no such, another
/// hand's, not readable), usage.
Result<KnownHands> known_hands(const driver::GloveInfo& glove, Side side,
                               const CalibrationOptions& options);

} // namespace nendo::gloves
