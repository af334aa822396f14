// What the export writes is what the reader of glTF reads.

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/subdivision.hpp>

#include "export/gltf_model.hpp"
#include "support/nasty_meshes.hpp"
#include "support/six_colours.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"

namespace gltf_read_back_test {

using namespace nendo;
using namespace nendo::exporting;

namespace {

/// A ball of three materials, with colours, and a seam in its texture along a meridian.
deform::Mesh painted_ball() {
  deform::Mesh mesh = test::sphere(9, 16, 2.0);
  mesh.look.materials = {
      {"skin", Eigen::Vector4f(0.5F, 0.25F, 0.125F, 1.0F), 0, true},
      {"shell", Eigen::Vector4f(1.0F, 1.0F, 1.0F, 0.0F), deform::no_index, false},
      {"glass", Eigen::Vector4f(0.1F, 0.2F, 0.3F, 0.75F), deform::no_index, true}};
  mesh.look.textures = {{"skin.png", std::make_shared<const std::string>("\x89PNG\r\n\x1A\nrest")}};
  mesh.look.vertex_colours.resize(4, mesh.vertices.cols());
  for (Eigen::Index vertex = 0; vertex < mesh.vertices.cols(); ++vertex)
    mesh.look.vertex_colours.col(vertex)
        << 0.1F + 0.8F * static_cast<float>(vertex) / static_cast<float>(mesh.vertices.cols()),
        0.5F, 0.25F, 1.0F;
  mesh.texcoords.resize(2, mesh.vertices.cols() + 20);
  for (Eigen::Index at = 0; at < mesh.texcoords.cols(); ++at)
    mesh.texcoords.col(at) << static_cast<double>(at) / 256.0, 0.25;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    mesh.look.face_materials.push_back(static_cast<std::uint32_t>(face % 3));
    for (auto at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at) {
      const std::uint32_t vertex = mesh.face_corners[at];
      const bool seam = face < 9 && vertex < 20;
      mesh.corner_texcoords.push_back(
          seam ? static_cast<std::uint32_t>(mesh.vertices.cols()) + vertex : vertex);
    }
  }
  return mesh;
}

deform::Mesh read_back(const deform::Mesh& mesh, double units_per_metre) {
  const test::TemporaryFolder folder;
  GlbFile file("test");
  const GltfModel model(mesh, file);
  const GltfMaterials materials(mesh.look, file);
  model.add_to(file, materials, units_per_metre, {});
  file["scenes"] = GlbFile::Json::array({{{"nodes", {model.node()}}}});
  REQUIRE(file.write(folder.path() / "model.glb"));
  auto back = deform::read_mesh(folder.path() / "model.glb");
  REQUIRE_MESSAGE(back, back.error().message);
  return *std::move(back);
}

/// Of each vertex of a model that was read back, the nearest one of the model. The parts that share
/// a material bring the vertices in another order.
std::vector<std::uint32_t> given_vertices(const deform::Mesh& back, const deform::Mesh& mesh,
                                          double units) {
  std::vector<std::uint32_t> given;
  for (Eigen::Index at = 0; at < back.vertices.cols(); ++at) {
    Eigen::Index nearest = 0;
    const double gap = (mesh.vertices.colwise() - back.vertices.col(at) * units)
                           .colwise()
                           .norm()
                           .minCoeff(&nearest);
    CHECK(gap < 1e-6);
    given.push_back(static_cast<std::uint32_t>(nearest));
  }
  return given;
}

/// The triangles of a material, as vertices from the least one on, sorted. `given` has the number
/// to use for each vertex, or is empty.
std::vector<std::array<std::uint32_t, 3>>
triangles_of(const deform::Mesh& mesh, const std::string& material,
             const std::vector<std::uint32_t>& given = {}) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const deform::Material* const of = mesh.look.material_of(face);
    if ((of == nullptr ? "" : of->name) != material) continue;
    const auto begin = mesh.face_starts[face];
    for (auto at = begin + 2; at < mesh.face_starts[face + 1]; ++at) {
      std::array triangle{mesh.face_corners[begin], mesh.face_corners[at - 1],
                          mesh.face_corners[at]};
      if (!given.empty())
        for (std::uint32_t& vertex : triangle)
          vertex = given[vertex];
      std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                  triangle.end());
      triangles.push_back(triangle);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

void check_read_back(const deform::Mesh& mesh) {
  const double units = 4.0;
  const deform::Mesh back = read_back(mesh, units);
  REQUIRE(back.vertices.cols() == mesh.vertices.cols());
  const std::vector<std::uint32_t> given = given_vertices(back, mesh, units);
  REQUIRE(back.look.materials.size() == mesh.look.materials.size());
  for (std::size_t at = 0; at < mesh.look.materials.size(); ++at) {
    const deform::Material& wanted = mesh.look.materials[at];
    const deform::Material& found = back.look.materials[at];
    CHECK(found.name == wanted.name);
    CHECK((*found.colour - *wanted.colour).cwiseAbs().maxCoeff() < 1e-6F);
    CHECK(found.drawn == wanted.drawn);
    CHECK(found.texture == wanted.texture);
    CHECK(triangles_of(back, wanted.name, given) == triangles_of(mesh, wanted.name));
  }
  REQUIRE(back.look.textures.size() == 1);
  CHECK(back.look.textures[0].file == "skin.png");
  CHECK(*back.look.textures[0].contents == *mesh.look.textures[0].contents);
  REQUIRE(back.look.vertex_colours.cols() == mesh.vertices.cols());
  for (std::size_t at = 0; at < given.size(); ++at)
    CHECK((back.look.vertex_colours.col(static_cast<Eigen::Index>(at)) -
           mesh.look.vertex_colours.col(given[at]))
              .cwiseAbs()
              .maxCoeff() < 1e-6F);
}

} // namespace

