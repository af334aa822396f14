#pragma once
// Puts the values of a LucidGlove's line into the CyberGlove's slots.

#include <cstdint>

#include <nendo/driver/sample.hpp>

#include "lucidgloves/lucidgloves_parser.hpp"

namespace nendo::driver::lucidgloves {

/// Sets `raw` and `present` from `line`, as far as it goes:
/// * joints B, C, D of a finger are MCP, PIP, DIP; of the thumb MCP and IP. The metacarpal (A) has
///   no slot.
/// * the curl of a whole finger stands for its MCP, where the line does not tell that itself.
/// * the thumb's splay is its abduction.
/// * the fingers' splays become the angle between neighbours, which is what the slots mean: twice
///   their difference, at most `range`. So `range` is the 20 degrees to which a splay goes, about
///   what a spread hand reaches. Its sign is lost, since nobody says which side is which.
void fill_slots(const Line& line, std::uint16_t range, GloveSample& sample) noexcept;

} // namespace nendo::driver::lucidgloves
