#pragma once
// nendo demo clay: simulated hands make a flat cake, a bowl and a nose.

#include <string>

namespace nendo::app::clay_demo {

/// Runs three sessions one after another, some 30 s altogether, and draws what they leave. `out` is
/// the name of a mesh file; each shape gets its own name before the ending, e.g. NAME-bowl.ply.
/// Returns the exit code. Blocks.
int demonstrate(const std::string& out, const std::string& picture);

} // namespace nendo::app::clay_demo
