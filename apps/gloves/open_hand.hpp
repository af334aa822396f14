#pragma once
// A glove that was opened, and the ring that receives its samples. Commands that use hands begin
// with these.

#include <memory>
#include <optional>
#include <string>

#include <nendo/driver/open_glove.hpp>
#include <nendo/flow/placement.hpp>

#include "gloves/glove_calibration.hpp"
#include "gloves/hand_length.hpp"

namespace nendo::gloves {

/// A glove, the ring with its samples, and the first sample.
struct OpenHand {
  Side side = Side::right;
  std::unique_ptr<SampleRing> ring; ///< outlives the glove, whose thread writes to it
  std::unique_ptr<driver::Glove> glove;
  GloveSample first;
  hand::Wearer wearer; ///< set by calibrate()
  /// Where the forearm ends, if something other than the glove tells it.
  std::optional<Eigen::Isometry3d> T_stage_wrist{};
};

/// Opens the glove for that hand, and tells on standard error if it calls itself the other one.
/// Without `side`, opens it for the hand that it is. Each sample notifies `event_count`. Blocks and
/// fails as open_glove() does.
Result<OpenHand> open_hand(const std::string& spec, std::optional<Side> side = std::nullopt,
                           EventCount* event_count = nullptr,
                           const driver::GloveContext& context = {});

/// Does the same with a glove that is already open.
OpenHand hand_of(std::unique_ptr<driver::Glove> glove, std::optional<Side> side,
                 EventCount* event_count);

/// Takes the first sample of a started glove out of the ring. Blocks for 2 s at most. Errors:
/// no_device if no sample comes, failed if a stop signal comes.
Result<void> wait_for_first_sample(OpenHand& hand);

/// Sets `wearer`; the first sample must have come. Both hands get `length` if it is given. Blocks
/// and fails as find_wearer() does.
Result<void> calibrate(OpenHand& hand, const CalibrationOptions& options, const HandLength& length);

} // namespace nendo::gloves
