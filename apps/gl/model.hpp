#pragma once
// A model on the graphics card. Uploads only blocks with changed stamps. All calls: the thread with
// the OpenGL context, with a vertex array bound.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/deform/vertex_blocks.hpp>

#include "gl/textures.hpp"
#include "render/scene.hpp"

namespace nendo::gl {

class Model {
public:
  Model();
  ~Model();
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  /// Sets the triangles, the colours, and the layout of the blocks. There is nothing to draw until
  /// follow().
  void set(const deform::BlockLayout& layout, const render::SceneBuilder& builder);
  void clear() noexcept { is_whole_ = false, box_.setEmpty(); }
  /// Uploads the blocks that changed since the last call, and the affected normals.
  void follow(const deform::BlockShape& shape);

  bool is_there() const noexcept { return is_whole_ && !corners_.empty(); }
  std::uint64_t blocks_sent() const noexcept { return blocks_sent_; } ///< since set()
  /// Returns the box at the last follow(), in metres of the scene.
  const Eigen::AlignedBox3f& box() const noexcept { return box_; }
  /// Indices into the blocks, three per triangle.
  const std::vector<std::uint32_t>& corners() const noexcept { return corners_; }
  const render::Paint& paint() const noexcept { return *paint_; }
  /// Returns whether all triangles have one colour, without textures.
  bool has_one_coat() const noexcept;

  /// Chooses fewer triangles for moving pictures, by the present shape: those between the cubes of
  /// a grid with so many along the box's longest side. Keeps the previous choice for a similar
  /// grid. All triangles if fewer would save little.
  void coarsen(int cubes);
  /// Goes back to all triangles.
  void refine() noexcept { coarse_cubes_ = 0, coarse_count_ = 0; }
  bool is_coarse() const noexcept { return coarse_count_ > 0; }
  /// Returns whether nothing behind the surface can be seen; false before coarsen().
  bool is_closed() const noexcept { return is_closed_.value_or(false); }

  /// Selects the vertices for drawing.
  void bind_vertices() const;
  /// Draws all triangles, or the fewer ones.
  void draw(bool coarse) const;
  /// Draws each coat with its colour and its texture, by Fragments::surface, which must be in use.
  void draw_coats(unsigned program) const;

private:
  void send_block(std::size_t which, std::size_t block,
                  const std::vector<Eigen::Vector3f>& vectors) const;
  void send_normals();

  std::array<unsigned, 3> buffers_{};  ///< positions, normals and colours of vertices
  std::array<unsigned, 2> textures_{}; ///< through which shaders read the first two by index
  unsigned indices_ = 0;
  unsigned coarse_indices_ = 0;
  std::size_t coarse_count_ = 0;  ///< corners; 0: all triangles
  int coarse_cubes_ = 0;          ///< the grid of the choice; 0: none yet
  std::optional<bool> is_closed_; ///< nothing: not yet computed
  std::vector<std::uint32_t> corners_;
  std::shared_ptr<const render::Paint> paint_;
  ModelTextures pictures_;
  deform::BlockShape shape_; ///< the uploaded shape
  std::vector<Eigen::Vector3f> places_, normals_, new_normals_;
  Eigen::AlignedBox3f box_;
  Eigen::Vector3f offset_ = Eigen::Vector3f::Zero(); ///< from the blocks' coordinates to the scene
  float scale_ = 1.0F;
  bool is_whole_ = false; ///< the whole shape is uploaded
  std::uint64_t blocks_sent_ = 0;
};

} // namespace nendo::gl
