#include "reference/table1.hpp"

#include <cstdint>

namespace nendo::reference {

deform::Mesh table1_mesh(const Table1Plane& plane) {
  deform::Mesh mesh;
  mesh.vertices = table1_plane(plane.cells, plane.with_middles);
  const auto cells = static_cast<std::uint32_t>(plane.cells);
  const std::uint32_t side = cells + 1;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.face_corners.insert(mesh.face_corners.end(), {a, b, c});
    mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
  };
  for (std::uint32_t row = 0; row < cells; ++row)
    for (std::uint32_t column = 0; column < cells; ++column) {
      const std::uint32_t corner = row * side + column;
      const std::array<std::uint32_t, 4> round{corner, corner + 1, corner + side + 1,
                                               corner + side};
      if (plane.with_middles) {
        const std::uint32_t middle = side * side + row * cells + column;
        for (std::size_t k = 0; k < 4; ++k)
          add(round[k], round[(k + 1) % 4], middle);
      } else {
        add(round[0], round[1], round[2]);
        add(round[0], round[2], round[3]);
      }
    }
  return mesh;
}

std::size_t count_evaluations(const deform::Points& vertices, const deform::Points& starts,
                              double radius) {
  Eigen::Index count = 0;
  for (const auto start : starts.colwise())
    count +=
        ((vertices.colwise() - start).colwise().squaredNorm().array() < radius * radius).count();
  return static_cast<std::size_t>(count);
}

} // namespace nendo::reference
