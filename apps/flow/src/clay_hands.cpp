#include <nendo/flow/clay_hands.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::flow {
namespace {

constexpr double mm_per_metre = 1000.0;

deform::ClayOptions clay_options(const HandBodies& bodies, double radius_m,
                                 const deform::DeformerOptions& deformer) {
  deform::ClayOptions options;
  options.units_per_mm = bodies.units_per_metre() / mm_per_metre;
  options.radius_mm = mm_per_metre * std::max(radius_m, ClayHands::min_radius_m);
  options.still_bodies = HandBodies::tables;
  options.evaluation = deformer.evaluation;
  options.mask = deformer.mask;
  return options;
}

/// Returns the image in the plane x = at. The frame's motion is the image's, and no reflection.
deform::ContactPart image_of(const deform::ContactPart& part, double at) noexcept {
  deform::ContactPart image = part;
  for (Eigen::Vector3d& corner : image.corners)
    corner.x() = 2.0 * at - corner.x();
  const Eigen::Vector3d mirrored(-1.0, 1.0, 1.0);
  image.frame.linear() = mirrored.asDiagonal() * part.frame.linear() * mirrored.asDiagonal();
  image.frame.translation().x() = 2.0 * at - part.frame.translation().x();
  return image;
}

std::size_t bodies_of(const HandBodies& bodies, bool are_mirrored) noexcept {
  return (are_mirrored ? 2 : 1) * bodies.count() + HandBodies::tables;
}

} // namespace

float strength_of(const deform::ClayContact& contact) noexcept {
  constexpr float max_load_mm = 0.5F;
  constexpr float max_pressed_mm = 1.0F;
  return 0.5F * std::clamp(contact.load_mm / max_load_mm, 0.0F, 1.0F) +
         0.5F * std::clamp(contact.pressed_mm / max_pressed_mm, 0.0F, 1.0F);
}

HandTouch touch_of(std::span<const deform::ClayContact> contacts, std::size_t body) noexcept {
  constexpr std::size_t bones = 3; // of a finger: HandBody::parts()
  HandTouch touch{};
  for (const deform::ClayContact& contact : contacts) {
    if (contact.body != body) continue;
    float& strongest = touch[std::min<std::size_t>(contact.part / bones, hand::finger_count)];
    strongest = std::max(strongest, strength_of(contact));
  }
  return touch;
}

ClayModel::ClayModel(const deform::Mesh& mesh)
    : ClayModel(mesh, std::abs(deform::volume_of(mesh))) {}

ClayModel::ClayModel(const deform::Mesh& mesh, double first_volume)
    : corners(deform::corners_of_triangles(mesh)), volume(first_volume) {}

ClayHands::ClayHands(deform::SculptedShape& shape, std::shared_ptr<const ClayModel> model,
                     std::shared_ptr<const HandBodies> bodies, double radius_m,
                     const deform::DeformerOptions& options, std::optional<double> mirror)
    : model_(std::move(model)), bodies_(std::move(bodies)), mirror_(mirror),
      with_images_(mirror ? bodies_of(*bodies_, true) * hand::HandBody::part_count : 0),
      clay_(shape, model_->corners, bodies_of(*bodies_, mirror.has_value()),
            hand::HandBody::part_count, clay_options(*bodies_, radius_m, options)) {}

std::span<const deform::ContactPart> ClayHands::parts() noexcept {
  const auto own = bodies_->parts();
  if (!mirror_) return own;
  const auto hands = own.first(bodies_->count() * hand::HandBody::part_count);
  auto to = std::copy(hands.begin(), hands.end(), with_images_.begin());
  to = std::transform(hands.begin(), hands.end(), to,
                      [&](const auto& part) { return image_of(part, *mirror_); });
  const auto table = own.subspan(hands.size());
  std::copy(table.begin(), table.end(), to);
  return with_images_;
}

deform::FieldStatus ClayHands::follow(const deform::Points&, bool ends) {
  is_moved_ = false;
  presses_ = true;
  constexpr int max_calls = 64; // so that a tick ends, however far a hand has jumped
  for (int call = 0; call < max_calls; ++call) {
    const deform::ClayReport& report = clay_.press_to(parts());
    is_moved_ = is_moved_ || report.is_moved;
    if (!ends || !is_solved(report.status) || report.behind_mm <= 0.0) break;
  }
  return clay_.report().status;
}

void ClayHands::release(bool is_step) noexcept {
  clay_.release(is_step);
  is_moved_ = presses_ = false;
}

ClayState ClayHands::state() const noexcept {
  const deform::ClayReport& report = clay_.report();
  return {.is_clay = true,
          .touching = static_cast<std::uint32_t>(clay_.contacts().size()),
          .penetration_mm = presses_ ? report.penetration_mm : 0.0,
          .behind_mm = presses_ ? report.behind_mm : 0.0,
          .volume = std::abs(clay_.volume()),
          .first_volume = clay_.volume() != 0.0 ? model_->volume : 0.0};
}

} // namespace nendo::flow
