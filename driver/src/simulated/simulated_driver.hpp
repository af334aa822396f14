#pragma once
// A glove without hardware, in this process. To programs it is a glove like any other. It has no
// bytes, so none are ever lost.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// Opens a glove with the options of simulated_glove_options() and one of the motions of
/// hand_motion.hpp or of `context`. The motion begins with start(). Errors: usage; that of the
/// motion.
Result<std::unique_ptr<Glove>> open_simulated(const GloveSpec& spec, std::optional<Side> side,
                                              const GloveContext& context = {});

} // namespace nendo::driver
