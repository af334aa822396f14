#pragma once
// What people ask of the masks and of symmetry while a run continues, as edits of the puppet that
// the loop has, which is mostly one without points.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/flow/command.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::session {

/// Returns the rig that the command makes of this one, which may be null: SetMask, or SetSymmetry
/// where no hand plays the rig. vertices: the model with which the loop began. Allocates. Error:
/// bad_input (there are too many masks).
Result<std::shared_ptr<const puppet::Rig>>
edited_masks(const flow::Command& command, const std::shared_ptr<const puppet::Rig>& rig,
             const deform::Points& vertices);

} // namespace nendo::session
