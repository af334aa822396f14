#pragma once
// A glove without hardware, in this process: a peer of the real ones. It has no bytes, so none are
// ever lost.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// `sim:MOTION?seed=N&rate=HZ&hand=left|right&sensors=18|22`; all of it may be left out (sculpt, 1,
/// 90, `side`, 22). The motion begins with start(). Samples come at absolute deadlines; one that is
/// missed is skipped, the grid stays. Error: usage, naming the option and what is allowed.
Result<std::unique_ptr<Glove>> open_simulated(const GloveSpec& spec, std::optional<Side> side);

} // namespace nendo::driver
