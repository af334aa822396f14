#pragma once
// Gloves that replay a recording: its samples come again as they came. To programs they are gloves
// like any other.

#include <nendo/driver/open_glove.hpp>

namespace nendo::recording {

/// Returns the driver of `replay:FILE?hand=left|right&speed=X&loop=yes|no&end=stop|hold`, for
/// driver::GloveContext. If the file has several gloves, `hand` or else the wanted side chooses
/// one. Samples keep counts, sequence and device time. Their host times are new, and
/// recorded_arrival and recorded_measured are the old ones; the times between them are divided by
/// `speed` (0.01 to 100). After the last sample the glove has ended; with `loop` it begins again,
/// and its sequence continues; with `end=hold` it is silent, like a glove that lies on the table. A
/// FILE whose name ends with .csv, .tsv or .txt is a table of counts; `rate=HZ` are the rows per
/// second of one without times. Errors: usage (options), bad_input (no recording, no samples),
/// no_device (not of that hand).
NENDO_API driver::GloveDriver replay_driver() noexcept;

} // namespace nendo::recording
