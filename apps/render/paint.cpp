#include "render/paint.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/deform/drawn_faces.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::render {

using Eigen::Index;
using Eigen::Vector2f;
using Eigen::Vector3f;

namespace {

// Warm, while the hands are cool, so that they differ at a glance, also without seeing red from
// green.
const Vector3f clay(0.50F, 0.235F, 0.135F);

Vector3f colour_of(const deform::Material* material, bool has_more) {
  if (material != nullptr && material->colour) return material->colour->head<3>();
  return has_more ? Vector3f(Vector3f::Ones()) : clay; // white is coloured by what is on it
}

using Textures = std::vector<std::shared_ptr<const TextureImage>>;

/// Of each material, its texture, decoded; null if there is none.
Textures textures_of(const deform::Mesh& mesh) {
  Textures decoded(mesh.look.textures.size());
  Textures of_materials(mesh.look.materials.size());
  if (mesh.corner_texcoords.empty()) return of_materials;
  // A small file can be a large picture, and a model can have many.
  std::size_t left = std::size_t{1} << 29; // pixels
  std::vector<bool> tried(decoded.size(), false);
  for (std::size_t at = 0; at < of_materials.size(); ++at) {
    const std::uint32_t number = mesh.look.materials[at].texture;
    if (number == deform::no_index) continue;
    const deform::Texture& texture = mesh.look.textures[number];
    if (!tried[number] && texture.contents && left > 0) {
      tried[number] = true;
      if (auto image = decode_picture(*texture.contents)) {
        left -= std::min(left, image->pixels().size());
        decoded[number] = std::make_shared<const TextureImage>(*std::move(image));
      }
    }
    of_materials[at] = decoded[number];
  }
  return of_materials;
}

// Linear. From light to dark, so that it is read without seeing red from green.
const std::array<Vector3f, 5> ramp{
    Vector3f{0.400F, 0.400F, 0.390F}, Vector3f{0.991F, 0.694F, 0.181F},
    Vector3f{0.982F, 0.266F, 0.045F}, Vector3f{0.768F, 0.010F, 0.012F},
    Vector3f{0.216F, 0.000F, 0.019F}};

/// part: 0 to 1.
Vector3f ramp_at(double part) {
  const double place = part * static_cast<double>(ramp.size() - 1);
  const auto before = std::min(static_cast<std::size_t>(place), ramp.size() - 2);
  const auto share = static_cast<float>(place - static_cast<double>(before));
  return (1.0F - share) * ramp[before] + share * ramp[before + 1];
}

double way_of(const deform::Mesh& rest, const deform::Points& shape, Index vertex) {
  const double way = (shape.col(vertex) - rest.vertices.col(vertex)).norm();
  return std::isfinite(way) ? way : 0.0;
}

} // namespace

Paint::Paint(const deform::Mesh& mesh, std::vector<std::uint32_t>& corners) {
  const deform::Appearance& look = mesh.look;
  const auto& colours = look.vertex_colours;
  if (colours.cols() == mesh.vertices.cols())
    for (Index vertex = 0; vertex < colours.cols(); ++vertex)
      vertex_colours_.emplace_back(colours.col(vertex).head<3>());
  const bool coloured_corners = mesh.look.texcoord_colours.cols() > 0;
  const auto faces = deform::drawn_faces(mesh);
  const Textures textures = textures_of(mesh);
  const bool textured = std::any_of(textures.begin(), textures.end(),
                                    [](const auto& texture) { return texture != nullptr; });
  deform::FaceTriangles triangles(mesh);
  corners.clear();
  for (std::size_t at = 0; at < faces.size(); ++at) {
    const auto texture = at == 0 ? nullptr : textures[at - 1];
    Coat coat{corners.size() / 3, 0,
              colour_of(at == 0 ? nullptr : &look.materials[at - 1],
                        !vertex_colours_.empty() || coloured_corners || texture != nullptr),
              texture};
    for (const std::uint32_t face : faces[at])
      for (const deform::Triangle& triangle : triangles.of(face))
        for (const std::uint32_t of : triangle) {
          corners.push_back(mesh.face_corners[of]);
          if (coloured_corners)
            corner_colours_.emplace_back(
                mesh.look.texcoord_colours.col(mesh.corner_texcoords[of]).head<3>());
          if (textured)
            texcoords_.emplace_back(mesh.texcoords.col(mesh.corner_texcoords[of]).cast<float>());
        }
    coat.count = corners.size() / 3 - coat.first;
    if (coat.count == 0) continue;
    coat_of_.insert(coat_of_.end(), coat.count, static_cast<std::uint32_t>(coats_.size()));
    coats_.push_back(std::move(coat));
  }
}

Vector3f Paint::colour_at(std::size_t triangle, const std::array<std::uint32_t, 3>& vertices,
                          const std::array<float, 3>& shares, float samples) const noexcept {
  const Coat& coat = coats_[coat_of_[triangle]];
  Vector3f colour = coat.colour;
  if (!vertex_colours_.empty() || !corner_colours_.empty()) {
    Vector3f mixed = Vector3f::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      mixed += shares[k] * (corner_colours_.empty() ? vertex_colours_[vertices[k]]
                                                    : corner_colours_[3 * triangle + k]);
    colour = colour.cwiseProduct(mixed);
  }
  if (!coat.texture) return colour;
  const Vector2f* const uv = &texcoords_[3 * triangle];
  const Vector2f place = shares[0] * uv[0] + shares[1] * uv[1] + shares[2] * uv[2];
  const Vector2f along = uv[1] - uv[0];
  const Vector2f across = uv[2] - uv[0];
  const Size size = coat.texture->image().size();
  const float area = 0.5F * std::abs(along.x() * across.y() - along.y() * across.x());
  const float pixels =
      std::sqrt(area * static_cast<float>(size.width) * static_cast<float>(size.height));
  return colour.cwiseProduct(
      coat.texture->colour_at(place, samples > 0.0F ? pixels / samples : 0.0F));
}

double farthest_way(const deform::Mesh& rest, const deform::Points& shape) {
  double farthest = 0.0;
  for (Index vertex = 0; vertex < shape.cols(); ++vertex)
    farthest = std::max(farthest, way_of(rest, shape, vertex));
  return farthest;
}

std::shared_ptr<const Paint> paint_by_distance(const deform::Mesh& rest,
                                               const deform::Points& shape, double farthest) {
  deform::Mesh painted = rest; // whose materials decide which triangles are drawn, in what order
  for (deform::Material& material : painted.look.materials) {
    material.colour = Eigen::Vector4f::Ones();
    material.texture = deform::no_index;
  }
  painted.look.texcoord_colours.resize(4, 0);
  painted.look.vertex_colours.setOnes(4, shape.cols());
  for (Index vertex = 0; vertex < shape.cols(); ++vertex)
    painted.look.vertex_colours.col(vertex).head<3>() =
        ramp_at(std::min(1.0, way_of(rest, shape, vertex) / farthest));
  std::vector<std::uint32_t> corners;
  return std::make_shared<const Paint>(painted, corners);
}

} // namespace nendo::render
