#pragma once
// Finds faces of the clay that have come to meet. Nearly all of them cannot: those of two blocks
// whose boxes are apart, and those that look to one side (Volino and Magnenat-Thalmann, "Efficient
// self-collision detection on smoothly discretized surface animations", 1994). What a VolumeKeeper
// measures shows which blocks' faces do. The rest is tested exactly.

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "clay/volume_keeper.hpp"
#include "field/block_evaluator.hpp"
#include "geometry/rows_by_key.hpp"
#include "geometry/space.hpp"

namespace nendo::deform {

/// A set of numbers below a bound that is emptied in the time that its members take. After the
/// constructor nothing allocates.
class Marks {
public:
  explicit Marks(std::size_t bound) : is_in_(bound, 0) { members_.reserve(bound); }

  bool has(std::uint32_t number) const noexcept { return is_in_[number] != 0; }
  /// Returns whether it is new.
  bool add(std::uint32_t number) noexcept {
    if (has(number)) return false;
    is_in_[number] = 1;
    members_.push_back(number);
    return true;
  }
  void clear() noexcept {
    for (const std::uint32_t number : members_)
      is_in_[number] = 0;
    members_.clear();
  }
  /// In the order in which they came.
  std::span<const std::uint32_t> members() const noexcept { return members_; }

private:
  std::vector<std::uint8_t> is_in_;
  std::vector<std::uint32_t> members_;
};

/// Belongs to one thread. After the constructor nothing allocates.
class FaceMeetings {
public:
  using Triangle = std::uint32_t; ///< in the order of the blocks of their first places

  /// `triangles` are vertices of the mesh.
  FaceMeetings(const BlockLayout& layout, std::span<const std::uint32_t> triangles);

  /// Finds the pairs that meet in the shape, and did not in `before`. `volume` has measured the
  /// shape, or one that differs by what has swelled since.
  void find(const BoundedShape& shape, const BlockShape& before,
            const VolumeKeeper& volume) noexcept;
  /// Finds those of the faces at these places, which have moved since find().
  void find_at(std::span<const std::uint32_t> places, const BlockShape& shape,
               const BlockShape& before) noexcept;
  std::span<const std::pair<Triangle, Triangle>> pairs() const noexcept { return met_; }
  /// Returns whether the search was given up, because clay is crumpled all over.
  bool is_given_up() const noexcept;
  const Corners& corners(Triangle triangle) const noexcept { return corners_[triangle]; }

private:
  using BlockPair = std::pair<std::uint32_t, std::uint32_t>;

  static std::uint32_t block_of(const Corners& corners) noexcept;
  void order_by_x(const BlockLayout& layout);
  void begin(const BoundedShape& shape, const VolumeKeeper& volume) noexcept;
  void list_pairs(const BlockShape& shape, const BlockShape& before,
                  std::span<const RingFacts> facts) noexcept;
  bool has_face_away(const BlockShape& shape, std::uint32_t block) const noexcept;
  Eigen::Vector3f direction_at(std::uint32_t place) const noexcept;
  bool is_uneven(const BlockShape& shape, std::uint32_t place) noexcept;
  BlockBounds box_of(const BlockShape& shape, Triangle triangle) const noexcept;
  void measure_boxes(const BlockShape& shape, std::uint32_t block) noexcept;
  void search(BlockPair blocks, const BlockShape& shape, const BlockShape& before) noexcept;
  void test(Triangle one, Triangle other, const BlockShape& shape,
            const BlockShape& before) noexcept;
  bool meet(const BlockShape& shape, Triangle one, Triangle other) const noexcept;

  std::vector<Corners> corners_;               ///< places, of each triangle
  std::vector<std::uint32_t> first_triangles_; ///< the first triangle of each block, and the end
  RowsByKey<std::uint32_t> triangles_at_;      ///< the triangles at each place
  std::vector<std::uint32_t> order_;           ///< blocks, by their lowest x
  std::vector<BlockBounds> boxes_;             ///< a box around each block's triangles, and more
  std::array<std::vector<float>, 5> rows_;     ///< these, as order_ and BoxRows have them
  Marks boxed_;                                ///< blocks of which these are known:
  std::vector<BlockBounds> hulls_, triangle_boxes_;
  std::vector<BlockPair> pairs_;        ///< blocks whose faces may meet
  bool is_crowded_ = false;             ///< there are more
  std::vector<std::uint8_t> is_folded_; ///< a flag per block: some face looks away, or nearly
  std::span<const RingBlock> rings_;    ///< the blocks' rings, from find() on
  Marks uneven_;                        ///< places where some face looks away
  Marks gone_round_;                    ///< places of which that is known
  std::vector<Triangle> some_, others_; ///< scratch for search()
  Marks around_;                        ///< triangles of find_at()
  std::vector<std::uint32_t> near_;     ///< blocks near these
  std::size_t tests_ = 0, boxes_compared_ = 0; ///< since find()
  std::vector<std::pair<Triangle, Triangle>> met_;
};

} // namespace nendo::deform
