#include <bit>

#include <nendo_publish.h>

#include "publish/segment.hpp"

namespace nendo::publish {
namespace {

constexpr std::size_t shape_head_words = sizeof(nendo_publish_shape) / 8;

} // namespace

std::size_t shape_slot_words(std::size_t vertices) noexcept {
  return shape_head_words + (3 * vertices + 1) / 2;
}

ShapeRing::ShapeRing(AtomicWord* memory, std::size_t slots, std::size_t slot_words,
                     std::size_t vertices)
    : memory_(memory), slot_words_(slot_words), vertices_(vertices),
      stamps_(slots, Stamps(deform::block_count_of(vertices), 0)) {
  assert(slots > 1 && slot_words >= shape_slot_words(vertices));
}

// Vertices are three floats, and two vertices share a word: they are stored as floats.
void ShapeRing::write_block(const deform::BlockShape& shape, std::size_t block,
                            AtomicWord* slot) noexcept {
  using AtomicFloat = std::atomic<std::uint32_t>;
  static_assert(AtomicFloat::is_always_lock_free && sizeof(AtomicFloat) == sizeof(float));
  auto* const floats = reinterpret_cast<AtomicFloat*>(slot + shape_head_words);
  const deform::VertexBlock& from = shape[block];
  const std::size_t first = block * deform::block_size;
  const std::size_t count = std::min(deform::block_size, vertices_ - first);
  const std::uint32_t* const order = layout_->order().data() + first;
  for (std::size_t at = 0; at < count; ++at) {
    AtomicFloat* const to = floats + 3 * std::size_t{order[at]};
    to[0].store(std::bit_cast<std::uint32_t>(from.x[at]), std::memory_order_relaxed);
    to[1].store(std::bit_cast<std::uint32_t>(from.y[at]), std::memory_order_relaxed);
    to[2].store(std::bit_cast<std::uint32_t>(from.z[at]), std::memory_order_relaxed);
  }
}

void ShapeRing::write(std::uint64_t number, const deform::BlockShape& shape) noexcept {
  Stamps& here = stamps_[number % stamps_.size()];
  const Stamps& before = stamps_[(number - 1) % stamps_.size()];
  assert(layout_ != nullptr && shape.block_count() == here.size());
  AtomicWord* const slot = memory_ + number % stamps_.size() * slot_words_;
  auto& stage = *reinterpret_cast<SeqLock<>*>(slot);
  stage.open(number);
  bool changed = false;
  for (std::size_t block = 0; block < here.size(); ++block) {
    const std::uint64_t stamp = shape.stamp(block);
    changed = changed || stamp != before[block];
    if (stamp == here[block]) continue;
    write_block(shape, block, slot);
    here[block] = stamp;
  }
  if (changed) ++changes_;
  slot[1].store(number, std::memory_order_relaxed);
  slot[2].store(changes_, std::memory_order_relaxed);
  stage.close(number);
}

} // namespace nendo::publish
