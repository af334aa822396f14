#pragma once
// Finds the frames in which the fingertips grabbed the model.

#include <nendo/flow/frame.hpp>

namespace nendo::flow {

/// Follows a loop's frames, one after another. A hold begins where `held` becomes true, or where a
/// change of the rest shape or a jump of the shape is counted. Wait-free.
class HoldWatch {
public:
  /// Returns true if the fingertips grabbed in this frame.
  bool follow(const Frame& frame) noexcept {
    const bool has_grabbed = frame.held && (!held_ || frame.rest_changes != rest_changes_ ||
                                            frame.shape_jumps != jumps_);
    held_ = frame.held;
    rest_changes_ = frame.rest_changes;
    jumps_ = frame.shape_jumps;
    return has_grabbed;
  }

private:
  std::uint64_t rest_changes_ = 0;
  std::uint64_t jumps_ = 0;
  bool held_ = false;
};

} // namespace nendo::flow
