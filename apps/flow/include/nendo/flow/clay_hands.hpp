#pragma once
// Hands that press clay, with the interface that a Sculptor needs.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/field_sequence.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/flow/hand_contact.hpp>

namespace nendo::flow {

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

} // namespace nendo::flow
