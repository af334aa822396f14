#include "gl/model.hpp"

#include <algorithm>
#include <cstdlib>

#include "gl/buffers.hpp"
#include "gl/shaders.hpp"
#include "render/lights.hpp"

namespace nendo::gl {

using deform::block_size;
using Eigen::Vector3f;

namespace {

/// Returns whether each edge of the triangles belongs to two, which go along it in opposite
/// directions, and the surface encloses a positive volume: then what faces away is never seen.
bool encloses(const std::vector<std::uint32_t>& corners, const std::vector<Vector3f>& places) {
  std::vector<std::uint64_t> edges; // each in the direction of its triangle, and the other way
  edges.reserve(corners.size());
  double volume = 0.0;
  for (std::size_t at = 0; at + 2 < corners.size(); at += 3) {
    for (std::size_t side = 0; side < 3; ++side)
      edges.push_back(std::uint64_t{corners[at + side]} << 32 | corners[at + (side + 1) % 3]);
    volume += static_cast<double>(
        places[corners[at]].dot(places[corners[at + 1]].cross(places[corners[at + 2]])));
  }
  std::sort(edges.begin(), edges.end());
  return volume > 0.0 && std::adjacent_find(edges.begin(), edges.end()) == edges.end() &&
         std::all_of(edges.begin(), edges.end(), [&](std::uint64_t edge) {
           return std::binary_search(edges.begin(), edges.end(), edge << 32 | edge >> 32);
         });
}

} // namespace

Model::Model() {
  glGenBuffers(3, buffers_.data());
  glGenTextures(2, textures_.data());
  glGenBuffers(1, &indices_);
  glGenBuffers(1, &coarse_indices_);
}

Model::~Model() {
  glDeleteBuffers(1, &coarse_indices_);
  glDeleteBuffers(1, &indices_);
  glDeleteTextures(2, textures_.data());
  glDeleteBuffers(3, buffers_.data());
}

void Model::set(const deform::BlockLayout& layout, const render::SceneBuilder& builder) {
  const std::vector<std::uint32_t> place_of = layout.places();
  corners_.clear();
  for (const std::uint32_t corner : builder.corners())
    corners_.push_back(place_of[corner]);
  scale_ = static_cast<float>(layout.unit() / builder.units_per_metre());
  offset_ = (layout.origin() / builder.units_per_metre() - builder.origin_m()).cast<float>();
  places_.assign(layout.block_count() * block_size, Vector3f::Zero());
  normals_.clear();
  paint_ = builder.paint();
  std::vector<Vector3f> colours(places_.size(), Vector3f::Ones());
  for (std::size_t vertex = 0; vertex < paint_->vertex_colours().size(); ++vertex)
    colours[place_of[vertex]] = paint_->vertex_colours()[vertex];
  for (const std::size_t which : {0U, 1U}) { // of the right size; follow() sets the contents
    fill_buffer(GL_TEXTURE_BUFFER, buffers_[which], colours, GL_DYNAMIC_DRAW);
    glBindTexture(GL_TEXTURE_BUFFER, textures_[which]);
    glTexBuffer(GL_TEXTURE_BUFFER, GL_R32F, buffers_[which]);
  }
  fill_buffer(GL_ARRAY_BUFFER, buffers_[2], colours, GL_STATIC_DRAW);
  // GL_ELEMENT_ARRAY_BUFFER would change the bound vertex array.
  fill_buffer(GL_ARRAY_BUFFER, indices_, corners_, GL_STATIC_DRAW);
  pictures_.set(*paint_, corners_, colours);
  is_closed_.reset();
  refine();
  is_whole_ = false;
  blocks_sent_ = 0;
}

void Model::send_block(std::size_t which, std::size_t block,
                       const std::vector<Vector3f>& vectors) const {
  constexpr std::size_t bytes = block_size * sizeof(Vector3f);
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[which]);
  glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(block * bytes),
                  static_cast<GLsizeiptr>(bytes), &vectors[block * block_size]);
}

