#pragma once
// Encodes a frame without its vertices as a record of 64-bit words. The record has both hands and
// the CSRBF update, in the layout of nendo_publish.h.

#include <cstdint>
#include <span>
#include <vector>

#include <nendo/flow/frame.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::publish {

/// The data about a loop that a publisher needs before the first tick. The model and the layout
/// must exist until the loop has ended.
struct LoopOutline {
  const deform::Mesh* model = nullptr; ///< at the beginning of the loop
  const deform::BlockLayout* layout = nullptr;
  flow::Mode mode = flow::Mode::type1;
  double rate_hz = 0.0;
  double units_per_metre = 1.0;
  std::size_t max_fields = 0; ///< the maximum per frame
  std::size_t functions = 0;  ///< the number per field
};

/// Returns the length, in words, of the longest record of such a loop. It includes the word of the
/// SeqLock.
std::size_t max_record_words(const LoopOutline& outline) noexcept;

class FrameRecord {
public:
  FrameRecord() = default;
  /// Allocates all that describe() needs.
  FrameRecord(const LoopOutline& outline, std::uint64_t generation);

  /// Encodes a frame. Wait-free, without allocation. If there is no space for all fields, they are
  /// left out and the record is marked.
  void describe(const flow::Frame& frame, std::uint64_t number,
                std::uint64_t shape_changes) noexcept;

  /// Returns the record of the latest frame, without the word of the SeqLock.
  std::span<const std::uint64_t> words() const noexcept {
    return std::span(words_).subspan(1, used_ - 1);
  }

private:
  std::size_t put_field(const deform::CsrbfField& field, std::size_t at) noexcept;

  std::vector<std::uint64_t> words_;
  std::size_t used_ = 1;
  std::uint64_t generation_ = 0;
};

} // namespace nendo::publish
