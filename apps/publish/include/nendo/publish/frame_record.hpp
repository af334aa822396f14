#pragma once
// A frame without its vertices as a record of 64-bit words: both hands and the CSRBF update, as
// nendo_publish.h lays them out.

#include <cstdint>
#include <span>
#include <vector>

#include <nendo/flow/frame.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::publish {

/// What a publisher must know of a loop before its first tick. The model and the layout must live
/// until the loop has ended.
struct LoopOutline {
  const deform::Mesh* model = nullptr; ///< as the loop begins
  const deform::BlockLayout* layout = nullptr;
  flow::Mode mode = flow::Mode::type1;
  double rate_hz = 0.0;
  double units_per_metre = 1.0;
  std::size_t most_fields = 0; ///< of a frame
  std::size_t functions = 0;   ///< of a field
};

/// How long the longest record of such a loop is, with its stage.
std::size_t most_record_words(const LoopOutline& outline) noexcept;

class FrameRecord {
public:
  FrameRecord() = default;
  /// Allocates.
  FrameRecord(const LoopOutline& outline, std::uint64_t generation);

  /// Wait-free, no allocation. What there is no room for is left out, and marked as such.
  void describe(const flow::Frame& frame, std::uint64_t number,
                std::uint64_t shape_changes) noexcept;

  /// Of the frame described last, without the stage.
  std::span<const std::uint64_t> words() const noexcept {
    return std::span(words_).subspan(1, used_ - 1);
  }

private:
  std::size_t put_field(const deform::CsrbfField& field, std::size_t at) noexcept;

  std::vector<std::uint64_t> words_;
  std::size_t used_ = 1;
  std::uint64_t generation_ = 0;
  std::uint32_t mode_ = 0;
};

} // namespace nendo::publish
