#pragma once
// The options of the commands that run the loop or deform: the pace, the rights that the loop asks
// of the system, a second thread, and the kernel.

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/realtime.hpp>

#include "cli/command.hpp"

namespace nendo::session {

struct LoopArguments {
  std::uint32_t priority = 0;
  std::string affinity{};
  bool lock_memory = false;
  std::string policy = "skip";
  std::string spin = "auto";
  std::uint32_t threads = 1;

  /// Adds the options, with the names that cyclictest gives them. With `short_names`, adds -p, -a
  /// and -m.
  void add_to(cli::Command& command, bool short_names = false);
  /// Reads the options into `loop` and `realtime`. Errors: usage, naming the option and what it may
  /// be; failed (no processor for a second thread).
  Result<void> parse(flow::LoopOptions& loop, flow::RealtimeOptions& realtime) const;

private:
  Result<void> check_threads() const;
};

/// Adds --polynomial. What `name` holds is the default.
void add_polynomial_option(cli::Command& command, std::string& name);
/// Returns the solver's options for these settings. Error: usage, naming what can be used.
Result<deform::CsrbfOptions> csrbf_for(const flow::LoopSettings& settings,
                                       const std::string& polynomial);

/// Returns an object for each right that was asked for, with name, wanted, granted, why and remedy.
nlohmann::ordered_json grants_json(const std::vector<flow::Grant>& grants);

} // namespace nendo::session
