#pragma once
// The frames of another source, and how many of them were made.

#include <memory>
#include <utility>

#include "takes/frame_source.hpp"

namespace nendo::test {

class CountedFrames final : public takes::FrameSource {
public:
  explicit CountedFrames(std::unique_ptr<takes::FrameSource> source) : source_(std::move(source)) {}

  std::uint64_t made = 0;
  bool says_one_model = true; ///< otherwise has_one_model() is false whatever the source says

  const deform::Mesh& model(std::uint32_t version) const override {
    return source_->model(version);
  }
  const deform::BlockLayout& layout(std::uint32_t version) const override {
    return source_->layout(version);
  }
  bool has_one_model() const override { return says_one_model && source_->has_one_model(); }
  std::optional<takes::PlayedPuppet> puppet() const override { return source_->puppet(); }
  const puppet::Rig* masks() const override { return source_->masks(); }
  double rate_hz() const override { return source_->rate_hz(); }
  double duration_s() const override { return source_->duration_s(); }
  bool next() override {
    const bool is_made = source_->next();
    made += is_made ? 1U : 0U;
    return is_made;
  }
  const flow::Frame& frame() const override { return source_->frame(); }
  double time_s() const override { return source_->time_s(); }
  std::optional<bool> is_calibrated(Side side) const override {
    return source_->is_calibrated(side);
  }
  bool is_exact() const override { return source_->is_exact(); }

private:
  std::unique_ptr<takes::FrameSource> source_;
};

} // namespace nendo::test
