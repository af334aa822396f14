#pragma once
// What a client needs before it can follow frames: the model's triangles and numbers
// (PROTOCOL.md).

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/flow/deform_loop.hpp>
#include <nendo/flow/loop_settings.hpp>

namespace nendo::web {

struct ModelFacts {
  std::string name; ///< for people
  double rate_hz = 0.0;
  double units_per_metre = 1.0;
  flow::LoopSettings settings; ///< in force
  bool recorded = false;
};

/// A shape message of more is too much for a browser.
inline constexpr std::size_t most_vertices = 4'000'000;

/// layout: the loop's; mesh, hands: what it was made of. Allocates.
std::vector<std::byte> model_message(const deform::BlockLayout& layout, const deform::Mesh& mesh,
                                     std::span<const flow::HandInput> hands,
                                     const ModelFacts& facts);

} // namespace nendo::web