TEST_SUITE("gltf_read_back") {
  TEST_CASE("vertices, materials, texture and colours come back, also of a finer model") {
    check_read_back(painted_ball());
    check_read_back(deform::subdivide(painted_ball()).mesh);
  }

  TEST_CASE("a model without texture coordinates gets none, whatever textures it names") {
    deform::Mesh ball = test::sphere(5, 8, 1.0);
    ball.look.materials = {{"skin", {}, 0, true}};
    ball.look.face_materials.assign(ball.face_count(), 0);
    ball.look.textures = {
        {"skin.png", std::make_shared<const std::string>("\x89PNG\r\n\x1A\nrest")}};
    GlbFile file("test");
    const GltfModel model(ball, file);
    model.add_to(file, GltfMaterials(ball.look, file), 1.0, {});
    const auto& attributes = file["meshes"][0]["primitives"][0]["attributes"];
    CHECK(attributes.contains("POSITION"));
    CHECK_FALSE(attributes.contains("TEXCOORD_0"));
  }

  TEST_CASE("faces of a vertex that differ in colour come back so, and share the vertex") {
    const deform::Mesh cube = test::with_six_colours(test::cube_of_cells(2));
    const deform::Mesh back = read_back(cube, 1.0);
    CHECK(back.vertices.cols() == cube.vertices.cols());
    CHECK(back.face_count() == cube.face_count());
    CHECK(test::worst_of_six_colours(back) < 1e-6F);
    CHECK(back.look.materials.size() == 1);
    CHECK(*back.look.materials[0].colour == Eigen::Vector4f(Eigen::Vector4f::Ones()));
  }

  TEST_CASE("parts share no vertices, and all of them together have hardly more than the model") {
    deform::Mesh mesh = test::sphere(40, 60, 2.0);
    constexpr std::uint32_t materials = 17;
    for (std::uint32_t at = 0; at < materials; ++at)
      mesh.look.materials.push_back({std::to_string(at), std::nullopt, deform::no_index, true});
    for (std::size_t face = 0; face < mesh.face_count(); ++face) // each has a band of its own
      mesh.look.face_materials.push_back(
          static_cast<std::uint32_t>(face * materials / mesh.face_count()));
    const std::vector<GltfPart> parts = parts_of(mesh);
    REQUIRE(parts.size() == materials);
    std::size_t vertices = 0, triangles = 0;
    for (const GltfPart& part : parts) {
      vertices += part.vertices.size();
      triangles += part.triangles.size() / 3;
      std::vector<bool> is_used(part.vertices.size(), false);
      for (const std::uint32_t place : part.triangles)
        is_used.at(place) = true;
      CHECK(std::count(is_used.begin(), is_used.end(), false) == 0);
    }
    const auto count = static_cast<std::size_t>(mesh.vertices.cols());
    CHECK(vertices >= count);
    CHECK(vertices < 2 * count);
    CHECK(triangles == mesh.face_corners.size() - 2 * mesh.face_count());
  }

  TEST_CASE("a vertex without a face is not lost") {
    deform::Mesh mesh = test::sphere(9, 16, 2.0);
    mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
    mesh.vertices.rightCols(1) = Eigen::Vector3d(5.0, 6.0, 7.0);
    const std::vector<GltfPart> parts = parts_of(mesh);
    REQUIRE(parts.size() == 1);
    CHECK(parts[0].vertices.size() == static_cast<std::size_t>(mesh.vertices.cols()));
  }

  TEST_CASE("each corner keeps its texture coordinate, on both sides of a seam") {
    const deform::Mesh mesh = painted_ball();
    const deform::Mesh back = read_back(mesh, 1.0);
    using Corner = std::pair<std::uint32_t, double>; // a vertex and its u
    const auto corners_of = [](const deform::Mesh& of, const std::vector<std::uint32_t>& given) {
      std::vector<Corner> corners;
      for (std::size_t at = 0; at < of.face_corners.size(); ++at) {
        const std::uint32_t vertex = of.face_corners[at];
        corners.emplace_back(given.empty() ? vertex : given[vertex],
                             of.texcoords(0, of.corner_texcoords[at]));
      }
      std::sort(corners.begin(), corners.end());
      corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
      return corners;
    };
    CHECK(corners_of(back, given_vertices(back, mesh, 1.0)) ==
          corners_of(mesh, {})); // 256ths are exact
    CHECK((back.texcoords.row(1).array() - 0.25).abs().maxCoeff() < 1e-6);
  }

  TEST_CASE("a model without materials is of clay, and has no texture coordinates") {
    const deform::Mesh mesh = test::sphere(9, 16, 2.0);
    const deform::Mesh back = read_back(mesh, 1.0);
    CHECK((back.vertices - mesh.vertices).cwiseAbs().maxCoeff() < 1e-6);
    REQUIRE(back.look.materials.size() == 1);
    CHECK(back.look.materials[0].name == "clay");
    CHECK(back.corner_texcoords.empty());
    CHECK(back.look.vertex_colours.cols() == 0);
  }
}

} // namespace gltf_read_back_test
