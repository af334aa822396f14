#pragma once
// The commands that a running loop cannot obey: they are collected, and the next loop is made with
// them. It goes on from the shape as it is, with the hands where they are; undo begins anew.

#include <optional>

#include <nendo/flow/command.hpp>

#include "session/place_loop.hpp"

namespace nendo::session {

/// What the next loop is to have that this one has not.
struct LoopChange {
  std::optional<flow::LoopSettings> settings{};
  bool reset = false;           ///< begin with the model as it was loaded
  std::optional<bool> record{}; ///< whether it is recorded to a file

  bool is_empty() const noexcept { return !settings && !reset && !record; }
  /// Of two commands of a kind, the later one counts. Commands of other kinds change nothing.
  void add(const flow::Command& command) noexcept;
};

/// The settings with which a loop was made.
flow::LoopSettings settings_of(const PlacedLoop& placed);

/// Whether a new loop would differ at all from the one that runs.
bool differs(const LoopChange& change, const PlacedLoop& placed, const RunOptions& options);

/// Makes the next loop's options; the shape is left to the caller. A radius that nobody gave stays
/// what the model's size made of it at first, however the model has been pulled about since.
void apply(const LoopChange& change, const PlacedLoop& placed, RunOptions& options);

} // namespace nendo::session
