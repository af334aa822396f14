#pragma once
// The options of the commands that run the loop: how it is paced, and what it asks of the system.

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <nendo/flow/pacer.hpp>
#include <nendo/flow/realtime.hpp>

#include "command.hpp"

namespace nendo::app {

struct LoopArguments {
  std::uint32_t priority = 0;
  std::string affinity{};
  bool lock_memory = false;
  std::string policy = "skip";
  std::string spin = "auto";

  /// Names as cyclictest has them. `short_names`: -p, -a and -m, too.
  void add_to(Command& command, bool short_names = false);
  /// Reads them into `pace` and `realtime`. Error: usage, naming the option and what it may be.
  Result<void> parse(flow::PaceOptions& pace, flow::RealtimeOptions& realtime) const;
};

/// An object for each right that was asked for: name, wanted, granted, why, remedy.
nlohmann::ordered_json grants_json(const std::vector<flow::Grant>& grants);

} // namespace nendo::app
