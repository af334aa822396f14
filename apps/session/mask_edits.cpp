#include "session/mask_edits.hpp"

#include <array>
#include <utility>
#include <variant>

#include <nendo/puppet/puppet_edit.hpp>

namespace nendo::session {
namespace {

Result<puppet::Puppet> edited(const flow::SetMask& mask, const puppet::Rig& rig) {
  const std::array stroke{Eigen::Vector3d(mask.at[0], mask.at[1], mask.at[2])};
  switch (mask.edit) {
  case flow::MaskEdit::hold:
    return puppet::with_masks(rig, stroke, mask.radius / puppet::half_of_mask);
  case flow::MaskEdit::free:
    return puppet::without_masks(rig, stroke, mask.radius);
  case flow::MaskEdit::clear:
    return puppet::without_any_mask(rig);
  case flow::MaskEdit::invert:
    break;
  }
  return puppet::with_masks_inverted(rig);
}

} // namespace

Result<std::shared_ptr<const puppet::Rig>>
edited_masks(const flow::Command& command, const std::shared_ptr<const puppet::Rig>& rig,
             const deform::Points& vertices) {
  const puppet::Rig nothing(puppet::Puppet{}, deform::Points(3, 0));
  const puppet::Rig& before = rig ? *rig : nothing;
  const auto* const symmetry = std::get_if<flow::SetSymmetry>(&command);
  const auto* const mask = std::get_if<flow::SetMask>(&command);
  auto after = symmetry != nullptr
                   ? puppet::with_symmetry(before, symmetry->on,
                                           symmetry->on ? puppet::plane_of_symmetry(vertices) : 0.0)
               : mask != nullptr ? edited(*mask, before)
                                 : Result<puppet::Puppet>(before.puppet());
  if (!after) return after.error();
  if (*after == before.puppet()) return rig;
  return std::make_shared<const puppet::Rig>(*std::move(after), before.starts());
}

} // namespace nendo::session
