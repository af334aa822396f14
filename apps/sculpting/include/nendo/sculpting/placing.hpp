#pragma once
// Default radii, initial hand poses, model size and undo memory.

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/supports.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/setting.hpp>

namespace nendo::sculpting {

/// The valid longest sides of a model on the stage, in metres.
inline constexpr flow::Range model_size_range_m{0.01, 10.0};

/// Returns the model's default longest side on the stage, in metres. It depends on whether
/// fingertips, palms or grabbed parts shape.
NENDO_API double usual_size_m(flow::Mode mode) noexcept;

/// Returns one radius for all fingertips, in model units: a fraction of the model's longest side.
/// Adjacent fingers overlap, so that two that press together leave no ridge between them.
NENDO_API deform::Supports usual_supports(const deform::Mesh& model, flow::Mode mode);

/// Sets the supports, and the piece length and merge distance of fingertips for them.
NENDO_API void set_supports(deform::Supports supports, flow::SculptorOptions& sculptor);

/// Sets the initial undo memory, and its limit `max_bytes`. The asking thread must call
/// ChangeBroker::refill_undo() regularly.
NENDO_API void set_undo_space(const deform::Mesh& model, std::size_t max_bytes,
                              flow::LoopOptions& loop);

struct PlacingOptions {
  flow::Mode mode = flow::Mode::type1;
  double model_size_m = 0.8;  ///< usual_size_m()
  bool is_for_player = false; ///< the hands play a puppet (flow::place_player())
};

/// Places the hands at the model, in the poses of their first samples. Ignores stray vertices.
/// Hands for clay begin beside it. Allocates.
NENDO_API flow::Placement place(const deform::Mesh& model, std::span<const flow::HandInput> hands,
                                const PlacingOptions& options);

/// Makes the loop. `first` is its initial shape; null: the model. Errors: failed (the hands cannot
/// grab the model), and those of flow::check_inputs() and check_points().
NENDO_API Result<std::unique_ptr<flow::DeformLoop>>
make_loop(const deform::Mesh& model, const flow::Placement& placement,
          const std::vector<flow::HandInput>& hands, const flow::LoopOptions& options,
          const deform::BlockShape* first = nullptr);

} // namespace nendo::sculpting
