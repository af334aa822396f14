#pragma once
// Records of a few kilobytes in slots, the newest over the oldest, for readers that the writer
// never looks at. It lives where it is told to: in memory that other processes map, or in this
// one's.

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

/// Copies without tearing a word. Wait-free.
void store_words(std::span<const std::uint64_t> words, AtomicWord* to) noexcept;
void load_words(const AtomicWord* from, std::span<std::uint64_t> words) noexcept;

class RecordRing {
public:
  RecordRing() = default;
  /// Record k is in slot k mod `slots`: a SeqLock, then its words. `memory` has slots *
  /// slot_words zeros, and outlives this.
  RecordRing(AtomicWord* memory, std::size_t slots, std::size_t slot_words) noexcept
      : memory_(memory), slots_(slots), slot_words_(slot_words) {
    assert(slots > 1 && slot_words > 1);
  }

  /// Writer, wait-free. Numbers begin with 1 and rise by 1; at most slot_words - 1 words.
  void write(std::uint64_t number, std::span<const std::uint64_t> words) noexcept {
    auto& stage = stage_of(number);
    stage.open(number);
    store_words(words.first(std::min(words.size(), slot_words_ - 1)), words_of(number));
    stage.close(number);
  }
  /// Any reader, wait-free: the first words of record `number`. False: it is not there (any more).
  bool read(std::uint64_t number, std::span<std::uint64_t> words) const noexcept {
    const auto& stage = stage_of(number);
    if (!stage.holds(number)) return false;
    load_words(words_of(number), words.first(std::min(words.size(), slot_words_ - 1)));
    return stage.still_holds(number);
  }

  std::size_t slots() const noexcept { return slots_; }
  std::size_t slot_words() const noexcept { return slot_words_; }

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
