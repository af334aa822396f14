#include "session/loop_commands.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace nendo::session {
namespace {

// The names of the table of commands (apps/commands).
struct LoopCommandName {
  std::string_view operator()(flow::Request request) const noexcept { return name_of(request); }
  std::string_view operator()(const flow::WristMove&) const noexcept { return "wrist"; }
  std::string_view operator()(const flow::Mark&) const noexcept { return "mark"; }
  std::string_view operator()(const flow::SetLayer&) const noexcept { return "punch"; }
  std::string_view operator()(const flow::DrawWire& draw) const noexcept {
    return draw.blade == flow::Blade::wire ? "wire" : "knife";
  }
  std::string_view operator()(const flow::SetClutch& clutch) const noexcept {
    return clutch.side == Side::left ? "clutch left" : "clutch right";
  }
  std::string_view operator()(const flow::SetRole&) const noexcept { return "role"; }
  std::string_view operator()(const flow::SetSymmetry&) const noexcept { return "symmetry"; }
  template <class Other>
  std::string_view operator()(const Other&) const noexcept {
    return "a command"; // none that a loop obeys (flow::is_for_loop())
  }
};

} // namespace

bool LoopCommands::push(const flow::Command& command) {
  if (ring_.try_push(command)) {
    if (reported_ == dropped_.size()) {
      dropped_.clear();
      reported_ = 0;
    }
    return true;
  }
  const std::string_view name = std::visit(LoopCommandName(), command);
  if (std::find(dropped_.begin(), dropped_.end(), name) == dropped_.end()) dropped_.push_back(name);
  return false;
}

std::optional<std::string> LoopCommands::dropped() {
  if (reported_ == dropped_.size()) return std::nullopt;
  std::string names;
  for (; reported_ < dropped_.size(); ++reported_)
    names += (names.empty() ? "" : ", ") + std::string(dropped_[reported_]);
  return "The loop does not answer, so this was dropped: " + names + ".";
}

} // namespace nendo::session
