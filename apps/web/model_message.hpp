#pragma once
// The messages that a client needs before it can follow frames: the model and its numbers, and the
// weights of a field along its surface (PROTOCOL.md).

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/surface_field.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/flow/deform_loop.hpp>

namespace nendo::web {

struct ModelFacts {
  std::string name; ///< is displayed
  double rate_hz = 0.0;
  double units_per_metre = 1.0;
};

/// The greatest number of vertices that a browser can be expected to show.
inline constexpr std::size_t max_vertices = 4'000'000;

/// Returns the message. `layout` is that of the loop, and the loop was made from `mesh` and
/// `hands`. Allocates.
std::vector<std::byte> model_message(const deform::BlockLayout& layout, const deform::Mesh& mesh,
                                     std::span<const flow::HandInput> hands,
                                     const ModelFacts& facts);

/// Returns the message with the field's terms, in the order of the model message. They stay in
/// float: the error of a smaller type would be more than clients may have. Allocates.
std::vector<std::byte> weights_message(const deform::SurfaceField& field);

} // namespace nendo::web
