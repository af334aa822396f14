#pragma once
// Clay whose triangles follow its shape, as the loop's worker lets them (flow::ModelVersion), in
// one thread.

#include <cstddef>
#include <memory>
#include <span>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/refinement.hpp>

namespace nendo::bench {

class RefinedClay {
public:
  RefinedClay(deform::Mesh model, std::size_t bodies, std::size_t parts_a_body,
              const deform::ClayOptions& options);

  void begin(std::span<const deform::ContactPart> parts) { clay_->begin(parts); }
  const deform::ClayReport& press_to(std::span<const deform::ContactPart> parts) {
    return clay_->press_to(parts);
  }
  /// Splits and collapses edges, if any is too long or too short, and grabs again at `parts`.
  /// Allocates.
  void refine(std::span<const deform::ContactPart> parts);
  /// Returns the mesh as it was pressed.
  const deform::Mesh& shown();

private:
  void take(deform::BlockLayout layout, const deform::BlockShape* first);

  std::size_t bodies_;
  std::size_t parts_a_body_;
  deform::ClayOptions options_;
  deform::Mesh model_; ///< the model before it was pressed
  deform::Mesh shown_;
  std::unique_ptr<deform::SculptedShape> shape_;
  std::unique_ptr<deform::ClayDeformer> clay_;
};

} // namespace nendo::bench
