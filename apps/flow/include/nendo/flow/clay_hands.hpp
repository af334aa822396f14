#pragma once
// Hands that press clay or move parts, with the interface that a Sculptor needs.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/contact_part.hpp>
#include <nendo/deform/field_sequence.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/part_mover.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/hand/hand_body.hpp>

namespace nendo::flow {

/// Writes a hand's HandBody::part_count parts, in model units, for a pose on the stage. The surface
/// of each part moves with the part's joint. Wait-free, no allocation.
NENDO_API void contact_parts(hand::HandBody& body, const hand::HandPose& pose,
                             double units_per_metre, std::span<deform::ContactPart> parts) noexcept;

/// Returns T_stage_wrist, moved away from the model's centre until the hand is `clear_m` from all
/// vertices, of which it tests some thousands. Hands must not begin inside clay. Allocates.
NENDO_API Eigen::Isometry3d beside(const deform::Mesh& model, double units_per_metre,
                                   const hand::HandSkeleton& skeleton,
                                   const hand::JointAngles& angles,
                                   const Eigen::Isometry3d& T_stage_wrist, double clear_m);

/// The bodies of one or two hands in their current poses, and the table under the model.
class NENDO_API HandBodies {
public:
  /// Allocates. All hands are in the pose of zero angles.
  HandBodies(std::span<const hand::HandSkeleton> hands, double units_per_metre, const Table& table);

  /// Moves a hand's body; its pose is on the stage. Wait-free, no allocation.
  void follow(std::size_t hand, const hand::HandPose& pose) noexcept;
  /// Returns the parts of the first hand, of the second hand, and of the table; model units.
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

/// Returns the bodies of the present hands, left hand first. The default table is table_under() the
/// model. Allocates.
NENDO_API std::shared_ptr<HandBodies>
make_bodies(const std::array<std::optional<hand::HandSkeleton>, 2>& by_side,
            const deform::Mesh& model, double units_per_metre,
            const std::optional<Table>& table = {});

/// The vertex indices of a model's triangles, three each, and the clay's initial volume, in model
/// units.
struct NENDO_API ClayModel {
  explicit ClayModel(const deform::Mesh& mesh);
  /// For a refined mesh, whose triangles enclose slightly less of the same clay.
  ClayModel(const deform::Mesh& mesh, double first_volume);

  std::vector<std::uint32_t> corners;
  double volume = 0.0; ///< >= 0
};

/// The state of the clay, and of its contact with hands, in a frame. Frame::contacts has the
/// positions.
struct ClayState {
  bool is_clay = false;        ///< the mode is clay; otherwise all other members are 0
  std::uint32_t touching = 0;  ///< the number of contacts of hands with the surface
  double penetration_mm = 0.0; ///< the depth of the surface in a hand before its correction
  double volume = 0.0;         ///< in cubic model units; 0 if the surface is not closed
  double first_volume = 0.0;   ///< the model's volume before the hands

  /// Returns volume / first_volume; 1 if first_volume is 0.
  double volume_part() const noexcept { return first_volume > 0.0 ? volume / first_volume : 1.0; }
};

/// Returns the strength of a contact, 0 to 1: half of it from the static pressure, half from the
/// speed of pressing.
NENDO_API float strength_of(const deform::ClayContact& contact) noexcept;

/// The contact strengths of the fingers, thumb to little finger, and of the palm, 0 to 1.
using HandTouch = std::array<float, hand::finger_count + 1>;
/// Returns the touch of a body, by its index in HandBodies.
NENDO_API HandTouch touch_of(std::span<const deform::ClayContact> contacts,
                             std::size_t body) noexcept;

/// Has the interface of deform::Type2Deformer, but follows the hands' bodies instead of fingertips.
/// Only the constructor allocates.
class NENDO_API ClayHands {
public:
  /// Clay within `radius_m` of a hand, on the stage, yields. Values below min_radius_m are raised
  /// to it, because palms would crease the surface. `shape` must outlive this. With `mirror`, the x
  /// of a plane in model units, the hands' mirror images also press.
  ClayHands(deform::SculptedShape& shape, std::shared_ptr<const ClayModel> model,
            std::shared_ptr<const HandBodies> bodies, double radius_m,
            const deform::DeformerOptions& options, std::optional<double> mirror);
  static constexpr double min_radius_m = 0.020;

