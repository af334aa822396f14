#include <nendo/deform/clay.hpp>

#include "clay/clay_work.hpp"
#include "history/sculpted_parts.hpp"

namespace nendo::deform {

ClayDeformer::ClayDeformer(SculptedShape& shape, std::span<const std::uint32_t> triangles,
                           std::size_t bodies, std::size_t parts_a_body, const ClayOptions& options)
    : shape_(&shape),
      work_(std::make_unique<Work>(shape, triangles, bodies, parts_a_body, options)) {}
ClayDeformer::~ClayDeformer() = default;
ClayDeformer::ClayDeformer(ClayDeformer&&) noexcept = default;
ClayDeformer& ClayDeformer::operator=(ClayDeformer&&) noexcept = default;

FieldStatus ClayDeformer::begin(std::span<const ContactPart> parts) {
  if (!work_->accepts(parts)) return FieldStatus::not_finite;
  shape_->parts().keep();
  return take_hold(parts);
}

void ClayDeformer::go_on_from(const ClayDeformer& before, bool keeps_volume) noexcept {
  work_->go_on_from(*before.work_, keeps_volume);
}

void ClayDeformer::release(bool is_step) noexcept {
  if (is_step) shape_->parts().keep();
  work_->release();
}

const ClayReport& ClayDeformer::press_to(std::span<const ContactPart> parts) {
  report_ = {};
  if (!work_->accepts(parts)) {
    report_.status = FieldStatus::not_finite;
  } else if (!work_->holds()) {
    report_.status = begin(parts);
  } else {
    work_->press(shape_->parts().change(), parts, report_);
  }
  return report_;
}

std::span<const ClayContact> ClayDeformer::contacts() const noexcept {
  return work_->contacts();
}

double ClayDeformer::volume() const noexcept {
  return work_->volume();
}

FieldStatus ClayDeformer::take_hold(std::span<const ContactPart> parts) {
  if (!work_->accepts(parts)) return FieldStatus::not_finite;
  work_->take_hold(shape_->parts().now, parts);
  return FieldStatus::ok;
}

FieldStatus ClayDeformer::go(HistoryMove move, std::span<const ContactPart> parts) {
  if (move == HistoryMove::redo && shape_->redo_steps() == 0) return FieldStatus::ok;
  if (!work_->accepts(parts)) return FieldStatus::not_finite;
  shape_->parts().go(move);
  return take_hold(parts);
}

} // namespace nendo::deform
