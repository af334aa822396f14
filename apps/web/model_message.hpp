#pragma once
// The message that a client needs before it can follow frames: the model and its numbers
// (PROTOCOL.md).

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/flow/deform_loop.hpp>

namespace nendo::web {

struct ModelFacts {
  std::string name; ///< for display
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

} // namespace nendo::web
