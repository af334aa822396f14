#pragma once
// Frames of a take, one after another and without a clock, whatever makes them: a recording whose
// loop runs again, or a timeline of edited keys.

#include <nendo/flow/frame.hpp>

namespace nendo::takes {

class FrameSource {
public:
  virtual ~FrameSource() = default;
  /// The model before the first frame. 3 by #vertices, model units.
  virtual const deform::Mesh& model() const = 0;
  virtual const deform::BlockLayout& layout() const = 0; ///< of the frames' shapes
  virtual double rate_hz() const = 0;                    ///< of the frames, as far as it is even
  virtual double duration_s() const = 0;                 ///< time_s() of the last frame
  /// Makes the next frame; false: there is none. May block and allocate.
  virtual bool next() = 0;
  virtual const flow::Frame& frame() const = 0; ///< the latest; not before next()
  virtual double time_s() const = 0;            ///< of the latest, since the take began
  /// Nothing was missing so far, so that the frames are those that were.
  virtual bool is_exact() const { return true; }
};

} // namespace nendo::takes
