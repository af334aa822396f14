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

/// The corners of a model's triangles, three each, and the volume that the clay had at first, in
/// the model's own units.
struct NENDO_API ClayModel {
  explicit ClayModel(const deform::Mesh& mesh);
  /// For a mesh that was refined: the clay is the same, and its other triangles enclose a little
  /// less.
  ClayModel(const deform::Mesh& mesh, double first_volume);

  std::vector<std::uint32_t> corners;
  double volume = 0.0; ///< >= 0
};

/// What the hands do to clay in a frame, and did before. Frame::contacts has the places.
struct ClayState {
  bool is_clay = false;        ///< the mode is clay; otherwise all else is 0
  std::uint32_t touching = 0;  ///< places at which hands touch the surface
  double penetration_mm = 0.0; ///< how deep the surface was left in a hand, before it was set right
  double behind_mm = 0.0;      ///< the path of a hand that is left for the next tick
  double volume = 0.0;         ///< now, in cubic model units; 0 if the surface is not closed
  double first_volume = 0.0;   ///< the model's volume before the hands

  /// Returns the volume, relative to the first one; 1 if there is none.
  double volume_part() const noexcept { return first_volume > 0.0 ? volume / first_volume : 1.0; }
};

/// Returns how hard a hand presses there, from 0 to 1: half of it by the pressure that stays, half
/// by how fast it presses on.
NENDO_API float strength_of(const deform::ClayContact& contact) noexcept;

/// How hard each finger, thumb to little finger, and the palm press, from 0 to 1.
using HandTouch = std::array<float, hand::finger_count + 1>;
/// Returns the touch of a body, by its index in HandBodies.
NENDO_API HandTouch touch_of(std::span<const deform::ClayContact> contacts,
                             std::size_t body) noexcept;

/// Its functions do what those of deform::Type2Deformer do; the bodies, and not the fingertips,
/// give the hands' positions. None but the constructors allocates.
class NENDO_API ClayHands {
public:
  /// `radius_m` is the distance from a hand within which clay yields, on the stage; less than
  /// min_radius_m counts as that, because palms crease the surface otherwise. `shape` must outlive
  /// this. With a `mirror`, the x of a plane in model units, the hands' mirror images press as
  /// well.
  ClayHands(deform::SculptedShape& shape, std::shared_ptr<const ClayModel> model,
            std::shared_ptr<const HandBodies> bodies, double radius_m,
            const deform::DeformerOptions& options, std::optional<double> mirror);
  static constexpr double min_radius_m = 0.020;

  deform::FieldStatus begin(const deform::Points&) { return clay_.begin(parts()); }
  deform::FieldStatus grab(const deform::Points&) { return clay_.grab(parts()); }
  void go_on_from(const ClayHands& before, bool keeps_volume) noexcept {
    clay_.go_on_from(before.clay_, keeps_volume);
  }
  /// Presses the surface out of where the bodies are now. With `ends`, their whole path is made.
  deform::FieldStatus follow(const deform::Points&, bool ends);
  void release(bool is_step) noexcept;
  deform::FieldStatus go(deform::HistoryMove move, const deform::Points&) {
    return clay_.go(move, parts());
  }

  /// Always empty: no short formula describes what hands do.
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
  bool presses_ = false; ///< since the last release
};

/// The parts that hands hold in a frame.
struct PartsState {
  std::uint32_t count = 0; ///< the number of parts; 0: another mode is in effect
  /// The part that each hand holds, of the hands that are present, left hand first; none: no_index.
  std::array<std::uint32_t, 2> held{deform::no_index, deform::no_index};
  /// The part that a hand has taken last; no_index if none has taken any of this model's.
  std::uint32_t chosen = deform::no_index;

  bool is_held() const noexcept {
    return held[0] != deform::no_index || held[1] != deform::no_index;
  }
};

/// Its functions do what those of deform::PartMover do, for hands whose fingertips are at `tips`,
/// five columns per hand, model units. A hand is closed if its thumb has met the index or the
/// middle finger, until these are farther apart again. A part turns with the palm, and goes with
/// the middle between thumb and fingers. None but the constructor allocates.
class NENDO_API PartHands {
public:
  static constexpr double closed_m = 0.025; ///< from tip to tip
  static constexpr double open_m = 0.040;
  static constexpr double reach_m = 0.040; ///< from between the tips to a vertex

  /// `shape` must outlive this. Parts with a protected vertex in `mask` stay.
  PartHands(deform::SculptedShape& shape, std::shared_ptr<const deform::ModelParts> parts,
            std::shared_ptr<const HandBodies> bodies,
            std::shared_ptr<const deform::VertexMask> mask);

  deform::FieldStatus begin(const deform::Points& tips) { return mover_.begin(grips(tips)); }
  deform::FieldStatus grab(const deform::Points& tips) { return mover_.grab(grips(tips)); }
  /// Moves what is held to where the hands are, always the whole path.
  deform::FieldStatus follow(const deform::Points& tips, bool ends) noexcept;
  void release(bool is_step) noexcept;
  deform::FieldStatus go(deform::HistoryMove move, const deform::Points& tips) {
    return mover_.go(move, grips(tips));
  }

  /// Always empty: a part moves as a whole, and others stay.
  const deform::FieldSequence& fields() const noexcept { return fields_; }
  deform::ChainReport report() const noexcept { return {}; }
  bool is_moved() const noexcept { return mover_.is_moved(); } ///< in the last follow()
  PartsState state() const noexcept;
  /// Returns where hands hold parts, as if these were clay that they touch lightly.
  std::span<const deform::ClayContact> contacts() const noexcept { return contacts_; }

private:
  static constexpr std::size_t max_places = 24; ///< the limit of a hand's contacts

  struct Hand {
    bool is_closed = false;
    std::uint32_t held = deform::no_index; ///< the part of these places
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
