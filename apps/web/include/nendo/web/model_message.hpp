#pragma once
// What a client needs before it can follow frames: the model's triangles and numbers
// (PROTOCOL.md).

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/flow/sculptor.hpp>

namespace nendo::web {

struct ModelFacts {
  std::string name; ///< for people
  flow::Mode mode = flow::Mode::type1;
  double rate_hz = 0.0;
  double units_per_metre = 1.0;
  std::array<double, 5> radius_m{}; ///< of each finger, on the stage, thumb to little finger
};

/// A shape message of more is too much for a browser.
inline constexpr std::size_t most_vertices = 4'000'000;

/// layout: the loop's; mesh: what it was made of. Allocates.
std::vector<std::byte> model_message(const deform::BlockLayout& layout, const deform::Mesh& mesh,
                                     const ModelFacts& facts);

} // namespace nendo::web