  deform::FieldStatus begin(const deform::Points&) { return clay_.begin(parts()); }
  deform::FieldStatus grab(const deform::Points&) { return clay_.grab(parts()); }
  void continue_from(const ClayHands& before, bool keeps_volume) noexcept {
    clay_.continue_from(before.clay_, keeps_volume);
  }
  /// Pushes the surface out of the bodies. With `ends`, completes their whole path.
  deform::FieldStatus follow(const deform::Points&, bool ends);
  void release(bool is_step) noexcept;
  deform::FieldStatus go(deform::HistoryMove move, const deform::Points&) {
    return clay_.go(move, parts());
  }

  /// Always empty: fields cannot describe the effect of hands.
  const deform::FieldSequence& fields() const noexcept { return fields_; }
  deform::ChainReport report() const noexcept { return {}; }
  /// Returns whether the last follow() changed the shape.
  bool is_moved() const noexcept { return is_moved_; }
  ClayState state() const noexcept;
  std::span<const deform::ClayContact> contacts() const noexcept { return clay_.contacts(); }

private:
  /// Returns the parts of the hands, of their mirror images and of the table.
  std::span<const deform::ContactPart> parts() noexcept;

  std::shared_ptr<const ClayModel> model_;
  std::shared_ptr<const HandBodies> bodies_;
  std::optional<double> mirror_;
  std::vector<deform::ContactPart> with_images_;
  deform::ClayDeformer clay_;
  deform::FieldSequence fields_;
  bool is_moved_ = false;
  bool presses_ = false; ///< has pressed since the last release
};

/// The model's parts, and those that hands hold, in a frame.
struct PartsState {
  std::uint32_t count = 0; ///< the number of parts; 0 in other modes
  /// The part that each present hand holds, left hand first; no_index: none.
  std::array<std::uint32_t, 2> held{deform::no_index, deform::no_index};
  /// The part that each present hand would grab, if it is open; no_index: none.
  std::array<std::uint32_t, 2> in_reach{deform::no_index, deform::no_index};
  /// The part that a hand grabbed last; no_index: none of this model yet.
  std::uint32_t chosen = deform::no_index;

  bool is_held() const noexcept {
    return held[0] != deform::no_index || held[1] != deform::no_index;
  }
};

/// Has the interface of deform::PartMover, for hands with fingertips at `tips`, five columns per
/// hand, model units. A hand closes when its thumb is within closed_m of the index or middle
/// finger, and opens beyond open_m. A part turns with the palm, and moves with the midpoint of
/// thumb and fingers. Only the constructor allocates.
class NENDO_API PartHands {
public:
  static constexpr double closed_m = 0.025; ///< between fingertips
  static constexpr double open_m = 0.040;
  static constexpr double reach_m = 0.040; ///< from the midpoint of the tips to a vertex

  /// `shape` must outlive this. Parts with a vertex that `mask` protects do not move.
  PartHands(deform::SculptedShape& shape, std::shared_ptr<const deform::ModelParts> parts,
            std::shared_ptr<const HandBodies> bodies,
            std::shared_ptr<const deform::VertexMask> mask);

  deform::FieldStatus begin(const deform::Points& tips) { return mover_.begin(grips(tips)); }
  deform::FieldStatus grab(const deform::Points& tips) { return mover_.grab(grips(tips)); }
  /// Moves the held parts to the hands, always along the whole path.
  deform::FieldStatus follow(const deform::Points& tips, bool ends) noexcept;
  void release(bool is_step) noexcept;
  deform::FieldStatus go(deform::HistoryMove move, const deform::Points& tips) {
    return mover_.go(move, grips(tips));
  }

  /// Always empty: parts move rigidly.
  const deform::FieldSequence& fields() const noexcept { return fields_; }
  deform::ChainReport report() const noexcept { return {}; }
  bool is_moved() const noexcept { return mover_.is_moved(); } ///< in the last follow()
  PartsState state() const noexcept;
  /// Returns the contacts of hands with held parts, as light contacts with clay.
  std::span<const deform::ClayContact> contacts() const noexcept { return contacts_; }

private:
  static constexpr std::size_t max_places = 24; ///< max contacts per hand

  struct Hand {
    bool is_closed = false;
    std::uint32_t held = deform::no_index; ///< the part that has these places
    std::vector<std::size_t> places{};     ///< in block order
  };

  std::span<const deform::PartGrip> grips(const deform::Points& tips) noexcept;
  void find_places(std::size_t hand) noexcept;
  void update_contacts() noexcept;

  std::shared_ptr<const deform::ModelParts> parts_;
  std::shared_ptr<const HandBodies> bodies_;
  std::vector<Hand> hands_;
  std::uint32_t chosen_ = deform::no_index;
  std::vector<deform::PartGrip> grips_;
  std::vector<deform::ClayContact> contacts_;
  deform::PartMover mover_;
  deform::FieldSequence fields_;
};

} // namespace nendo::flow
