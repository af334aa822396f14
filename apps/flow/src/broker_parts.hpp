#pragma once
// What a ChangeBroker keeps: what was asked for last, and the change that the loop has or will
// have.

#include <memory>
#include <optional>
#include <vector>

#include <nendo/flow/change_broker.hpp>

#include "kept_puppets.hpp"
#include "model_versions.hpp"

namespace nendo::flow {

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
  // In change_puppet.cpp:
  Result<void> change_puppet(std::uint32_t number);
  Result<SculptorSetup> setup_with(std::uint32_t puppet) const;
  Result<void> set_surface(SculptorOptions& sculptor, const ModelVersion& version) const;
  // In change_model.cpp:
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
  SculptorSetup asked; ///< the setup that was asked for last
  KeptPuppets puppets;
  std::uint32_t asked_puppet = 0;
  ModelVersion* asked_model;
  ModelVersion* model_before = nullptr;   ///< the version that was asked for before
  std::unique_ptr<PreparedChange> change; ///< the loop has it, or will have it
  bool is_offered = false;
  bool is_still = false;                      ///< the loop has taken that it holds still
  std::optional<LoopSettings> settings_later; ///< asked for while the loop holds still
  std::vector<LoopState> states;              ///< for take_state()
  JobOffer<PreparedChange*> offers;
};

} // namespace nendo::flow
