#include "reference/table1.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "bench/table1_paper.hpp"
#include "bench/table1_trial.hpp"
#include "bench/whole_frame.hpp"

namespace table1_test {

using namespace nendo::bench;
using namespace nendo::reference;
using nendo::deform::Mesh;

TEST_SUITE("table1") {
  /// Twice the signed area, seen from above.
  static double double_area(const Mesh& mesh, std::size_t face) {
    const auto corner = [&](std::uint32_t k) {
      return mesh.vertices.col(mesh.face_corners[mesh.face_starts[face] + k]).eval();
    };
    return (corner(1) - corner(0)).cross(corner(2) - corner(0)).z();
  }

  TEST_CASE("the meshes have the paper's counts, and cover the plane once without a seam") {
    constexpr std::array<Eigen::Index, 4> vertices{1089, 4225, 16641, 33025};
    for (std::size_t plane = 0; plane < table1_planes.size(); ++plane) {
      const Mesh mesh = table1_mesh(table1_planes.at(plane));
      CAPTURE(plane);
      CHECK(mesh.vertices.cols() == vertices.at(plane));
      REQUIRE(mesh.face_count() == table1_triangles.at(plane));
      CHECK(mesh.face_corners.size() == 3 * mesh.face_count());
      double sum = 0.0;
      double least = 1.0;
      std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
      for (std::size_t face = 0; face < mesh.face_count(); ++face) {
        least = std::min(least, double_area(mesh, face));
        sum += double_area(mesh, face);
        for (std::uint32_t k = 0; k < 3; ++k)
          edges.insert(std::minmax(mesh.face_corners[3 * face + k],
                                   mesh.face_corners[3 * face + (k + 1) % 3]));
      }
      CHECK(least > 0.0); // all face upwards
      CHECK(sum == doctest::Approx(2.0 * 50.0 * 50.0));
      // Euler's formula for a disc.
      CHECK(mesh.vertices.cols() + static_cast<Eigen::Index>(mesh.face_count()) ==
            static_cast<Eigen::Index>(edges.size()) + 1);
    }
  }

  TEST_CASE("evaluations are pairs nearer than the radius, not as near") {
    nendo::deform::Points vertices(3, 3);
    vertices << 0, 3, 6, 0, 0, 0, 0, 4, 0;
    nendo::deform::Points starts(3, 2);
    starts << 0, 6, 0, 0, 0, 0;
    CHECK(count_evaluations(vertices, starts, 5.0) == 2);
    CHECK(count_evaluations(vertices, starts, 5.001) == 4);
    CHECK(count_evaluations(vertices, starts, 7.0) == 6);
  }

  TEST_CASE("a whole frame draws the deformed plane, and takes longer than its deformation") {
    const Mesh mesh = table1_mesh(table1_planes[0]);
    const auto starts = table1_starts();
    WholeFrame frame(mesh, starts, 20.0);
    CHECK(frame.covered_share() == 0.0);
    const auto whole = frame.measure(0.0);
    // A square from 30 degrees above and 25 degrees beside, in a picture with a margin.
    CHECK(frame.covered_share() > 0.2);
    CHECK(frame.covered_share() < 0.8);
    const auto alone = measure_table1_cell(mesh, starts, 20.0, 0.0).one_thread;
    for (std::size_t type = 0; type < 2; ++type) {
      CHECK(whole[type] > 0.0);
      CHECK(whole[type] < alone[type]);
    }
  }
}

} // namespace table1_test
