#pragma once
// The steps of repairing a model (repair.cpp): steps.cpp splits edges at vertices that lie on them,
// as CAD programs leave them, and drops double faces; turning.cpp orients faces; holes.cpp fills
// holes.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

struct SplitJunctions {
  std::size_t count = 0;    ///< corners that were put in
  bool is_too_many = false; ///< there are too many open edges to be looked at: nothing was done
};

/// Puts vertices of open edges into open edges on which they lie, within the tolerance, as more
/// corners of the face there. `place_of` has one entry for each corner, and gets those of new ones.
/// Allocates.
SplitJunctions split_at_junctions(Mesh& mesh, std::vector<std::uint32_t>& place_of,
                                  double tolerance);

/// Drops faces with the same places as a face before, whichever way they face. Two faces back to
/// back stay where they and their neighbours alike are the wall between two bodies.
/// `place_of` has one entry for each corner, and loses those of dropped faces. Returns how many.
/// Allocates.
std::size_t drop_double_faces(Mesh& mesh, std::vector<std::uint32_t>& place_of);

/// A part whose holes stay open.
struct UnfilledPart {
  std::uint32_t vertex; ///< one of it
  std::string why;      ///< the words follow the part's name
  std::string remedy;
};

struct FilledHoles {
  std::size_t count = 0;
  std::size_t crossing = 0;           ///< holes whose lid goes through the model, as each lid would
  std::vector<UnfilledPart> unfilled; ///< some of whose holes may be closed, but not counted
};

/// Closes holes by triangles between their corners: in the plane that fits the rim best, or, where
/// that folds or goes through the model, as the least area. A lid looks as the face beside it. A
/// part stays open if it is a sheet, which a lid would only double, or if a rim is too long and too
/// crooked. Faces around each vertex must form one fan, open or closed. Error: bad_input, with the
/// place: they do not. Allocates.
Result<FilledHoles> fill_holes(Mesh& mesh);

struct TurnedAlike {
  std::size_t turned = 0;
  /// The places of an edge at which a surface comes back to itself turned, as a Möbius strip does.
  /// Then no face is turned.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> one_sided;
  std::vector<std::uint32_t> one_sided_faces; ///< the faces of all such surfaces
};

/// Turns faces so that each faces as its neighbours do, over all edges with two faces. Of faces
/// that hang together the fewer are turned. `place_of` has one entry for each corner, and keeps
/// being right. Allocates.
TurnedAlike turn_alike(Mesh& mesh, std::vector<std::uint32_t>& place_of);

} // namespace nendo::deform
