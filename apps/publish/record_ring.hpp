#pragma once
// A ring of slots for records of a few kilobytes. The newest record overwrites the oldest one. The
// writer never looks at the readers. The ring uses memory that the caller gives, which may be
// mapped by other processes.

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstdint>
#include <span>

#include <nendo/base/seq_lock.hpp>

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

} // namespace nendo::publish
