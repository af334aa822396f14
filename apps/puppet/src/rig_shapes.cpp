#include <nendo/puppet/rig_shapes.hpp>

#include <optional>
#include <utility>
#include <vector>

#include <nendo/deform/surface_deformer.hpp>
#include <nendo/deform/type1.hpp>

namespace nendo::puppet {

using deform::Points;

struct RigShapes::Parts {
  Parts(std::shared_ptr<const Rig> of, const deform::Mesh& model,
        const deform::DeformerOptions& options)
      : rig(std::move(of)), shape(model.vertices, options), out(shape.shape()) {}

  std::shared_ptr<const Rig> rig;
  deform::SculptedShape shape;
  deform::BlockShape out;
  std::optional<deform::SurfaceDeformer> along; ///< one of them
  std::optional<deform::Type1Deformer> through;
  double condition = 0.0;
};

RigShapes::RigShapes(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
RigShapes::~RigShapes() = default;

Result<std::unique_ptr<RigShapes>> RigShapes::make(std::shared_ptr<const Rig> rig,
                                                   const deform::Mesh& model) {
  deform::DeformerOptions options;
  options.supports = rig->supports();
  auto parts = std::make_unique<Parts>(std::move(rig), model, options);
  const Points& starts = parts->rig->starts();
  deform::FieldStatus status{};
  if (parts->rig->puppet().distance == Distance::surface) {
    auto field = deform::SurfaceField::make(
        model, parts->shape.layout(),
        surface_setup(parts->rig->puppet(), model, options.csrbf.kernel));
    if (!field) return field.error();
    parts->condition = (*field)->condition();
    status = parts->along.emplace(parts->shape, *std::move(field)).grab(starts);
  } else {
    options.mask = vertex_mask(parts->rig->puppet(), parts->shape.layout(), model.vertices);
    status = parts->through.emplace(parts->shape, starts.cols(), options).grab(starts);
  }
  if (!deform::is_solved(status))
    return Error{Errc::bad_input,
                 "the points cannot grab the model: " + std::string(describe(status))};
  return std::unique_ptr<RigShapes>(new RigShapes(std::move(parts)));
}

const deform::BlockShape& RigShapes::blocks_at(std::span<const double> values) {
  Points ends;
  parts_->rig->place(values, ends);
  return blocks_with(ends);
}

const deform::BlockShape& RigShapes::blocks_with(const Points& ends) {
  if (parts_->along)
    parts_->along->apply(ends, parts_->out);
  else
    parts_->through->apply(ends, parts_->out);
  return parts_->out;
}

Points RigShapes::at(std::span<const double> values) {
  Points vertices;
  parts_->shape.layout().unpack(blocks_at(values), vertices);
  return vertices;
}

Points RigShapes::at(std::size_t function, double value) {
  std::vector<double> values(function + 1, 0.0);
  values.back() = value;
  return at(values);
}

double RigShapes::condition() const noexcept {
  return parts_->condition;
}

const Rig& RigShapes::rig() const noexcept {
  return *parts_->rig;
}

} // namespace nendo::puppet
