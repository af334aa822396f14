#pragma once
// The messages that a client needs before it can follow frames: the model and its numbers, and the
// weights of a field along its surface (PROTOCOL.md).
// The model's textures, for clients.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/surface_field.hpp>
#include <nendo/deform/vertex_blocks.hpp>
#include <nendo/flow/deform_loop.hpp>

namespace nendo::web {

/// By their numbers in deform::Appearance::textures; null where there is no picture.
using Pictures = std::vector<std::shared_ptr<const std::string>>;

/// Returns the textures as PNG or JPEG, which browsers show: a TGA or a BMP becomes a PNG, and
/// takes its time. A file of another kind, which a model may name as well, is not sent to anyone.
/// None if the model has no texture coordinates.
Pictures pictures_of(const deform::Mesh& mesh);
/// Returns whether a texture, by its first bytes alone, is among pictures_of(); a damaged one is
/// not.
bool has_picture(const deform::Mesh& mesh, std::uint32_t texture) noexcept;

/// Parses the number of a picture: up to six decimal digits.
std::optional<std::size_t> picture_number(std::string_view text) noexcept;

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
