#include <nendo/flow/hand_contact.hpp>

#include <cassert>

namespace nendo::flow {

void contact_parts(hand::HandBody& body, const hand::HandPose& pose, double units_per_metre,
                   std::span<deform::ContactPart> parts) noexcept {
  assert(parts.size() == hand::HandBody::part_count);
  body.follow(pose);
  for (std::size_t at = 0; at < parts.size(); ++at) {
    const hand::BodyPart& from = body.parts()[at];
    deform::ContactPart& part = parts[at];
    part.corner_count = from.corner_count;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      part.corners[corner] = units_per_metre * from.corners_m[corner];
      part.radii[corner] = units_per_metre * from.radii_m[corner];
    }
    part.frame = pose[from.carrier];
    part.frame.translation() *= units_per_metre;
  }
}

} // namespace nendo::flow
