#include "shape_history.hpp"

namespace nendo::deform {

ShapeHistory::ShapeHistory(const BlockShape& first, std::size_t bytes)
    : saved_(bytes / sizeof(Saved)) {
  if (!saved_.empty()) kept_ = first;
}

void ShapeHistory::carry(const BlockShape& now, const BlockShape& normals) {
  if (saved_.empty()) return;
  kept_.follow(now);
  kept_normals_ = normals;
  saved_normals_.resize(saved_.size());
  first_saved_ = last_saved_;
  first_step_ = last_step_;
}

bool ShapeHistory::is_same(const BlockShape& now, const BlockShape& normals,
                           std::size_t block) const noexcept {
  return now.stamp(block) == kept_.stamp(block) &&
         (saved_normals_.empty() || normals.stamp(block) == kept_normals_.stamp(block));
}

void ShapeHistory::save(std::size_t block) noexcept {
  const std::size_t at = last_saved_++ % saved_.size();
  saved_[at] = {kept_[block], kept_.stamp(block), block};
  if (!saved_normals_.empty())
    saved_normals_[at] = {kept_normals_[block], kept_normals_.stamp(block), block};
}

void ShapeHistory::keep(const BlockShape& now, const BlockShape& normals) noexcept {
  std::size_t changed = 0;
  for (std::size_t block = 0; block < kept_.block_count(); ++block)
    if (!is_same(now, normals, block)) ++changed;
  if (changed == 0) return;
  const bool fits = changed <= saved_.size();
  while (steps() > 0 &&
         (!fits || steps() == most_steps || last_saved_ - first_saved_ + changed > saved_.size()))
    drop_oldest();
  for (std::size_t block = 0; block < kept_.block_count(); ++block) {
    if (is_same(now, normals, block)) continue;
    if (fits) save(block);
    kept_.follow(now, block);
    if (!saved_normals_.empty()) kept_normals_.follow(normals, block);
  }
  if (fits) ends_[last_step_++ % most_steps] = last_saved_;
}

void ShapeHistory::drop_oldest() noexcept {
  first_saved_ = ends_[first_step_++ % most_steps];
}

bool ShapeHistory::undo(BoundedShape& shape, BlockShape& normals) noexcept {
  if (steps() == 0) return false;
  --last_step_;
  const std::uint64_t begin = steps() == 0 ? first_saved_ : ends_[(last_step_ - 1) % most_steps];
  // A content comes back with the stamp that it always had.
  const auto restore = [](const Saved& saved, BlockShape& kept, BlockShape& now) {
    kept.data()[saved.block] = saved.content;
    kept.set_stamp(saved.block, saved.stamp);
    now.follow(kept, saved.block);
  };
  while (last_saved_ > begin) {
    const std::size_t at = --last_saved_ % saved_.size();
    restore(saved_[at], kept_, shape.shape);
    shape.bounds[saved_[at].block] = bounds_of(saved_[at].content);
    if (!saved_normals_.empty()) restore(saved_normals_[at], kept_normals_, normals);
  }
  return true;
}

} // namespace nendo::deform
