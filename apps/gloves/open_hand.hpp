#pragma once
// A glove that was opened, and the ring in which its samples come: what the commands that use hands
// begin with.

#include <memory>
#include <optional>
#include <string>

#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/placement.hpp>

#include "gloves/glove_calibration.hpp"
#include "gloves/hand_length.hpp"

namespace nendo::gloves {

/// A glove, its samples on their way to who uses them, and the first of them.
struct OpenHand {
  Side side = Side::right;
  std::unique_ptr<SampleRing> ring; ///< outlives the glove, whose thread writes to it
  std::unique_ptr<driver::Glove> glove;
  GloveSample first;
  hand::Wearer wearer; ///< set by calibrate()
  /// Where the forearm ends, if something else than the glove tells it.
  std::optional<Eigen::Isometry3d> T_stage_wrist{};
};

/// Opens the glove for that hand, and says so on standard error if it calls itself the other one;
/// without `side`, for the hand that it is. each sample notifies `event_count`. Blocks and fails as
/// open_glove().
Result<OpenHand> open_hand(const std::string& spec, std::optional<Side> side = std::nullopt,
                           EventCount* event_count = nullptr,
                           const driver::GloveContext& context = {});

/// The same of a glove that is open already.
OpenHand hand_of(std::unique_ptr<driver::Glove> glove, std::optional<Side> side,
                 EventCount* event_count);

/// Takes the first sample of a started glove out of the ring. Blocks, 2 s at most. Errors:
/// no_device if none comes, failed if a stop signal does.
Result<void> wait_for_first_sample(OpenHand& hand);

/// Sets `wearer`, once the first sample has come; both hands get `length` if it is given. Blocks
/// and fails as find_wearer().
Result<void> calibrate(OpenHand& hand, const CalibrationOptions& options, const HandLength& length);

} // namespace nendo::gloves