void Model::follow(const deform::BlockShape& shape) {
  if (!is_whole_)
    shape_ = deform::BlockShape(std::vector<deform::VertexBlock>(shape.block_count()));
  bool changed = false;
  for (std::size_t block = 0; block < shape.block_count(); ++block) {
    if (is_whole_ && shape_.stamp(block) == shape.stamp(block)) continue;
    shape_.follow(shape, block);
    for (std::size_t lane = 0; lane < block_size; ++lane)
      places_[block * block_size + lane] = scale_ * deform::vertex_in(shape[block], lane) + offset_;
    send_block(0, block, places_);
    ++blocks_sent_;
    changed = true;
  }
  if (!changed) return;
  is_whole_ = true;
  send_normals();
  constexpr float far_m = 1e3F; // what is beyond, or nowhere, casts no shadow
  box_.setEmpty();
  for (const Vector3f& place : places_)
    if (place.cwiseAbs().maxCoeff() < far_m) box_.extend(place);
}

void Model::send_normals() {
  render::compute_normals(places_, corners_, new_normals_);
  for (std::size_t block = 0; block < shape_.block_count(); ++block) {
    const auto first = static_cast<std::ptrdiff_t>(block * block_size);
    const auto begin = new_normals_.begin() + first;
    if (normals_.empty() || !std::equal(begin, begin + block_size, normals_.begin() + first))
      send_block(1, block, new_normals_);
  }
  normals_.swap(new_normals_);
}

bool Model::has_one_coat() const noexcept {
  return paint_->coats().size() == 1 && paint_->texcoords().empty() &&
         paint_->vertex_colours().empty() && paint_->corner_colours().empty();
}

void Model::coarsen(int cubes) {
  constexpr int max_cubes = 200;
  cubes = std::clamp(cubes, 1, max_cubes + 1);
  if (4 * std::abs(cubes - coarse_cubes_) < coarse_cubes_) return;
  if (!is_closed_) is_closed_ = encloses(corners_, places_);
  coarse_cubes_ = cubes;
  coarse_count_ = 0;
  if (cubes > max_cubes) return;
  const std::vector<std::uint32_t> corners = render::coarse_corners(places_, corners_, cubes);
  if (2 * corners.size() > corners_.size()) return; // saves little
  coarse_count_ = corners.size();
  fill_buffer(GL_ARRAY_BUFFER, coarse_indices_, corners, GL_STATIC_DRAW);
}

void Model::bind_vertices() const {
  for (GLuint which = 0; which < 3; ++which) {
    glBindBuffer(GL_ARRAY_BUFFER, buffers_[which]);
    glEnableVertexAttribArray(which);
    glVertexAttribPointer(which, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  }
}

void Model::draw(bool coarse) const {
  bind_vertices();
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, coarse ? coarse_indices_ : indices_);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(coarse ? coarse_count_ : corners_.size()),
                 GL_UNSIGNED_INT, nullptr);
}

// Where there is a texture, a vertex has several texture coordinates, and it may have several
// colours; then each corner is drawn by itself, and the shader looks up its vertex.
void Model::draw_coats(unsigned program) const {
  bind_vertices();
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  bind_texture(Unit::vertex_places, GL_TEXTURE_BUFFER, textures_[0]);
  bind_texture(Unit::vertex_normals, GL_TEXTURE_BUFFER, textures_[1]);
  pictures_.bind();
  const bool corner_colours = !paint_->corner_colours().empty();
  for (std::size_t at = 0; at < paint_->coats().size(); ++at) {
    const render::Coat& coat = paint_->coats()[at];
    const auto count = static_cast<GLsizei>(3 * coat.count);
    gl::set(program, "colour", coat.colour);
    const bool textured = pictures_.use(at);
    gl::set(program, "textured", textured ? 1 : 0);
    gl::set(program, "by_corners", textured || corner_colours ? 1 : 0);
    const std::size_t offset = 3 * coat.first * sizeof(std::uint32_t);
    if (textured || corner_colours)
      glDrawArrays(GL_TRIANGLES, static_cast<GLint>(3 * coat.first), count);
    else
      // OpenGL takes offsets as pointers. NOLINTNEXTLINE(performance-no-int-to-ptr)
      glDrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offset));
  }
}

} // namespace nendo::gl
