#pragma once
// Reads the memory of a published segment (FORMAT.md) whose writer is not trusted: the header is
// copied once and checked, so that a later change of it cannot make a reader leave the memory.
// Needs only nendo_publish.h, so that libraries without the C++ library can use it.

#include <cstddef>
#include <cstdint>

#include <nendo_publish.h>

namespace nendo::publish {

/// All functions are wait-free, without allocation and system call. Any number of threads may read.
class CheckedSegment {
public:
  /// A segment of nothing.
  constexpr CheckedSegment() = default;
  /// `base` is aligned to 8 and has `bytes` readable bytes as long as this is used. What is no
  /// segment of a version that this program reads is a segment of nothing.
  CheckedSegment(const void* base, std::uint64_t bytes) noexcept {
    if (bytes < sizeof header_) return;
    nendo_publish_copy(&header_, base, sizeof header_);
    if (!nendo_publish_is_usable(&header_, bytes)) return;
    base_ = static_cast<const char*>(base);
    bytes_ = bytes;
  }

  /// Returns whether it is a segment. The other functions need one.
  bool is_usable() const noexcept { return base_ != nullptr; }
  const nendo_publish_header& header() const noexcept { return header_; }
  std::uint64_t bytes() const noexcept { return bytes_; }
  std::uint32_t state() const noexcept { return nendo_publish_state(base_); }
  /// Returns the number of the newest record; 0: there is none yet.
  std::uint64_t newest() const noexcept { return nendo_publish_newest(base_); }

  /// Return where the slot of record, states or shape `number` begins.
  std::uint64_t record_at(std::uint64_t number) const noexcept {
    return header_.records_offset + number % header_.record_slots * header_.record_stride;
  }
  std::uint64_t states_at(std::uint64_t number) const noexcept {
    return header_.states_offset + number % header_.record_slots * header_.states_stride;
  }
  std::uint64_t shape_at(std::uint64_t number) const noexcept {
    return header_.shapes_offset + number % header_.shape_slots * header_.shape_stride;
  }
  bool has_states() const noexcept { return header_.states_offset != 0; } ///< since 1.2

  /// Copies `bytes` from `from`, which are guarded by the stage at `stage`. Returns false if
  /// content `number` is not there, or no longer.
  bool copy(std::uint64_t stage, std::uint64_t number, std::uint64_t from, void* to,
            std::uint64_t bytes) const noexcept {
    const auto* const word = reinterpret_cast<const std::uint64_t*>(base_ + stage);
    if (number == 0 || !nendo_publish_holds(word, number)) return false;
    nendo_publish_copy(to, base_ + from, bytes);
    return nendo_publish_still_holds(word, number) != 0;
  }
  /// Copies a content that begins with its stage.
  template <class Content>
  bool copy(std::uint64_t at, std::uint64_t number, Content& content) const noexcept {
    return copy(at, number, at, &content, sizeof content);
  }
  /// Copies the setup of the present generation. Returns false while it is written.
  bool copy_setup(nendo_publish_setup& setup) const noexcept {
    nendo_publish_copy(&setup, base_ + header_.setup_offset, sizeof setup);
    return copy(header_.setup_offset, setup.generation, setup);
  }
  /// Copies what the setup of that generation guards.
  bool copy_of_setup(std::uint64_t generation, std::uint64_t from, void* to,
                     std::uint64_t bytes) const noexcept {
    return copy(header_.setup_offset, generation, from, to, bytes);
  }

private:
  const char* base_ = nullptr;
  std::uint64_t bytes_ = 0;
  nendo_publish_header header_{};
};

} // namespace nendo::publish
