#include <nendo/flow/clay_hands.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::flow {
namespace {

constexpr double mm_a_metre = 1000.0;

deform::ClayOptions clay_options(const HandBodies& bodies, double radius_m,
                                 const deform::DeformerOptions& deformer) {
  deform::ClayOptions options;
  options.units_a_mm = bodies.units_per_metre() / mm_a_metre;
  options.radius_mm = mm_a_metre * std::max(radius_m, ClayHands::least_radius_m);
  options.still_bodies = HandBodies::tables;
  options.evaluation = deformer.evaluation;
  options.mask = deformer.mask;
  return options;
}

} // namespace

float strength_of(const deform::ClayContact& contact) noexcept {
  constexpr float most_load_mm = 0.5F;
  constexpr float most_pressed_mm = 1.0F;
  return 0.5F * std::clamp(contact.load_mm / most_load_mm, 0.0F, 1.0F) +
         0.5F * std::clamp(contact.pressed_mm / most_pressed_mm, 0.0F, 1.0F);
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
    : corners(deform::corners_of_triangles(mesh)), volume(std::abs(deform::volume_of(mesh))) {}

ClayHands::ClayHands(deform::SculptedShape& shape, std::shared_ptr<const ClayModel> model,
                     std::shared_ptr<const HandBodies> bodies, double radius_m,
                     const deform::DeformerOptions& options)
    : model_(std::move(model)), bodies_(std::move(bodies)),
      clay_(shape, model_->corners, bodies_->count() + HandBodies::tables,
            hand::HandBody::part_count, clay_options(*bodies_, radius_m, options)) {}

deform::FieldStatus ClayHands::press(bool ends) {
  is_moved_ = false;
  presses_ = true;
  constexpr int most_calls = 64; // so that a tick ends, however far a hand has jumped
  for (int call = 0; call < most_calls; ++call) {
    const deform::ClayReport& report = clay_.press_to(bodies_->parts());
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
