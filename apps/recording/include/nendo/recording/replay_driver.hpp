#pragma once
// Gloves that replay the samples of a recording with their original timing. Programs use them like
// any other glove.

#include <nendo/driver/open_glove.hpp>

namespace nendo::recording {

/// Returns the driver of `replay:FILE?hand=left|right&speed=X&loop=yes|no&end=stop|hold`, for
/// driver::GloveContext. If the file has several gloves, `hand`, or otherwise the requested side,
/// selects one. Samples keep counts, sequence and device time. Their host times are new, and
/// recorded_arrival and recorded_measured are the old ones; intervals are divided by `speed` (0.01
/// to 100). After the last sample the glove ends; with `loop` it restarts, and its sequence
/// continues; with `end=hold` it stays silent, like a glove that lies on the table. A FILE whose
/// name ends with .csv, .tsv or .txt is a table of counts; `rate=HZ` sets the rows per second of a
/// table without times. Errors: usage (options), bad_input (no recording, no samples), no_device
/// (not of that hand).
NENDO_API driver::GloveDriver replay_driver() noexcept;

} // namespace nendo::recording
