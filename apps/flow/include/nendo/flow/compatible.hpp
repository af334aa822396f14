#pragma once
// Which settings go together, and why others do not: one place for the command line and for a loop
// that runs, which keys, the window and the page change.

#include <cstdint>

#include <nendo/base/result.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/puppet/rig.hpp>

namespace nendo::flow {

/// What a puppet measures its distances along. Without a puppet, fingertips and hands touch.
enum class Played : std::uint8_t { nothing, through_air, along_surface };

NENDO_API Played played_by(const puppet::Puppet& puppet) noexcept;
/// The same; null: nothing is played.
NENDO_API Played played_by(const puppet::Rig* rig) noexcept;

/// How a message names a setting: as the command line has it, or in words.
enum class Naming : std::uint8_t { options, words };

/// Returns whether a loop can shape with all of these. Error, in one line: which two exclude each
/// other, why, and what to do; usage where it names options, otherwise bad_input. Allocates.
NENDO_API Result<void> compatible(const LoopSettings& settings, Played played,
                                  Naming naming = Naming::words);
/// Checks the same, and whether each setting has an effect. A loop takes settings of which one has
/// none, so that users choose them in any order; on the command line they are an error.
NENDO_API Result<void> all_effective(const LoopSettings& settings, Played played,
                                     Naming naming = Naming::words);

} // namespace nendo::flow
