#pragma once
// Encodes a frame without its vertices as a record of 64-bit words, in the layout of
// nendo_publish.h, with both hands and the CSRBF update; and a ring of such records.

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/base/seq_lock.hpp>
#include <nendo/flow/frame.hpp>
#include <nendo/flow/sculptor.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo_publish.h>

namespace nendo::publish {

using AtomicWord = std::atomic<std::uint64_t>;
static_assert(AtomicWord::is_always_lock_free && sizeof(AtomicWord) == 8);
static_assert(sizeof(SeqLock<>) == 8);

/// Copy words one by one, so that no single word is torn. Wait-free.
inline void store_words(std::span<const std::uint64_t> words, AtomicWord* to) noexcept {
  for (const std::uint64_t word : words)
    (to++)->store(word, std::memory_order_relaxed);
}
inline void load_words(const AtomicWord* from, std::span<std::uint64_t> words) noexcept {
  for (std::uint64_t& word : words)
    word = (from++)->load(std::memory_order_relaxed);
}

/// A ring of slots for records of a few kilobytes. The newest record overwrites the oldest one. The
/// writer never looks at the readers. Other processes may map the memory.
class RecordRing {
public:
  RecordRing() = default;
  /// Record k is in slot k mod `slots`, which has a SeqLock and then the words of the record.
  /// `memory` must have slots * slot_words zeros and must outlive the ring.
  RecordRing(AtomicWord* memory, std::size_t slots, std::size_t slot_words) noexcept
      : memory_(memory), slots_(slots), slot_words_(slot_words) {
    assert(slots > 1 && slot_words > 1);
  }

  /// Writes a record of at most slot_words - 1 words. Numbers begin with 1 and rise by 1. Only one
  /// thread may write. Wait-free.
  void write(std::uint64_t number, std::span<const std::uint64_t> words) noexcept {
    auto& stage = stage_of(number);
    stage.open(number);
    store_words(words.first(std::min(words.size(), slot_words_ - 1)), words_of(number));
    stage.close(number);
  }
  /// Reads the first words of record `number`. Returns false if the ring does not have the record,
  /// or no longer has it. Any thread may read. Wait-free.
  bool read(std::uint64_t number, std::span<std::uint64_t> words) const noexcept {
    const auto& stage = stage_of(number);
    if (!stage.holds(number)) return false;
    load_words(words_of(number), words.first(std::min(words.size(), slot_words_ - 1)));
    return stage.still_holds(number);
  }

  std::size_t slots() const noexcept { return slots_; }

private:
  AtomicWord* slot_of(std::uint64_t number) const noexcept {
    return memory_ + number % slots_ * slot_words_;
  }
  SeqLock<>& stage_of(std::uint64_t number) const noexcept {
    return *reinterpret_cast<SeqLock<>*>(slot_of(number));
  }
  AtomicWord* words_of(std::uint64_t number) const noexcept { return slot_of(number) + 1; }

  AtomicWord* memory_ = nullptr;
  std::size_t slots_ = 0;
  std::size_t slot_words_ = 0;
};

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
  /// The hands that gloves drive, left hand first.
  std::array<std::optional<hand::HandSkeleton>, 2> skeletons{};
};

/// Returns the length, in words, of the longest record of such a loop. It includes the word of the
/// SeqLock.
std::size_t max_record_words(const LoopOutline& outline) noexcept;

/// Returns the head of a frame's record, with both hands but without number, generation, changes of
/// the shape and fields. Wait-free.
nendo_publish_record head_of(const flow::Frame& frame) noexcept;

/// Returns what gloves and trackers report of the hands, and what these touch, without the stage.
/// Wait-free.
nendo_publish_states states_of(const flow::Frame& frame, std::uint64_t number) noexcept;

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
