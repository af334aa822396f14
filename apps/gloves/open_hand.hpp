#pragma once
// Opens gloves for the commands that use hands. An open hand is a glove and the ring that receives
// its samples.

#include <memory>
#include <optional>
#include <span>
#include <string>

#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/wrist_path.hpp>

#include "gloves/glove_calibration.hpp"
#include "motions/planned_hand.hpp"

namespace nendo::gloves {

struct OpenHand {
  Side side = Side::right;          ///< the hand as which it shapes
  std::unique_ptr<SampleRing> ring; ///< outlives the glove, whose thread writes to it
  std::unique_ptr<driver::Glove> glove;
  GloveSample first;         ///< the first sample; set by calibrate()
  hand::Wearer wearer;       ///< set by calibrate()
  bool uncalibrated = false; ///< is_uncalibrated() of `wearer` and `first`; set by calibrate()
  /// The pose of the end of the forearm, if something other than the glove knows it.
  std::optional<Eigen::Isometry3d> T_stage_wrist{};
  std::shared_ptr<const flow::WristPath> wrist_path{}; ///< likewise, of a wrist that moves
};

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

/// Does the same with a glove that is already open.
OpenHand hand_of(std::unique_ptr<driver::Glove> glove, std::optional<Side> side,
                 EventCount* event_count);

/// Returns the error that two gloves are of the same hand, with the name by which one of them would
/// be the other hand's.
Error same_hand(const OpenHand& one, const OpenHand& other);

/// Starts the gloves. Blocks and fails as Glove::start() does.
Result<void> start(std::span<OpenHand> hands);

/// Begins anew with the gloves whose time begins when they are started, which are simulated ones
/// and recordings: so they do nothing while a run gets ready. What they sent before is thrown away.
/// Nobody else may read their rings meanwhile. Blocks as Glove::stop() does,
/// and fails as Glove::start() does.
Result<void> begin_again(std::span<OpenHand> hands);

/// Returns whether all gloves have sent all that they ever will (Glove::has_ended()), so that who
/// waits for more waits for ever. What they sent is in their rings then, or has been taken out.
bool have_ended(std::span<const OpenHand> hands) noexcept;

/// Takes the first sample of each started glove out of its ring, and finds the wearer. Both hands
/// of the wearer get `length` if it is given. Waits for a sample for 2 s, or longer if its rate is
/// low or unknown. Errors: no_device
/// if no sample comes, failed if a stop signal comes, and those of find_wearer().
Result<void> calibrate(std::span<OpenHand> hands, const CalibrationOptions& options,
                       const HandLength& length);

} // namespace nendo::gloves
