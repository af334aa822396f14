#include "publish/record_ring.hpp"

namespace nendo::publish {

void store_words(std::span<const std::uint64_t> words, AtomicWord* to) noexcept {
  for (const std::uint64_t word : words)
    (to++)->store(word, std::memory_order_relaxed);
}

void load_words(const AtomicWord* from, std::span<std::uint64_t> words) noexcept {
  for (std::uint64_t& word : words)
    word = (from++)->load(std::memory_order_relaxed);
}

} // namespace nendo::publish
