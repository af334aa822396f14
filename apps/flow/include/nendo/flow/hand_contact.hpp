#pragma once
// Hands as the bodies that press clay.

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/contact_part.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/hand/hand_body.hpp>

namespace nendo::flow {

/// Writes the parts of a hand in that pose, on the stage, into HandBody::part_count parts in model
/// units. Each part's surface goes with the joint that carries it. Wait-free, no allocation.
NENDO_API void contact_parts(hand::HandBody& body, const hand::HandPose& pose,
                             double units_per_metre, std::span<deform::ContactPart> parts) noexcept;

/// Returns T_stage_wrist, moved away from the model's middle until the hand is `clear_m` from all
/// vertices, of which some thousands are looked at. Hands that begin to press clay must not be in
/// it. Allocates.
NENDO_API Eigen::Isometry3d beside(const deform::Mesh& model, double units_per_metre,
                                   const hand::HandSkeleton& skeleton,
                                   const hand::JointAngles& angles,
                                   const Eigen::Isometry3d& T_stage_wrist, double clear_m);

/// The bodies of one hand or two, where they are now, and the table on which the model lies.
class NENDO_API HandBodies {
public:
  /// Allocates. All hands are in the pose of zero angles.
  HandBodies(std::span<const hand::HandSkeleton> hands, double units_per_metre, const Table& table);

  /// Moves a hand's body; its pose is on the stage. Wait-free, no allocation.
  void follow(std::size_t hand, const hand::HandPose& pose) noexcept;
  /// Returns the parts of the first hand, then those of the next, and of the table; model units.
  std::span<const deform::ContactPart> parts() const noexcept { return parts_; }
  std::size_t count() const noexcept { return bodies_.size(); } ///< the number of hands
  static constexpr std::size_t tables = 1;
  const Table& table() const noexcept { return table_; }
  double units_per_metre() const noexcept { return units_per_metre_; }

private:
  std::vector<hand::HandBody> bodies_;
  std::vector<deform::ContactPart> parts_;
  Table table_;
  double units_per_metre_;
};

/// Returns the bodies of the hands that there are, by side, left hand first. Without a table it is
/// table_under() the model. Allocates.
NENDO_API std::shared_ptr<HandBodies>
make_bodies(const std::array<std::optional<hand::HandSkeleton>, 2>& by_side,
            const deform::Mesh& model, double units_per_metre,
            const std::optional<Table>& table = {});

} // namespace nendo::flow
