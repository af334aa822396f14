#pragma once
// Models far from zero: surveyed ground, a part in its assembly, a scan in world coordinates. A
// float holds a place to a share of its distance from zero. So that nothing depends on that
// distance, the vertices of such a model count from a place beside it (Mesh::offset).

#include <string>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Returns from where the vertices of a mesh should count. On an axis on which the middle of its
/// faces is at most four times its size from zero, this is 0, so that most models stay as their
/// files have them. On another axis it is that middle, to a millionth of the size: the difference
/// to a vertex of a face is then exact, and so is the sum (Sterbenz 1974). In file coordinates.
NENDO_API Eigen::Vector3d usual_offset(const Mesh& mesh) noexcept;

/// Makes the vertices count from that place. The model stays where it is.
NENDO_API void count_from(const Eigen::Vector3d& offset, Mesh& mesh) noexcept;

/// Returns a place of a mesh with that offset as people look for it, in file coordinates:
/// "(0, 1, 2.5)".
NENDO_API std::string place_text(const Eigen::Vector3d& place, const Eigen::Vector3d& offset);

} // namespace nendo::deform
