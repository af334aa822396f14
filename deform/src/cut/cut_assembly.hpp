#pragma once
// Makes the mesh after a cut: faces that were not crossed, pieces of those that were, and
// cut faces.

#include <cstdint>
#include <vector>

#include <nendo/deform/cut.hpp>

#include "cut/cut_cap.hpp"
#include "cut/cut_surface.hpp"

namespace nendo::deform {

/// A cut that is ready to be made.
struct ChosenCut {
  const Mesh& mesh;
  const Blade& blade;
  double blade_offset;
  double diagonal;
  std::vector<std::uint8_t> keeps; ///< whether each loop is cut
  Cap cap;
  bool faces_inwards = false; ///< the whole model does
  const CutOptions& options;
};

/// The cut mesh, and what a check of it needs.
struct CutAssembly {
  Mesh mesh;
  std::vector<CutVertex> added;
  std::size_t first_cut_face = 0; ///< half of the faces from here close the upper side, then the
                                  ///< lower
  std::vector<std::uint32_t> crossing_vertices; ///< each crossing's vertex on the upper side;
                                                ///< the lower one follows
  std::vector<std::uint32_t> cut_pieces;        ///< faces that are parts of crossed ones
};

/// Adds texture coordinates to `surface`. Allocates.
CutAssembly assemble(const ChosenCut& cut, CutSurface& surface);

/// Numbers the connected parts in the order of their first vertices. Vertices without faces have
/// no_index. Returns their number.
std::uint32_t number_parts(const Mesh& mesh, std::vector<std::uint32_t>& part_of_vertex);

/// Returns so many parts as meshes of their own, by the part of each vertex; no_index: of none.
std::vector<Mesh> separated(const Mesh& mesh, const std::vector<std::uint32_t>& part_of_vertex,
                            std::uint32_t count);

} // namespace nendo::deform
