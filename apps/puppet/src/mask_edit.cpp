#include <nendo/puppet/puppet_edit.hpp>

#include <algorithm>
#include <cmath>

#include "edited_puppet.hpp"

namespace nendo::puppet {

using Eigen::Vector3d;

namespace {

Result<void> add_masks(std::span<const Vector3d> stroke, double radius, Puppet& puppet) {
  if (!(radius > 0.0) || !std::isfinite(radius)) return refused("a brush needs a radius above 0");
  std::vector<Mask>& masks = puppet.masks;
  const auto add = [&](const Vector3d& at) {
    constexpr double near = 0.35; // of the radius: what is masked by one is masked by the other
    const bool is_there = std::any_of(masks.begin(), masks.end(), [&](const Mask& mask) {
      return mask.radius >= radius && (mask.at - at).norm() < near * radius;
    });
    if (!is_there && at.allFinite())
      masks.push_back({rounded(at, radius), rounded(radius, radius)});
  };
  for (const Vector3d& at : stroke) {
    add(at);
    if (puppet.mirrors) add(flipped(at, puppet.mirror_at));
  }
  if (masks.size() > max_painted_masks)
    return refused("there are more than " + std::to_string(max_painted_masks) +
                   " masks then; use a larger brush, or erase some");
  return {};
}

void erase_masks(std::span<const Vector3d> stroke, double radius, Puppet& puppet) {
  std::erase_if(puppet.masks, [&](const Mask& mask) {
    return std::any_of(stroke.begin(), stroke.end(), [&](const Vector3d& at) {
      return (mask.at - at).norm() <= radius ||
             (puppet.mirrors && (mask.at - flipped(at, puppet.mirror_at)).norm() <= radius);
    });
  });
}

} // namespace

Result<Puppet> with_masks(const Rig& rig, std::span<const Vector3d> stroke, double radius) {
  EditedPuppet draft(rig);
  if (draft.puppet().inverted)
    erase_masks(stroke, half_of_mask * radius, draft.puppet());
  else if (const auto added = add_masks(stroke, radius, draft.puppet()); !added)
    return added.error();
  return draft.done();
}

Result<Puppet> without_masks(const Rig& rig, std::span<const Vector3d> stroke, double radius) {
  EditedPuppet draft(rig);
  if (!draft.puppet().inverted)
    erase_masks(stroke, radius, draft.puppet());
  else if (const auto added = add_masks(stroke, radius / half_of_mask, draft.puppet()); !added)
    return added.error();
  return draft.done();
}

Result<Puppet> without_any_mask(const Rig& rig) {
  EditedPuppet draft(rig);
  draft.puppet().masks.clear();
  draft.puppet().inverted = false;
  return draft.done();
}

Result<Puppet> with_masks_inverted(const Rig& rig) {
  EditedPuppet draft(rig);
  draft.puppet().inverted = !draft.puppet().inverted;
  return draft.done();
}

Result<Puppet> with_symmetry(const Rig& rig, bool on, double at) {
  EditedPuppet draft(rig);
  if (draft.puppet().is_played())
    return refused("hands play this puppet; its mirror is another edit");
  draft.puppet().mirrors = on;
  draft.puppet().mirror_at = on ? at : 0.0;
  return draft.done();
}

} // namespace nendo::puppet
