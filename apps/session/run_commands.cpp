#include "session/run_commands.hpp"

#include <algorithm>
#include <new>
#include <variant>

#include <nendo/flow/sculptor.hpp>
#include <nendo/flow/setting.hpp>
#include <nendo/puppet/puppet_edit.hpp>

#include "commands/commands.hpp"

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

/// Returns the rig with a SetMask, or with a SetSymmetry if no hand plays it. The rig may be null.
/// vertices: the model with which the loop began. Error: bad_input (too many masks).
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

/// Returns whether a command does something where there is no model.
bool is_for_hands(const flow::Command& command) noexcept {
  return std::holds_alternative<flow::Recentre>(command) ||
         std::holds_alternative<flow::WristMove>(command) ||
         std::holds_alternative<flow::EndRun>(command);
}

} // namespace

bool LoopCommands::push(const flow::Command& command) {
  if (ring_.try_push(command)) {
    if (reported_ == dropped_.size()) {
      dropped_.clear();
      reported_ = 0;
    }
    return true;
  }
  const std::string_view name = commands::name_of(command);
  if (std::find(dropped_.begin(), dropped_.end(), name) == dropped_.end()) dropped_.push_back(name);
  return false;
}

std::optional<std::string> LoopCommands::dropped() {
  if (reported_ == dropped_.size()) return std::nullopt;
  std::string names;
  for (; reported_ < dropped_.size(); ++reported_)
    names += (names.empty() ? "" : ", ") + std::string(dropped_[reported_]);
  return "The loop is not responding; dropped: " + names + ".";
}

void RunCommands::follow_frame(const flow::Frame& frame) {
  if (frame.ticks_run > 0) {
    const bool on = (frame.layers_on & placed_.setup.live_layers()) != 0;
    if (is_in_ && *is_in_ != on) report_(on ? "punched in" : "punched out");
    is_in_ = on;
  }
  const bool is_news = std::exchange(wires_, frame.wire.completed()) != frame.wire.completed();
  if (is_news && !frame.wire.is_drawing()) models_.cut(frame.wire);
}

// A run continues if there is no memory for one command.
void RunCommands::execute(const Asks& asks) {
  const auto execute_one = [this](const auto& one) {
    try {
      dispatch(one);
    } catch (const std::bad_alloc&) {
      report_({"No memory!", true}); // short enough to need none
    }
  };
  for (const Ask& ask : asks)
    std::visit(execute_one, ask);
  if (options_.over) {
    flow::CommandRing& from_take = options_.over->take.script->for_others();
    flow::Command command;
    while (from_take.try_pop(command))
      execute_one(command);
    const std::uint64_t refused = from_take.counters().refused;
    if (std::exchange(take_refused_, refused) != refused)
      report_({"The run was too busy and dropped changes of the recording: " +
                   std::to_string(refused) + " so far.",
               true});
  }
  for (auto& wrist : wrists_)
    if (wrist && for_loop_.try_push(*wrist)) wrist.reset(); // if it is full, the newest waits
  if (auto dropped = for_loop_.dropped()) report_({*std::move(dropped), true});
}

void RunCommands::dispatch(const flow::Command& command) {
  if (options_.hands_only && !is_for_hands(command))
    return report_({"there is no model; `nendo run` shapes one", true});
  std::visit([this](const auto& one) { execute(one); }, command);
}

void RunCommands::execute(const flow::WristMove& move) {
  if (!move.is_usable()) {
    if (!std::exchange(move_refused_, true)) report_({std::string(flow::WristMove::refusal), true});
    return;
  }
  move_refused_ = false;
  wrists_[flow::Placement::index_of(move.side)] = move; // the newest replaces an older one
}

void RunCommands::execute(const flow::Mark& mark) {
  if (!recorder_.is_recording()) return report_({commands::no_recording, true});
  if (for_loop_.push(mark)) report_("mark " + std::to_string(++marks_) + " is in the recording");
}

void RunCommands::execute(const flow::Punch&) {
  const std::uint32_t live = placed_.setup.live_layers();
  if (live == 0) return report_(commands::no_layers);
  const bool on = !is_in_.value_or(true);
  for (std::size_t at = 0; at < placed_.setup.inputs.size(); ++at)
    if ((live >> at & 1U) != 0) for_loop_.push(flow::SetLayer{static_cast<std::uint8_t>(at), on});
}

// The take's loop does not change puppets by itself. Only the newest counts.
void RunCommands::execute(const flow::ChangePuppet& change) {
  if (options_.over) taken_puppet_ = change.number;
}

bool RunCommands::plays_puppet() const {
  return flow::is_played(
      placed_.loop->changes().puppet(placed_.loop->changes().newest_puppet()).get());
}

