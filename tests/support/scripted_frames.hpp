#pragma once
// Frames that a test makes up.

#include <functional>
#include <utility>
#include <vector>

#include "support/flow_fixtures.hpp"
#include "takes/frame_source.hpp"

namespace nendo::test {

/// Gives frames at the times that a test wants. A frame's tick is its number.
class ScriptedFrames final : public takes::FrameSource {
public:
  explicit ScriptedFrames(std::vector<double> times_s, double rate_hz = 90.0)
      : model_(ball(3)), layout_(model_.vertices), times_s_(std::move(times_s)), rate_hz_(rate_hz) {
    frame_.shape = layout_.pack();
  }
  const deform::Mesh& model(std::uint32_t) const override { return model_; }
  const deform::BlockLayout& layout(std::uint32_t) const override { return layout_; }
  double rate_hz() const override { return rate_hz_; }
  double duration_s() const override { return times_s_.empty() ? 0.0 : times_s_.back(); }
  bool next() override {
    if (made_ == times_s_.size()) return false;
    frame_.tick = made_++;
    if (change) change(frame_);
    return true;
  }
  const flow::Frame& frame() const override { return frame_; }
  double time_s() const override { return times_s_[made_ - 1]; }

  std::function<void(flow::Frame& frame)> change{}; ///< of each, by its tick

private:
  deform::Mesh model_;
  deform::BlockLayout layout_;
  std::vector<double> times_s_;
  double rate_hz_;
  std::size_t made_ = 0;
  flow::Frame frame_;
};

} // namespace nendo::test
