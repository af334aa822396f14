#pragma once
// What a shape was before its last steps: of each step the blocks that it changed, in a ring of a
// fixed size. The oldest steps make room for new ones.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <nendo/deform/block_evaluator.hpp>

namespace nendo::deform {

class ShapeHistory {
public:
  /// Allocates about so many bytes, and for one more shape like this one; nothing afterwards. With
  /// less than a block nothing is ever kept.
  ShapeHistory(const BlockShape& first, std::size_t bytes);

  /// From now on the shape has normals. Allocates for those, too; what was kept is forgotten.
  void carry(const BlockShape& now, const BlockShape& normals);

  /// Ends a step: from what was kept last to this. No step if nothing changed. A step for which
  /// there is no room at all is not kept, nor are those before it. normals: no blocks unless
  /// carried.
  void keep(const BlockShape& now, const BlockShape& normals) noexcept;
  /// Undoes the last step; shape and normals are what was kept last. False: there is none.
  bool undo(BoundedShape& shape, BlockShape& normals) noexcept;

  std::size_t steps() const noexcept { return static_cast<std::size_t>(last_step_ - first_step_); }

private:
  static constexpr std::size_t most_steps = 256;

  struct Saved {
    VertexBlock content;
    std::uint64_t stamp;
    std::size_t block;
  };
  bool is_same(const BlockShape& now, const BlockShape& normals, std::size_t block) const noexcept;
  void save(std::size_t block) noexcept;
  void drop_oldest() noexcept;

  BlockShape kept_, kept_normals_;
  std::vector<Saved> saved_;         ///< a ring
  std::vector<Saved> saved_normals_; ///< in the same places
  std::uint64_t first_saved_ = 0;
  std::uint64_t last_saved_ = 0;
  std::array<std::uint64_t, most_steps> ends_{}; ///< of the steps' saved blocks; a ring
  std::uint64_t first_step_ = 0;
  std::uint64_t last_step_ = 0;
};

} // namespace nendo::deform
