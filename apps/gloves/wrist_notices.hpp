#pragma once
// Messages about wrists that trackers move.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/side.hpp>
#include <nendo/driver/open_tracker.hpp>
#include <nendo/flow/frame.hpp>

namespace nendo::gloves {

/// Notices when a tracker loses a wrist and has it again, and when its receiver begins to be
/// reported in the wrong hemisphere.
class WristNotices {
public:
  /// Shorter losses are only counted: each would be two messages.
  static constexpr std::chrono::milliseconds min_loss{500};

  /// Returns a sentence for each of these changes up to the next frame, which is `hand` at `now`.
  /// A run reports the hemisphere once. `station` moves the wrist.
  std::vector<std::string> changes(Side side, const flow::HandFrame& hand, HostTime now,
                                   const driver::TrackerStation& station);

private:
  std::optional<HostTime> lost_since_;
  bool is_loss_reported_ = false;
  bool is_flip_reported_ = false;
};

} // namespace nendo::gloves
