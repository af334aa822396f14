#include "shape_history.hpp"

namespace nendo::deform {

ShapeHistory::ShapeHistory(const BlockShape& first, std::size_t bytes)
    : saved_(bytes / sizeof(Saved)) {
  if (!saved_.empty()) kept_ = first;
}

void ShapeHistory::keep(const BlockShape& now) noexcept {
  std::size_t changed = 0;
  for (std::size_t block = 0; block < kept_.block_count(); ++block)
    if (now.stamp(block) != kept_.stamp(block)) ++changed;
  if (changed == 0) return;
  const bool fits = changed <= saved_.size();
  while (steps() > 0 &&
         (!fits || steps() == most_steps || last_saved_ - first_saved_ + changed > saved_.size()))
    drop_oldest();
  for (std::size_t block = 0; block < kept_.block_count(); ++block) {
    if (now.stamp(block) == kept_.stamp(block)) continue;
    if (fits) saved_[last_saved_++ % saved_.size()] = {kept_[block], kept_.stamp(block), block};
    kept_.follow(now, block);
  }
  if (fits) ends_[last_step_++ % most_steps] = last_saved_;
}

void ShapeHistory::drop_oldest() noexcept {
  first_saved_ = ends_[first_step_++ % most_steps];
}

bool ShapeHistory::undo(BoundedShape& shape) noexcept {
  if (steps() == 0) return false;
  --last_step_;
  const std::uint64_t begin = steps() == 0 ? first_saved_ : ends_[(last_step_ - 1) % most_steps];
  while (last_saved_ > begin) {
    const Saved& saved = saved_[--last_saved_ % saved_.size()];
    kept_.data()[saved.block] = saved.content;
    kept_.set_stamp(saved.block, saved.stamp); // the content that this stamp always had
    shape.shape.follow(kept_, saved.block);
    shape.bounds[saved.block] = bounds_of(saved.content);
  }
  return true;
}

} // namespace nendo::deform
