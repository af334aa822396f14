#pragma once
// A capture as JSON lines of three kinds, which may be mixed. Samples are as nendo monitor --json
// prints them: {"measured_s":…,"hand":"right","raw":{"index_mcp":118,…}}. Held poses are
// {"pose":"flat","mean_counts":{…},"noise_counts":{…},"hand":"right","counts_most":255}. The ends
// of a free motion are {"low_counts":{…},"high_counts":{…},"hand":"right","counts_most":255}.

#include <filesystem>
#include <span>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration_fit.hpp>
#include <nendo/hand/range_capture.hpp>

namespace nendo::calibrate {

struct CaptureFile {
  std::vector<GloveSample> samples;
  std::vector<hand::PoseReading> readings;
  Side side = Side::right;
  CountScale counts; ///< 255 unless poses or free motion say otherwise
  hand::CountRanges free_motion;

  bool is_empty() const noexcept {
    return samples.empty() && readings.empty() && free_motion.present.bits == 0;
  }
};

/// Reads a capture. Blocks. Fails with bad_input ("FILE:LINE: what"), also for a file that has two
/// hands or none, has no line of any kind, or is larger than 1 GiB.
Result<CaptureFile> read_capture(const std::filesystem::path& path);

/// Writes the readings and the free motion; replaces the file in one step. Blocks. Error: failed.
Result<void> write_readings(const std::filesystem::path& path,
                            std::span<const hand::PoseReading> readings,
                            const hand::CountRanges& free_motion, Side side, CountScale counts);

} // namespace nendo::calibrate
