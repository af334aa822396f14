#pragma once
// A glove that replays a recording: its samples come again as they came. To programs it is a glove
// like any other.

#include <memory>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/open_glove.hpp>

namespace nendo::driver {

/// Opens `replay:FILE?hand=left|right&speed=X&loop=yes|no&end=stop|hold`. If the file has several
/// gloves, `hand` or else `side` chooses one. Samples keep counts, sequence and device time. Their
/// host times are new, and recorded_arrival and recorded_measured are the old ones; the times
/// between them are divided by `speed` (0.01 to 100). After the last sample the glove has ended;
/// with `loop` it begins again, and its sequence goes on; with `end=hold` it is silent, like a
/// glove that lies on the table. A FILE whose name ends with .csv is a table (sample_table.hpp);
/// `rate=HZ` are the rows a second of one without times. Errors: usage (options), bad_input (no
/// recording, no samples), no_device (not of that hand).
Result<std::unique_ptr<Glove>> open_replay(const GloveSpec& spec, std::optional<Side> side);

} // namespace nendo::driver
