#include "repair/weld.hpp"

#include <cstring>
#include <span>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "support/nasty_meshes.hpp"
#include "support/placed_meshes.hpp"

namespace weld_test {

using namespace nendo::deform;
using namespace nendo::test;

/// Each face with vertices of its own, face after face.
Mesh soup_of(const Mesh& mesh) {
  Mesh loose = mesh;
  loose.vertices.resize(3, static_cast<Eigen::Index>(mesh.face_corners.size()));
  for (std::uint32_t at = 0; at < mesh.face_corners.size(); ++at) {
    loose.vertices.col(at) = mesh.vertices.col(mesh.face_corners[at]);
    loose.face_corners[at] = at;
  }
  return loose;
}

std::string obj_of(const Mesh& mesh) {
  std::string text;
  for (const auto& at : mesh.vertices.colwise())
    text += "v " + std::to_string(at[0]) + " " + std::to_string(at[1]) + " " +
            std::to_string(at[2]) + "\n";
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    text += "f";
    for (std::uint32_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at)
      text += " " + std::to_string(mesh.face_corners[at] + 1);
    text += "\n";
  }
  return text;
}

TEST_SUITE("weld") {
  TEST_CASE("faces that meet edge to edge share vertices, in the order of the first ones") {
    const Mesh whole = cube_of_cells(2, true);
    Mesh loose = soup_of(whole);
    loose.texcoords = loose.vertices.topRows<2>();
    loose.corner_texcoords = loose.face_corners;
    const Mesh before = loose;
    CHECK(is_soup(loose));
    CHECK(weld_places(loose) == 96 - 26);
    CHECK(loose.vertices.cols() == 26);
    CHECK(check_closed_manifold(loose));
    CHECK(volume_of(loose) == doctest::Approx(1.0).epsilon(1e-14));
    CHECK(loose.texcoords == before.texcoords);
    CHECK(loose.corner_texcoords == before.corner_texcoords);
    for (std::size_t at = 0; at < loose.face_corners.size(); ++at)
      CHECK(loose.vertices.col(loose.face_corners[at]) ==
            before.vertices.col(before.face_corners[at]));
    // A vertex is new where no corner before was in its place.
    std::uint32_t next = 0;
    for (const std::uint32_t corner : loose.face_corners) {
      CHECK(corner <= next);
      if (corner == next) ++next;
    }
  }

  TEST_CASE("0 and -0 are one place, and equal words give equal bits") {
    Mesh loose = soup_of(cube_of_cells(2));
    for (Eigen::Index at = 0; at < loose.vertices.cols(); at += 2)
      for (double& number : loose.vertices.col(at))
        if (number == 0.0) number = -0.0;
    Mesh again = loose;
    weld_places(loose);
    weld_places(again);
    CHECK(loose.vertices.cols() == 26);
    CHECK(check_closed_manifold(loose));
    CHECK(std::memcmp(loose.vertices.data(), again.vertices.data(),
                      sizeof(double) * static_cast<std::size_t>(loose.vertices.size())) == 0);
    CHECK(loose.face_corners == again.face_corners);
  }

  TEST_CASE("surfaces that only touch stay apart") {
    const Mesh cube = cube_of_cells(2);
    for (const Eigen::Vector3d& way :
         {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(1, 0, 0)}) {
      Mesh both = soup_of(cube);
      const Mesh other = soup_of(moved(cube, way));
      const auto first = static_cast<std::uint32_t>(both.vertices.cols());
      Points points(3, 2 * both.vertices.cols());
      points << both.vertices, other.vertices;
      both.vertices = points;
      for (const std::uint32_t corner : other.face_corners)
        both.face_corners.push_back(corner + first);
      for (std::size_t face = 0; face < other.face_count(); ++face)
        both.face_starts.push_back(both.face_starts.back() + 3);
      weld_places(both);
      CHECK(both.vertices.cols() == 52);
      CHECK(check_closed_manifold(both));
      CHECK(separate(both).size() == 2);
      CHECK(volume_of(both) == doctest::Approx(2.0).epsilon(1e-14));
    }
  }

  TEST_CASE("both sides of a leaf stay apart, each is one sheet") {
    Mesh leaf = soup_of(grid(3, 1.0));
    const auto first = static_cast<std::uint32_t>(leaf.vertices.cols());
    Points points(3, 2 * leaf.vertices.cols());
    points << leaf.vertices, leaf.vertices;
    leaf.vertices = points;
    for (std::uint32_t corner = first; corner-- > 0;)
      leaf.face_corners.push_back(first + corner); // each face turned
    for (std::size_t face = 0; face < 9; ++face)
      leaf.face_starts.push_back(leaf.face_starts.back() + 4);
    weld_places(leaf);
    CHECK(leaf.vertices.cols() == 32);
    CHECK(separate(leaf).size() == 2);
    CHECK((vertex_normals(leaf).row(2).array().abs() - 1.0).abs().maxCoeff() < 1e-12);
  }

  TEST_CASE("vertices of other groups stay apart") {
    Mesh loose = soup_of(cube_of_cells(1));
    std::vector<std::uint32_t> groups(36, 0);
    std::fill(groups.begin() + 18, groups.end(), 1U);
    weld_places(loose, groups);
    CHECK(loose.vertices.cols() > 8);
  }

  TEST_CASE("a face of which two corners lie in one place holds nothing together") {
    Mesh loose = soup_of(cube_of_cells(1));
    loose.vertices.conservativeResize(3, 39);
    loose.vertices.rightCols<3>() << 0, 0, 1, 0, 0, 0, 0, 0, 0;
    add_face(loose, {36, 37, 38});
    weld_places(loose);
    CHECK(loose.vertices.cols() == 8);
    CHECK(loose.face_corners[36] == loose.face_corners[37]);
    loose.face_starts.pop_back();
    loose.face_corners.resize(36);
    CHECK(check_closed_manifold(loose));
  }

  TEST_CASE("a file without shared vertices is welded, what another one says of vertices holds") {
    const auto read = [](const std::string& text, const ReadOptions& options) {
      const auto model = parse_model(std::as_bytes(std::span(text)), "m.obj", options);
      REQUIRE(model);
      return *model;
    };
    const std::string soup = obj_of(soup_of(cube_of_cells(2)));
    const ReadModel welded = read(soup, {});
    CHECK(welded.mesh.vertices.cols() == 26);
    REQUIRE(welded.notes.size() == 1);
    CHECK(welded.notes[0].find("118 vertices became one") != std::string::npos);
    const ReadModel plain = read(soup, {.up = UpAxis::y, .weld = false});
    CHECK(plain.mesh.vertices.cols() == 144);
    CHECK(plain.notes.empty());
    // Two squares that share a vertex, and two edges that only lie in one place.
    const std::string lips = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\n"
                             "f 1 2 3 4\nf 5 6 7 3\n";
    const ReadModel kept = read(lips, {});
    CHECK(kept.mesh.vertices.cols() == 7);
    CHECK(kept.notes.empty());
  }
}

} // namespace weld_test
