#pragma once
// A capture as JSON lines, of which there are two kinds that may be mixed. Samples, as nendo
// monitor
// --json prints them: {"measured_s":…,"hand":"right","raw":{"index_mcp":118,…}}. Poses that were
// held: {"pose":"flat","hand":"right","counts_most":255,"mean_counts":{…},"noise_counts":{…}}.

#include <filesystem>
#include <span>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration_fit.hpp>

namespace nendo::app {

struct CaptureFile {
  std::vector<GloveSample> samples;
  std::vector<hand::PoseReading> readings;
  Side side = Side::right;
  CountScale counts; ///< 255 unless the poses say otherwise
};

/// Errors: bad_input, "FILE:LINE: what"; a file of two hands or of none, without a line of either
/// kind, or larger than 1 GiB.
Result<CaptureFile> read_capture(const std::filesystem::path& path);

/// Replaces the file in one step. Error: failed.
Result<void> write_readings(const std::filesystem::path& path,
                            std::span<const hand::PoseReading> readings, Side side,
                            CountScale counts);

} // namespace nendo::app
