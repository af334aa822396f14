#pragma once
// The messages that a client needs before frames: the model, and the weights of a field along its
// surface (PROTOCOL.md). Also the model's textures.

#include <cstddef>
#include <cstdint>
#include <map>
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

/// Index: as in deform::Appearance::textures; null: no picture.
using Pictures = std::vector<std::shared_ptr<const std::string>>;

/// The pictures of forms by their numbers, of which none is that of a texture.
using FormPictures = std::map<std::size_t, std::shared_ptr<const std::string>>;
inline constexpr std::size_t first_form_picture = 1'000'000;

/// Returns the textures as PNG or JPEG, for browsers. Slowly converts TGA and BMP to PNG. Files of
/// other types, which a model may also name, are never sent. Empty if the model has no texture
/// coordinates.
Pictures pictures_of(const deform::Mesh& mesh);
/// Returns whether a texture's first bytes are of a type in pictures_of(), which omits damaged
/// files.
bool has_picture(const deform::Mesh& mesh, std::uint32_t texture) noexcept;

/// Parses the number of a picture: up to nine decimal digits.
std::optional<std::size_t> picture_number(std::string_view text) noexcept;

struct ModelFacts {
  std::string name; ///< the displayed name
  double rate_hz = 0.0;
  double units_per_metre = 1.0;
};

/// The max number of vertices that browsers can be expected to show.
inline constexpr std::size_t max_vertices = 4'000'000;

/// Returns the model message. `layout` is that of the loop, which was made from `mesh` and `hands`.
/// Allocates.
std::vector<std::byte> model_message(const deform::BlockLayout& layout, const deform::Mesh& mesh,
                                     std::span<const flow::HandInput> hands,
                                     const ModelFacts& facts);

/// Returns the message with the field's terms, in the order of the model message, as float: a
/// smaller type would exceed the clients' allowed error. Allocates.
std::vector<std::byte> weights_message(const deform::SurfaceField& field);

} // namespace nendo::web
