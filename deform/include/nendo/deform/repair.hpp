#pragma once
// Closes models whose files are nearly closed: edges that lie in one place but have vertices of
// their own, faces that are turned, and holes.

#include <cstddef>
#include <string>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// A repaired model, and what was done to it.
struct Repair {
  Mesh mesh;
  std::size_t dropped = 0; ///< faces with fewer than three corners, or doubles of others
  std::size_t joined = 0;  ///< vertices at open edges that lay where another one did
  std::size_t turned = 0;  ///< faces that faced another way than their neighbours
  std::size_t filled = 0;  ///< holes
};

/// Repairs a model so that check_closed_manifold() finds no fault in it. Vertices keep their
/// numbers and bits, except that corners may name another vertex in the same place. A hole is
/// filled in the plane that fits it best, by triangles between its corners, without texture.
/// Allocates. Error: bad_input, with what is still wrong and where; the words go behind the model's
/// name.
Result<Repair> repair(const Mesh& mesh);

/// Returns what was done, in words that go behind the model's name: "joined 12 vertices, filled 1
/// hole".
std::string describe(const Repair& repair);

} // namespace nendo::deform
