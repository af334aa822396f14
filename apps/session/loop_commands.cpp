#include "session/loop_commands.hpp"

#include <algorithm>

#include "commands/commands.hpp"

namespace nendo::session {

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

} // namespace nendo::session
