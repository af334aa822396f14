#include "bench/refined_clay.hpp"

#include <utility>

#include <nendo/deform/triangles.hpp>

namespace nendo::bench {

RefinedClay::RefinedClay(deform::Mesh model, std::size_t bodies, std::size_t parts_a_body,
                         const deform::ClayOptions& options)
    : bodies_(bodies), parts_a_body_(parts_a_body), options_(options), model_(std::move(model)) {
  take(deform::BlockLayout(model_.vertices), nullptr);
}

void RefinedClay::take(deform::BlockLayout layout, const deform::BlockShape* first) {
  shape_ =
      std::make_unique<deform::SculptedShape>(std::move(layout), deform::DeformerOptions{}, first);
  clay_ = std::make_unique<deform::ClayDeformer>(*shape_, deform::corners_of_triangles(model_),
                                                 bodies_, parts_a_body_, options_);
  shown_ = model_;
}

void RefinedClay::refine(std::span<const deform::ContactPart> parts) {
  const auto refiner = deform::Refiner::make(model_);
  if (!refiner) return;
  deform::Refinement made = refiner->refine(clay_->shape(), shape_->layout(), {});
  if (made.operations.empty()) return;
  model_ = std::move(made.mesh);
  deform::BlockLayout layout(model_.vertices);
  const deform::BlockShape first = deform::shape_in_blocks(made.shape, layout);
  const auto shape_before = std::move(shape_);
  const auto clay_before = std::move(clay_);
  take(std::move(layout), &first);
  clay_->begin(parts);
  clay_->continue_from(*clay_before, true);
}

const deform::Mesh& RefinedClay::shown() {
  shape_->layout().unpack(clay_->shape(), shown_.vertices);
  return shown_;
}

} // namespace nendo::bench
