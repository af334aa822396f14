// The part of the loop that prepares other versions of the model, on the thread that asks for them.

#include <nendo/flow/deform_loop.hpp>

#include <cassert>
#include <utility>

#include <nendo/flow/prepared_change.hpp>

namespace nendo::flow {

bool DeformLoop::hold_still() {
  if (is_changing() || is_still_) return false;
  next_change().holds_still = true;
  offer_change();
  return true;
}

bool DeformLoop::is_still() {
  return !is_changing() && is_still_;
}

ModelVersion* DeformLoop::version_numbered(std::uint32_t number) const noexcept {
  for (const auto& version : versions_)
    if (version->number == number) return version.get();
  return nullptr;
}

Result<void>
DeformLoop::change_model(FinerModel& finer,
                         const std::function<Result<void>(const ModelVersion&)>& accepts) {
  assert(is_still() && finer.is_of(*asked_model_));
  const bool is_puppets = is_played(puppets_[asked_puppet_].get());
  auto made = finer.finish(last_number_ + 1, undo_room(), is_puppets);
  SculptorOptions sculptor = asked_.options;
  const auto check = [&]() -> Result<void> {
    if (!made) return Error{made.error().code, "the model " + made.error().message};
    // A puppet's points may lie too near to each other on another version.
    if (auto fits = set_model(sculptor, **made); !fits) return fits;
    return accepts ? accepts(**made) : Result<void>();
  };
  if (auto fine = check(); !fine) {
    keep_model();
    return fine;
  }
  asked_.options = std::move(sculptor);
  ++last_number_;
  versions_.push_back(*std::move(made));
  offer_model(*versions_.back(), finer.change_to(*versions_.back()));
  return {};
}

void DeformLoop::keep_model() {
  assert(is_still());
  offer_model(*asked_model_, {asked_model_->number});
}

bool DeformLoop::change_to(const Awaited& awaited) {
  ModelVersion* const version = version_numbered(awaited.model);
  if (version == nullptr || !awaited.settings.are_usable() || awaited.puppet >= puppets_.size())
    return false;
  if (version != asked_model_) {
    if (is_changing() || is_still_) return false;
    offer_model(*version, {version->number});
  }
  if (awaited.puppet != asked_puppet_ && !change_puppet(awaited.puppet)) return false;
  return change_settings(awaited.settings);
}

/// Offers that version, which must not change until the loop has it.
void DeformLoop::offer_model(ModelVersion& version, const ChangeModel& model) {
  PreparedChange& change = next_change();
  change.model = model;
  // A kept version was tried when it was made.
  if (&version != asked_model_ && !model.is_new())
    static_cast<void>(set_model(asked_.options, version));
  Shaping::prepare(asked_, version, control_points(asked_puppet_), change.ready);
  change.ready.puppet = asked_puppet_;
  change.ready.is_new_model = model.is_new();
  if (change.log) change.log->of_other_model = room_for_shape(version);
  model_before_ = asked_model_;
  if (&version != asked_model_)
    change.ready.shape_room.fill({version.number, version.shape.shape()});
  asked_model_ = &version;
  offer_change();
  if (settings_later_) change_settings(*std::exchange(settings_later_, {}));
}

/// The loop has refused what was asked for last.
void DeformLoop::go_back() {
  asked_model_ = model_before_;
  if (change_->settings) asked_ = change_->before;
  static_cast<void>(set_model(asked_.options, *asked_model_));
}

/// Where a new version has taken the way that a redo would have gone, frees those of that way.
void DeformLoop::free_others(const ChangeModel& taken) {
  if (!taken.is_new()) return;
  std::erase_if(versions_, [this](const auto& version) {
    for (const ModelVersion* at = asked_model_; at != nullptr; at = at->before)
      if (at == version.get()) return false;
    return true;
  });
}

/// What is left of the memory for undo. Memory that grows is not allocated while the loop holds
/// still.
UndoRoom DeformLoop::undo_room() const noexcept {
  std::size_t used = 0;
  for (const auto& version : versions_)
    if (version->undo_memory) used += version->undo_memory->bytes();
  const std::size_t most = options_.undo_most_bytes;
  if (most > 0) return {0, most - std::min(most, used)};
  return {options_.sculptor.deformer.undo_bytes, 0};
}

bool DeformLoop::refill_undo() {
  return asked_model_->undo_memory == nullptr || asked_model_->undo_memory->refill();
}

} // namespace nendo::flow
