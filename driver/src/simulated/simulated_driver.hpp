#pragma once
// A glove without hardware, in this process: a peer of the real ones. It has no bytes, so none are
// ever lost.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// As simulated_glove_options() says, with one of the motions of hand_motion.hpp. The motion begins
/// with start(). Error: usage, also for the one motion that takes a surface.
Result<std::unique_ptr<Glove>> open_simulated(const GloveSpec& spec, std::optional<Side> side,
                                              const GloveContext& context = {});

} // namespace nendo::driver
