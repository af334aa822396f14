#pragma once
// Gloves that drive hands: a glove, the ring that gets its samples, and the wearer's calibration.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/hand_input.hpp>
#include <nendo/sculpting/find_wearer.hpp>

namespace nendo::sculpting {

struct OpenHand {
  Side side = Side::right;          ///< the hand as which it shapes
  std::unique_ptr<SampleRing> ring; ///< outlives the glove, whose thread writes to it
  std::unique_ptr<driver::Glove> glove;
  GloveSample first;         ///< the first sample; set by wait_for_samples()
  hand::Wearer wearer;       ///< set by find_wearers()
  bool uncalibrated = false; ///< is_uncalibrated() of `wearer` and `first`
  /// The pose of the end of the forearm, if something other than the glove knows it.
  std::optional<Eigen::Isometry3d> T_stage_wrist{};
  std::shared_ptr<const flow::WristPath> wrist_path{}; ///< the same for a wrist that moves
};

/// Makes a hand of an open glove. Without `side`, it is the hand for which the glove is sewn. Notes
/// a glove that is sewn for the other hand. Each sample notifies `event_count`, which may be null
/// and must outlive the hand.
NENDO_API OpenHand hand_of(std::unique_ptr<driver::Glove> glove, std::optional<Side> side,
                           EventCount* event_count, const Note& note);

using OpenNamed = std::function<Result<OpenHand>(const std::string& glove, Side side)>;

/// Opens the gloves that this machine has, one for each of these hands, by `open`. A glove that is
/// there but may not be used is an error. If one does not answer, a note says so, and the other
/// hand continues alone. Without any glove the hands are simulated as `simulated` says, and a note
/// says so. Blocks for some seconds. Errors: those of `open`.
NENDO_API Result<std::vector<OpenHand>> open_found(std::span<const Side> sides,
                                                   const std::string& simulated,
                                                   const OpenNamed& open, const Note& note);

/// Starts the gloves. Blocks and fails as Glove::start() does.
NENDO_API Result<void> start(std::span<OpenHand> hands);

/// Starts again the gloves whose time begins when they are started, which are simulated ones and
/// recordings: so they do nothing while a run gets ready. What they sent before is dropped. No
/// other thread may read their rings meanwhile. Blocks as Glove::stop() does, and fails as
/// Glove::start() does.
NENDO_API Result<void> begin_again(std::span<OpenHand> hands);

/// Returns whether all gloves have sent all that they ever will (Glove::has_ended()), so that who
/// waits for more waits for ever. What they sent is in their rings then, or has been taken out.
/// Thread-safe.
NENDO_API bool have_ended(std::span<const OpenHand> hands) noexcept;

/// Takes the first sample of each started glove out of its ring. Waits for a sample for 2 s, or
/// longer if its rate is low or unknown, or until `is_stopped`, if given, returns true. Errors:
/// no_device (no sample comes), failed (stopped).
NENDO_API Result<void> wait_for_samples(std::span<OpenHand> hands,
                                        const std::function<bool()>& is_stopped = {});

/// Finds the wearer of each hand, for the side of its first sample. Blocks. Errors: those
/// of find_wearer().
NENDO_API Result<void> find_wearers(std::span<OpenHand> hands, const CalibrationOptions& options,
                                    const Note& note);

} // namespace nendo::sculpting
