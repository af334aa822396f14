#pragma once
// Opens gloves for the commands that use hands: a stop signal ends the opening, and notes go to
// standard error.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/open_tracker.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/sculpting/find_wearer.hpp>
#include <nendo/sculpting/open_hand.hpp>

#include "cli/command.hpp"
#include "motions/planned_hand.hpp"

namespace nendo::gloves {

using sculpting::CalibrationOptions;
using sculpting::WristOptions;

/// Adds the options --user, --calibration and --adapt; for commands that take two gloves also
/// --left-user and --right-user.
void add_calibration_options(cli::Command& command, CalibrationOptions& options, bool two_gloves);

/// Fails with usage if the options contradict each other. Call it before a glove is opened.
Result<void> check(const CalibrationOptions& options);

/// Adds the options --left-wrist, --right-wrist and --wrist-scale.
void add_wrist_options(cli::Command& command, WristOptions& options);
/// Checks the scale. Error: usage.
Result<void> check(const WristOptions& options);
/// Returns the drivers of trackers: the library's, and recordings.
std::vector<driver::TrackerDriver> tracker_drivers();

struct HandLength {
  std::optional<double> length_mm; ///< nullopt: not given

  Result<void> check() const;
  /// Returns a hand of the length that was given, with the proportions of `known`. Without a
  /// length it returns `known`.
  hand::HandSize size(const hand::HandSize& known) const noexcept;
};
void add_hand_length(cli::Command& command, HandLength& length);

using sculpting::begin_again;
using sculpting::have_ended;
using sculpting::OpenHand;
using sculpting::start;
using sculpting::stop;

/// Returns what the program adds to the driver's gloves: recordings, and what simulated hands do to
/// a model (motions::planned_motions()).
driver::GloveContext glove_context(motions::PlannedHand* planned = nullptr);

/// Opens a glove as driver::open_glove() does with glove_context(), for a command that a stop
/// signal ends. From then on these signals set a flag (cli::stop_requested()). If one comes while
/// ports are probed, that is the error: failed, "interrupted".
Result<std::unique_ptr<driver::Glove>> open_glove(const std::string& spec,
                                                  std::optional<Side> side = std::nullopt,
                                                  motions::PlannedHand* planned = nullptr);

/// Opens the glove for that hand, and says on standard error if it calls itself the other one.
/// Without `side`, opens it for the hand that it is. Each sample notifies `event_count`. Blocks and
/// fails as open_glove() does.
Result<OpenHand> open_hand(const std::string& spec, std::optional<Side> side = std::nullopt,
                           EventCount* event_count = nullptr,
                           motions::PlannedHand* planned = nullptr);

/// Opens the trackers that move these hands' wrists, as sculpting::open_wrists() does, also from
/// recordings. If a stop signal comes meanwhile, that is the error: failed, "interrupted".
Result<void> open_wrists(std::span<OpenHand> hands, const WristOptions& options);

/// Returns the error that two gloves are of the same hand, with the name by which one of them would
/// be the other hand's.
Error same_hand(const OpenHand& one, const OpenHand& other);

/// Waits for the first samples (sculpting::wait_for_samples()), and finds the wearers. Both hands
/// of a wearer get `length` if it is given. Errors: those of these two, failed if a stop signal
/// comes.
Result<void> calibrate(std::span<OpenHand> hands, const CalibrationOptions& options,
                       const HandLength& length);

} // namespace nendo::gloves
