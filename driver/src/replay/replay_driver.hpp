#pragma once
// A glove out of a recording: its samples come again as they came, a peer of the real ones.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// `replay:FILE?hand=left|right&speed=X&loop=yes|no`. Of several gloves in the file, `hand` or else
/// `side` says which. Samples keep counts, sequence and device time; their host times are those of
/// now, as far apart as they were, divided by `speed` (0.01 to 100). After the last one the glove
/// falls silent, or with `loop` begins again, its sequence going on. Errors: usage (options),
/// bad_input (no recording, no samples), no_device (not of that hand).
Result<std::unique_ptr<Glove>> open_replay(const GloveSpec& spec, std::optional<Side> side);

} // namespace nendo::driver
