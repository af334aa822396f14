#pragma once
// A hand as the body that presses clay.

#include <span>

#include <nendo/deform/contact_part.hpp>
#include <nendo/hand/hand_body.hpp>

namespace nendo::flow {

/// Writes the parts of a hand in that pose, on the stage, into HandBody::part_count parts in model
/// units. Each part's surface goes with the joint that carries it. Wait-free, no allocation.
void contact_parts(hand::HandBody& body, const hand::HandPose& pose, double units_per_metre,
                   std::span<deform::ContactPart> parts) noexcept;

} // namespace nendo::flow
