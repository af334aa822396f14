#pragma once
// The commands that a running loop cannot obey. They are collected, and the next loop is made with
// them. It goes on from the present shape, with the hands where they are; undo begins anew.

#include <optional>

#include <nendo/flow/command.hpp>

#include "session/place_loop.hpp"

namespace nendo::session {

/// What the next loop has to do differently from this one.
struct LoopChange {
  std::optional<flow::LoopSettings> settings{};
  bool reset = false;           ///< begin with the model as it was loaded
  std::optional<bool> record{}; ///< whether it is recorded to a file

  bool is_empty() const noexcept { return !settings && !reset && !record; }
  /// Adds a command. Of two commands of a kind, the later one counts. Commands that a running loop
  /// obeys change nothing.
  void add(const flow::Command& command) noexcept;
};

/// Returns the settings with which a loop was made.
flow::LoopSettings settings_of(const PlacedLoop& placed);

/// Tells whether a new loop would differ at all from the one that runs.
bool differs(const LoopChange& change, const PlacedLoop& placed, const RunOptions& options);

/// Makes the next loop's options. The caller provides the shape. A radius that the user did not
/// give stays what it was computed from the model's first size, even if the model has changed its
/// size since.
void apply(const LoopChange& change, const PlacedLoop& placed, RunOptions& options);

} // namespace nendo::session
