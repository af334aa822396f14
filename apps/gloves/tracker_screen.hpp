#pragma once
// The picture that `nendo monitor` draws of trackers in a terminal: two lines about each tracker,
// and a line for each station.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nendo/driver/tracker.hpp>

#include "cli/terminal.hpp"
#include "gloves/count_rate.hpp"

namespace nendo::gloves {

/// The latest pose of a station, and how fast they come.
class SeenPoses {
public:
  void add(const PoseSample& pose);
  const std::optional<PoseSample>& latest() const noexcept { return latest_; }
  std::uint64_t count() const noexcept { return count_; }
  double rate_hz() const noexcept { return rate_.per_s(); }

private:
  std::optional<PoseSample> latest_;
  std::uint64_t count_ = 0;
  CountRate rate_;
};

struct StationPicture {
  std::uint16_t station = 0;
  const SeenPoses* seen = nullptr;
};

/// Everything that is pointed to must outlive the picture.
struct TrackerPicture {
  const driver::TrackerInfo* info = nullptr;
  driver::StreamStats stats;
  std::vector<StationPicture> stations;
};

/// Returns lines of printable ASCII, at most as many and as long as the screen. With `has_keys` the
/// first tracker's line shows the keys.
std::vector<std::string> tracker_lines(const std::vector<TrackerPicture>& trackers, HostTime now,
                                       bool has_keys, cli::ScreenSize size);

} // namespace nendo::gloves