void RunCommands::execute(const flow::SetSymmetry& symmetry) {
  if (plays_puppet() || flow::is_played(puppet_.get()))
    play_otherwise(symmetry);
  else
    mask_edits_.emplace_back(symmetry);
}

void RunCommands::play_otherwise(const flow::Command& command) {
  if (plays_puppet())
    for_loop_.push(command);
  else
    report_(commands::no_puppet);
}

bool RunCommands::may_change_puppet() const {
  flow::DeformLoop& loop = *placed_.loop;
  return !loop.frames().front().awaited && !loop.changes().is_changing() &&
         !recorder_.is_changing() && !models_.is_handing_over();
}

void RunCommands::follow(bool fresh) {
  flow::DeformLoop& loop = *placed_.loop;
  const flow::Frame& frame = loop.frames().front();
  const bool awaits = frame.awaited.has_value(); // by an undo or a redo
  if (fresh && awaits && !settings_) report(models_.go_to(*frame.awaited));
  if (settings_ && !loop.changes().is_changing()) change_settings();
  if (!awaits) edit_masks();
  if (puppet_ && may_change_puppet()) change_puppet();
  if (taken_puppet_ && may_change_puppet()) follow_taken_puppet();
  // A recording contains a wire completely or not at all.
  if (record_ && !recorder_.is_changing() && !models_.is_handing_over() && !models_.is_due())
    recorder_.set_file(*std::exchange(record_, {}), frame);
  report(recorder_.follow());
  report(models_.follow(!awaits && !recorder_.is_changing()));
}

bool RunCommands::is_due() const {
  return for_loop_.size() > 0 || settings_ || puppet_ || taken_puppet_ || !mask_edits_.empty() ||
         record_ || recorder_.is_changing() || models_.is_due() || models_.is_handing_over() ||
         placed_.loop->changes().is_changing();
}

// Reports once which of them has no effect beside another.
void RunCommands::change_settings() {
  const flow::LoopSettings wanted = *std::exchange(settings_, {});
  flow::ChangeBroker& changes = placed_.loop->changes();
  if (const auto changed = changes.change_settings(wanted); !changed)
    return report_(changed.error().message + "; nothing changed");
  const puppet::Rig* const rig = changes.puppet(changes.newest_puppet()).get();
  const auto fine = flow::all_effective(wanted, flow::played_by(rig));
  const std::string why = fine ? std::string() : fine.error().message;
  if (!why.empty() && why != no_effect_) report_(why);
  no_effect_ = why;
}

// Makes one puppet of all pending edits.
void RunCommands::edit_masks() {
  const flow::DeformLoop& loop = *placed_.loop;
  for (const flow::Command& command : std::exchange(mask_edits_, {})) {
    if (!puppet_) puppet_ = loop.changes().puppet(loop.changes().newest_puppet());
    auto edited = edited_masks(command, puppet_, loop.changes().model(0)->mesh.vertices);
    if (edited)
      puppet_ = *std::move(edited);
    else
      report_(edited.error().message);
  }
  if (puppet_ == loop.changes().puppet(loop.changes().newest_puppet())) puppet_.reset();
}

void RunCommands::change_puppet() {
  flow::DeformLoop& loop = *placed_.loop;
  const Rig rig = std::exchange(puppet_, nullptr);
  const Eigen::Index functions =
      flow::is_played(rig.get()) ? rig->supports().functions(rig->starts().cols()) : 0;
  if (!sinks_.empty() && static_cast<std::size_t>(functions) > frame_capacity(placed_).functions)
    return report_("a puppet with so many more points cannot be published; save it, and start "
                   "the run again with it");
  recorder_.add_puppet(loop.changes().next_puppet(), *rig);
  if (const auto changed = loop.changes().change_puppet(rig); !changed)
    report_(changed.error().message);
}

// The loop has the take's puppet already if the take has changed to it before.
void RunCommands::follow_taken_puppet() {
  const std::uint32_t number = *std::exchange(taken_puppet_, {});
  flow::DeformLoop& loop = *placed_.loop;
  const auto& puppets = options_.over->take.puppets;
  const auto of_take = puppets.find(number);
  const auto known = taken_puppets_.find(number);
  if (of_take == puppets.end() || known != taken_puppets_.end()) {
    const auto changed = loop.changes().change_puppet(of_take == puppets.end() ? 0 : known->second);
    if (!changed) report_(changed.error().message);
    return;
  }
  auto rig = recording::rig_of(*of_take->second, loop.changes().model(0)->mesh);
  if (!rig) return report_(rig.error().message);
  taken_puppets_[number] = loop.changes().next_puppet();
  puppet_ = *std::move(rig);
  change_puppet();
}

} // namespace nendo::session
