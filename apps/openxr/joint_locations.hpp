#pragma once
// What xrLocateHandJointsEXT fills in, and the rules of XR_EXT_hand_tracking about it.

#include <openxr/openxr.h>

#include "openxr/hand_motion.hpp"
#include "openxr/loader_interface.hpp"
#include "openxr/segment_view.hpp"

namespace nendo::openxr {

/// Returns whether the arguments are valid: types, numbers of joints, arrays, and the chained
/// velocities and motion range.
bool is_valid(const XrHandJointsLocateInfoEXT* info,
              const XrHandJointLocationsEXT* locations) noexcept;

/// The state of the data source that the application chained, or null.
DataSourceState* source_state_of(XrHandJointLocationsEXT& locations) noexcept;

/// No joint and no velocity is valid then.
void set_inactive(XrHandJointLocationsEXT& locations) noexcept;

/// Fills in the joints of a hand in an application's space, in which `stage` and `velocity` are
/// Nendo's stage. Leaves `locations` inactive if the place of the stage is unknown. A velocity is
/// valid if those of the hand and of the stage are. Wait-free.
void set_joints(const MovingHand& hand, const PublishedHand& published,
                const XrSpaceLocation& stage, const XrSpaceVelocity& velocity,
                XrHandJointLocationsEXT& locations) noexcept;

} // namespace nendo::openxr
