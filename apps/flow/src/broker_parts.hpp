#pragma once
// The state of a ChangeBroker: puppets, versions, the last request, and the change that the loop
// has or will have.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <nendo/flow/change_broker.hpp>
#include <nendo/flow/model_version.hpp>
#include <nendo/flow/prepared_change.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// The puppets and masks that a loop has had, each ready to return. Asking thread.
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
  /// Returns the first setup, with that puppet instead.
  SculptorSetup first_with(std::uint32_t number) const;
  /// Returns that puppet, ready to replace `before`.
  ReadyRig ready(std::uint32_t number, std::uint32_t before, const SculptorOptions& options) const;
  /// Keeps that puppet as it was when another replaced it.
  void keep(std::uint32_t number, PuppetPlayer puppet);
  /// From here on the loop is as one that begins with that setup and puppet.
  void restart(const SculptorSetup& setup, std::uint32_t number);

private:
  void set_tip_supports();

  SculptorSetup first_;
  std::shared_ptr<const puppet::Rig> first_rig_; ///< with which `first_` is
  Eigen::Index hands_;
  std::optional<deform::Supports> tip_supports_; ///< the supports of hands without a puppet
  std::vector<std::shared_ptr<const puppet::Rig>> all_;
  std::map<std::uint32_t, PuppetPlayer> played_;
};

/// The versions of a model that a loop has had, and to which an undo or a redo may lead. Asking
/// thread.
class ModelVersions {
public:
  /// `undo` is for all versions together. With `first`, that is the shape at first.
  ModelVersions(const deform::Mesh& model, const UndoSpace& undo, const deform::BlockShape* first);

  ModelVersion& first() noexcept { return *all_.front(); }
  /// Returns that version; null if there is none.
  std::shared_ptr<ModelVersion> find(std::uint32_t number) const noexcept;
  /// Returns the number that add() needs.
  std::uint32_t next_number() const noexcept { return last_number_ + 1; }
  ModelVersion& add(std::unique_ptr<ModelVersion> version);
  /// Releases all versions that do not come before `newest`: a new version took the place to which
  /// a redo would have led.
  void release_others(const ModelVersion& newest);
  /// Returns the memory that remains for undo. Memory that grows is not allocated while the loop
  /// holds still.
  UndoSpace remaining_space() const noexcept;

private:
  UndoSpace undo_;
  std::vector<std::shared_ptr<ModelVersion>> all_;
  std::uint32_t last_number_ = 0;
};

struct ChangeBroker::Parts {
  Parts(const deform::Mesh& model, const CoreOptions& options, const deform::BlockShape* first);

  // In change_broker.cpp:
  bool take_back_done();
  PreparedChange& next_change();
  void offer();
  void make_ready();
  void end_log();
  Result<void> change_settings(const LoopSettings& settings);
  Result<SculptorSetup> setup_for(const SculptorSetup& before, const LoopSettings& settings) const;
  // In change_model.cpp:
  Result<void> change_puppet(std::uint32_t number);
  Result<SculptorSetup> setup_with(std::uint32_t puppet) const;
  Result<void> set_surface(SculptorOptions& sculptor, const ModelVersion& version) const;
  void offer_model(ModelVersion& version, const ChangeModel& model);
  void go_back();
  Result<void> set_model(SculptorOptions& sculptor, const ModelVersion& version) const;

  const puppet::Rig* asked_rig() const noexcept { return puppets[asked_puppet].get(); }
  Eigen::Index control_points() const noexcept {
    return puppets.control_points(asked_puppet, asked.options);
  }

  std::shared_ptr<const HandBodies> bodies;
  std::size_t inputs;
  double units_per_metre;
  ModelVersions versions;
  SculptorSetup asked; ///< the last requested setup
  KeptPuppets puppets;
  std::uint32_t asked_puppet = 0;
  ModelVersion* asked_model;
  ModelVersion* model_before = nullptr;   ///< the version that was requested before
  std::unique_ptr<PreparedChange> change; ///< the loop has it, or will have it
  bool is_offered = false;
  bool is_still = false;                      ///< the loop has taken that it holds still
  std::optional<LoopSettings> settings_later; ///< requested while the loop holds still
  std::vector<LoopState> states;              ///< those that take_state() returns
  JobOffer<PreparedChange*> offers;
};

} // namespace nendo::flow
