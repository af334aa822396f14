#pragma once
// The defaults with which hands shape a model: how far a finger reaches, where the hands begin, how
// large the model is for them, and how much can be undone.

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

/// The longest side that a model may have on the stage, in metres.
inline constexpr flow::Range model_size_range_m{0.01, 10.0};

/// Returns the longest side of the model on the stage in metres. Hands hold a statue at the
/// fingertips and clay in the palms, and they can take a part.
NENDO_API double usual_size_m(flow::Mode mode) noexcept;

/// Returns one radius for all fingertips, in model units: a fraction of the model's longest side.
/// A finger then shapes what is about it, and neighbours overlap, so that no ridge is left between
/// two that press together.
NENDO_API deform::Supports usual_supports(const deform::Mesh& model, flow::Mode mode);

/// Sets the supports, and the piece length and the distance at which fingertips merge that live
/// hands need with them.
NENDO_API void set_supports(deform::Supports supports, flow::SculptorOptions& sculptor);

/// Sets how many bytes undo has at the beginning, and that it may have `max_bytes`. The
/// asking thread calls ChangeBroker::refill_undo() now and then.
NENDO_API void set_undo_space(const deform::Mesh& model, std::size_t max_bytes,
                              flow::LoopOptions& loop);

struct PlacingOptions {
  flow::Mode mode = flow::Mode::type1;
  double model_size_m = 0.8;  ///< usual_size_m()
  bool is_for_player = false; ///< the hands play a puppet, and are placed before it
};

/// Places the hands at the model, in the poses of their first samples. Stray vertices do not count.
/// Hands that press clay begin beside it. Allocates.
NENDO_API flow::Placement place(const deform::Mesh& model, std::span<const flow::HandInput> hands,
                                const PlacingOptions& options);

/// Makes the loop, whose shape is at first `first`, or the model without it. Errors: failed (the
/// hands cannot grab the model), and those of flow::check_inputs() and check_points().
NENDO_API Result<std::unique_ptr<flow::DeformLoop>>
make_loop(const deform::Mesh& model, const flow::Placement& placement,
          const std::vector<flow::HandInput>& hands, const flow::LoopOptions& options,
          const deform::BlockShape* first = nullptr);

} // namespace nendo::sculpting
