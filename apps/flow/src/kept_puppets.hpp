#pragma once
// The puppets and masks that a loop has had, each ready to come back.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/flow/prepared_change.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// For the thread that asks for changes.
class KeptPuppets {
public:
  /// `first`, with that rig (null: none), is the setup with which the loop begins.
  KeptPuppets(SculptorSetup first, std::shared_ptr<const puppet::Rig> rig, Eigen::Index hands);

  std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(all_.size()); }
  const std::shared_ptr<const puppet::Rig>& operator[](std::uint32_t number) const noexcept {
    return all_[number];
  }
  void add(std::shared_ptr<const puppet::Rig> rig) { all_.push_back(std::move(rig)); }
  void remove_last() { all_.pop_back(); }

  /// Returns how many hands' supports with_settings() makes; 0: the supports are a puppet's.
  int hands_of(std::uint32_t number) const noexcept;
  /// Returns whether hands without a puppet can take over: the loop has begun with them.
  bool can_touch() const noexcept { return tip_supports_.has_value(); }
  Eigen::Index control_points(std::uint32_t number, const SculptorOptions& options) const noexcept;
  /// Returns what the first setup would be with that puppet.
  SculptorSetup first_with(std::uint32_t number) const;
  /// Returns that puppet, ready to replace `before`.
  ReadyRig ready(std::uint32_t number, std::uint32_t before, const SculptorOptions& options) const;
  /// Keeps that puppet as it was when another replaced it.
  void keep(std::uint32_t number, PuppetPlayer puppet);
  /// From here on the loop is as one that begins with that setup and puppet.
  void begin_anew(const SculptorSetup& setup, std::uint32_t number);

private:
  void set_tip_supports();

  SculptorSetup first_;
  std::shared_ptr<const puppet::Rig> first_rig_; ///< with which `first_` is
  Eigen::Index hands_;
  std::optional<deform::Supports> tip_supports_; ///< of hands without a puppet
  std::vector<std::shared_ptr<const puppet::Rig>> all_;
  std::map<std::uint32_t, PuppetPlayer> played_;
};

} // namespace nendo::flow
