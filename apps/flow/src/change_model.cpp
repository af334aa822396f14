// The part of the broker that prepares other versions of the model.

#include <algorithm>
#include <cassert>
#include <utility>

#include <nendo/flow/rig_setup.hpp>

#include "broker_parts.hpp"

namespace nendo::flow {

ModelVersions::ModelVersions(const deform::Mesh& model, const UndoSpace& undo,
                             const deform::BlockShape* first)
    : undo_(undo) {
  all_.push_back(
      std::make_shared<ModelVersion>(0, model, deform::BlockLayout(model.vertices), undo, first));
}

std::shared_ptr<ModelVersion> ModelVersions::find(std::uint32_t number) const noexcept {
  for (const auto& version : all_)
    if (version->number == number) return version;
  return nullptr;
}

ModelVersion& ModelVersions::add(std::unique_ptr<ModelVersion> version) {
  ++last_number_;
  all_.push_back(std::move(version));
  return *all_.back();
}

void ModelVersions::release_others(const ModelVersion& newest) {
  std::erase_if(all_, [&newest](const auto& version) {
    for (const ModelVersion* at = &newest; at != nullptr; at = at->before)
      if (at == version.get()) return false;
    return true;
  });
}

UndoSpace ModelVersions::remaining_space() const noexcept {
  if (undo_.max_bytes == 0) return {undo_.bytes, 0};
  std::size_t used = 0;
  for (const auto& version : all_)
    if (version->undo_memory) used += version->undo_memory->bytes();
  return {0, undo_.max_bytes - std::min(undo_.max_bytes, used)};
}

ModelVersion& ChangeBroker::first_model() noexcept {
  return parts_->versions.first();
}

const ModelVersion& ChangeBroker::newest_model() const noexcept {
  return *parts_->asked_model;
}

std::shared_ptr<const ModelVersion> ChangeBroker::model(std::uint32_t number) const noexcept {
  return parts_->versions.find(number);
}

bool ChangeBroker::refill_undo() {
  deform::UndoMemory* const memory = parts_->asked_model->undo_memory.get();
  return memory == nullptr || memory->refill();
}

Result<void> ChangeBroker::hold_still() {
  if (is_changing())
    return Error{Errc::failed, "the loop has yet to take another change; ask again later"};
  if (parts_->is_still)
    return Error{Errc::failed, "the loop holds still already; change or keep its model first"};
  parts_->next_change().holds_still = true;
  parts_->offer();
  return {};
}

bool ChangeBroker::is_still() {
  return !is_changing() && parts_->is_still;
}

Result<void>
ChangeBroker::change_model(PendingModel& finer,
                           const std::function<Result<void>(const ModelVersion&)>& accepts) {
  Parts& parts = *parts_;
  assert(is_still() && finer.is_of(*parts.asked_model));
  auto made = finer.finish(parts.versions.next_number(), parts.versions.remaining_space(),
                           is_played(parts.asked_rig()));
  SculptorOptions sculptor = parts.asked.options;
  const auto check = [&]() -> Result<void> {
    if (!made) return Error{made.error().code, "the model " + made.error().message};
    // A puppet's points may lie too near to each other on another version.
    if (auto fits = parts.set_model(sculptor, **made); !fits) return fits;
    return accepts ? accepts(**made) : Result<void>();
  };
  if (auto fine = check(); !fine) {
    keep_model();
    return fine;
  }
  parts.asked.options = std::move(sculptor);
  ModelVersion& version = parts.versions.add(*std::move(made));
  parts.offer_model(version, finer.change_to(version));
  return {};
}

void ChangeBroker::keep_model() {
  assert(is_still());
  parts_->offer_model(*parts_->asked_model, {parts_->asked_model->number});
}

Result<void> ChangeBroker::change_to(const Awaited& awaited) {
  ModelVersion* const version = parts_->versions.find(awaited.model).get();
  if (version == nullptr || awaited.puppet >= next_puppet())
    return Error{Errc::bad_input, "there is no such model, or no such puppet"};
  if (!awaited.settings.are_usable()) return change_settings(awaited.settings);
  if (version != parts_->asked_model) {
    if (is_changing() || parts_->is_still)
      return Error{Errc::failed, "the model is being changed; try it again"};
    parts_->offer_model(*version, {version->number});
  }
  if (awaited.puppet != newest_puppet())
    if (auto changed = change_puppet(awaited.puppet); !changed) return changed;
  return change_settings(awaited.settings);
}

/// Offers that version, which must not change until the loop has it.
void ChangeBroker::Parts::offer_model(ModelVersion& version, const ChangeModel& model) {
  next_change();
  change->model = model;
  // A kept version was tried when it was made.
  if (&version != asked_model && !model.is_new())
    static_cast<void>(set_model(asked.options, version));
  Shaping::prepare(asked, version, control_points(), change->ready);
  change->ready.puppet = asked_puppet;
  change->ready.is_new_model = model.is_new();
  if (change->log) change->log->of_other_model = space_for_shape(version);
  model_before = asked_model;
  if (&version != asked_model)
    change->ready.spare_shapes.fill({version.number, version.shape.shape()});
  asked_model = &version;
  offer();
  // Those that are not possible with this version are dropped.
  if (settings_later) static_cast<void>(change_settings(*std::exchange(settings_later, {})));
}

/// Puts the masks and the puppet's field for that version into the options. Error: the puppet's
/// points are too near to each other.
Result<void> ChangeBroker::Parts::set_model(SculptorOptions& sculptor,
                                            const ModelVersion& version) const {
  set_masks(asked_rig(), version.mesh, version.layout(), sculptor);
  return set_surface(sculptor, version);
}

/// The loop has refused the last request.
void ChangeBroker::Parts::go_back() {
  asked_model = model_before;
  if (change->settings) asked = change->before;
  static_cast<void>(set_model(asked.options, *asked_model));
}

} // namespace nendo::flow
