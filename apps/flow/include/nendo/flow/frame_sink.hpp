#pragma once
// A sink takes every frame of a loop. A single reader that needs only the newest frame uses
// DeformLoop::frames() instead.

#include <nendo/flow/frame.hpp>

namespace nendo::flow {

class NENDO_API FrameSink {
public:
  virtual ~FrameSink() = default;
  /// Takes a frame. Loop's thread: it is a part of the tick, so it must be wait-free, without
  /// allocation, lock or system call.
  virtual void show(const Frame& frame) noexcept = 0;
};

} // namespace nendo::flow
