#pragma once
// Keeps faces of the clay from crossing each other. Where some would after a call, the vertices
// around move as one: a "rigid impact zone" (Provot, "Collision and self-collision handling in
// cloth model dedicated to design garments", 1997), by the mean way of the call, so that none of
// them comes nearer to another.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/vertex_mask.hpp>

#include "clay/face_meetings.hpp"
#include "geometry/union_find.hpp"

namespace nendo::deform {

/// Belongs to one thread. After the constructor nothing allocates.
class ImpactZones {
public:
  /// `triangles` are vertices of the mesh.
  ImpactZones(const BlockLayout& layout, std::span<const std::uint32_t> triangles);

  /// The shape before a call.
  void begin(const BoundedShape& shape) noexcept { before_.follow(shape); }
  /// Lets no faces meet that did not meet at begin(). `volume` has measured the shape, or one that
  /// differs by what has swelled since. Vertices that the mask does not leave free hold their
  /// zones. Returns how many vertices moved as parts of zones; nullopt if the shape is that of
  /// begin() again, because too many would have to.
  std::optional<std::size_t> keep_apart(BoundedShape& shape, const VolumeKeeper& volume,
                                        const VertexMask* mask) noexcept;

private:
  void take_in(const BlockShape& shape, std::uint32_t place) noexcept;
  void join_met(const BlockShape& shape) noexcept;
  void move(BlockShape& shape, const VertexMask* mask, bool stay) noexcept;
  void finish(BoundedShape& shape) noexcept;

  std::size_t vertices_;
  FaceMeetings meetings_;
  BoundedShape before_;
  UnionFind zones_;                     ///< sets of members
  Marks members_;                       ///< places, of all zones
  Marks moved_;                         ///< their blocks
  std::vector<Eigen::Vector3f> wanted_; ///< the wanted place of each member
  std::vector<Eigen::Vector4f> ways_;   ///< scratch: sums and counts, at one place of each zone
};

} // namespace nendo::deform
