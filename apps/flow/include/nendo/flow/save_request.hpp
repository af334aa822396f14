#pragma once
// What people want kept of a run while it goes on. No loop needs to stop for it.

namespace nendo::flow {

struct SaveRequest {
  bool shape = false;     ///< the model as it is now, in a file of its own
  bool recording = false; ///< of what was done last, if the run keeps that in memory

  bool ask_anything() const noexcept { return shape || recording; }
  void add(const SaveRequest& more) noexcept {
    shape = shape || more.shape;
    recording = recording || more.recording;
  }
};

} // namespace nendo::flow
