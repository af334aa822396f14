#pragma once
// What people want of a run that only a new loop can give, made of it in one place, whoever asked.

#include <nendo/flow/loop_settings.hpp>

#include "session/place_loop.hpp"

namespace nendo::session {

/// What of its settings only a new loop can change.
flow::LoopSettings settings_of(const PlacedLoop& placed);

/// Whether it asks for anything else than what is: then a new loop is needed.
bool differs(const flow::LoopChange& change, const PlacedLoop& placed, const RunOptions& options);

/// What the next loop is to be made of; the shape is left to the caller. A radius that nobody gave
/// is what the model's size made of it at first, however the model has been pulled about since.
void apply(const flow::LoopChange& change, const PlacedLoop& placed, RunOptions& options);

} // namespace nendo::session
