#pragma once
// Gloves and trackers that replay the samples of a recording with their original timing. Programs
// use them like any other glove.

#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/open_tracker.hpp>

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

/// Returns the driver of `replay:FILE?hand=left|right&speed=X&loop=yes|no&end=stop|hold`, a tracker
/// with the recorded poses of one hand or both, for driver::open_trackers(). `hand` may be omitted
/// if one hand was tracked. Stations have their recorded numbers, or 1 for the left and 2 for the
/// right hand if these are the same. Times and options are as those of replay_driver(). Errors:
/// usage, bad_input (no recording, no poses), no_device (not of that hand).
NENDO_API driver::TrackerDriver replay_tracker_driver() noexcept;

} // namespace nendo::recording
