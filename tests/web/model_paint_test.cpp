// The colours of the model message, and which files clients may get.

#include <cmath>
#include <limits>
#include <memory>

#include <doctest/doctest.h>

#include "following_client.hpp"
#include "render/image.hpp"
#include "support/nasty_meshes.hpp"
#include "support/six_colours.hpp"
#include "support/test_meshes.hpp"
#include "web/model_message.hpp"

namespace model_paint_test {

using namespace nendo;
using namespace nendo::web;
using nendo::test::FollowingClient;

namespace {

std::shared_ptr<const std::string> file(std::string contents) {
  return std::make_shared<const std::string>(std::move(contents));
}

/// Four quads in a row, of five materials: none, red, glass, a picture, a text in place of one.
deform::Mesh row_of_quads() {
  deform::Mesh mesh;
  mesh.vertices.resize(3, 12);
  mesh.texcoords.resize(2, 12);
  for (int at = 0; at < 12; ++at) {
    mesh.vertices.col(at) << at / 2, at % 2, 0.0;
    mesh.texcoords.col(at) << 0.25 * (at / 2), at % 2;
  }
  for (std::uint32_t face = 0; face < 5; ++face) {
    for (const std::uint32_t corner : {0U, 2U, 3U, 1U})
      mesh.face_corners.push_back(2 * face + corner);
    mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
  }
  mesh.corner_texcoords = mesh.face_corners;
  deform::Appearance& look = mesh.look;
  look.textures = {
      {"a.png", file("\x89PNG\r\n\x1A\n")}, {"secret.txt", file("secret")}, {"no.jpg", nullptr}};
  look.materials = {{"picture", {}, 0},
                    {"glass", Eigen::Vector4f(0.1F, 0.2F, 0.3F, 0.4F)},
                    {"red", Eigen::Vector4f(0.7F, 0.1F, 0.05F, 1.0F), 1}};
  look.face_materials = {2, 1, 0, deform::no_index, 2};
  return mesh;
}

FollowingClient client_of(const deform::Mesh& mesh) {
  return FollowingClient(
      model_message(deform::BlockLayout(mesh.vertices), mesh, {}, {"row", 90.0, 1.0}));
}

} // namespace

TEST_SUITE("model_paint") {
  TEST_CASE("triangles come by their materials, with colours and texture coordinates, and what is "
            "transparent is left out") {
    const deform::Mesh mesh = row_of_quads();
    const FollowingClient client = client_of(mesh);
    REQUIRE(client.good);
    REQUIRE(client.coats.size() == 3); // none, picture, red
    CHECK(client.corners.size() == 3 * 8);
    CHECK(client.coats[0].triangles == 2);
    CHECK_FALSE(client.coats[0].has_colour);
    CHECK(client.coats[0].texture == deform::no_index);
    CHECK(client.coats[1].triangles == 2);
    CHECK_FALSE(client.coats[1].has_colour);
    CHECK(client.coats[1].texture == 0);
    CHECK(client.coats[2].triangles == 4);
    CHECK(client.coats[2].has_colour);
    CHECK(client.coats[2].colour == std::array{0.7F, 0.1F, 0.05F});
    CHECK(client.coats[2].texture == deform::no_index); // a text is no picture
    CHECK(client.colours.empty());
    REQUIRE(client.texcoords.size() == 2 * client.corners.size());
    for (std::size_t at = 0; at < client.corners.size(); ++at) {
      const auto place = mesh.vertices.col(client.order[client.corners[at]]);
      CHECK(client.texcoords[2 * at] == doctest::Approx(0.25 * place.x()));
      CHECK(client.texcoords[2 * at + 1] == doctest::Approx(place.y()));
    }
    CHECK(mesh.vertices(0, client.order[client.corners[0]]) == 3.0); // the quad without material
    CHECK(mesh.vertices(0, client.order[client.corners[6]]) == 2.0); // that of the picture
  }

  TEST_CASE("vertices' colours come in the order of the vertices, from 0 to 1 whatever they are") {
    deform::Mesh mesh = row_of_quads();
    mesh.look = {};
    mesh.look.vertex_colours = Eigen::Matrix4Xf::Ones(4, 12);
    for (int at = 0; at < 12; ++at)
      mesh.look.vertex_colours(1, at) = static_cast<float>(at) / 12.0F;
    mesh.look.vertex_colours(0, 3) = 7.0F;
    mesh.look.vertex_colours(2, 3) = std::numeric_limits<float>::quiet_NaN();
    const FollowingClient client = client_of(mesh);
    REQUIRE(client.good);
    REQUIRE(client.coats.size() == 1);
    CHECK(client.coats[0].triangles == 10);
    REQUIRE(client.colours.size() == 36);
    for (std::size_t at = 0; at < 12; ++at) {
      CHECK(client.colours[3 * at] == 65535);
      CHECK(client.colours[3 * at + 1] / 65535.0 ==
            doctest::Approx(client.order[at] / 12.0).epsilon(1e-4));
      CHECK(client.colours[3 * at + 2] == (client.order[at] == 3 ? 0 : 65535));
    }
    CHECK(client.texcoords.empty());
  }

  TEST_CASE("colours that differ in one vertex come corner by corner") {
    const deform::Mesh cube = test::with_six_colours(test::cube_of_cells(1, true));
    const FollowingClient client = client_of(cube);
    REQUIRE(client.good);
    CHECK(client.corners.size() == 36);
    REQUIRE(client.colours.size() == 108);
    for (std::size_t at = 0; at < 36; at += 3) {
      const auto place = [&](std::size_t k) -> Eigen::Vector3d {
        return cube.vertices.col(client.order[client.corners[at + k]]);
      };
      const Eigen::Vector3d normal = (place(1) - place(0)).cross(place(2) - place(0));
      const Eigen::Vector4f wanted = test::colour_of_side(test::side_of(normal));
      for (std::size_t k = 0; k < 9; ++k)
        CHECK(client.colours[3 * at + k] ==
              std::lround(65535.0F * wanted[static_cast<Eigen::Index>(k % 3)]));
    }
    CHECK(client.texcoords.empty());
  }

  TEST_CASE("a client can get PNG and JPEG, by their first bytes, of a model that can show them") {
    deform::Mesh mesh = row_of_quads();
    const Pictures pictures = pictures_of(mesh);
    REQUIRE(pictures.size() == 3);
    CHECK(pictures[0] == mesh.look.textures[0].contents);
    CHECK_FALSE(pictures[1]);
    CHECK_FALSE(pictures[2]);
    mesh.corner_texcoords.clear();
    CHECK(pictures_of(mesh).empty());
    CHECK_FALSE(has_picture(mesh, 0));
    CHECK(client_of(mesh).texcoords.empty());
  }

  TEST_CASE("a client gets a TGA as PNG") {
    deform::Mesh mesh = row_of_quads();
    const std::string one_pixel{0, 0, 2, 0, 0, 0,  0,    0,      0,      0,     0,
                                0, 1, 0, 1, 0, 24, 0x20, '\x0A', '\x14', '\x1E'};
    mesh.look.textures[1].contents = std::make_shared<const std::string>(one_pixel);
    CHECK(has_picture(mesh, 1));
    CHECK_FALSE(has_picture(mesh, 2));
    CHECK_FALSE(has_picture(mesh, deform::no_index));
    const Pictures pictures = pictures_of(mesh);
    REQUIRE(pictures[1]);
    CHECK(pictures[1]->starts_with("\x89PNG\r\n\x1A\n"));
    const auto image = render::decode_png(*pictures[1], "texture");
    REQUIRE(image);
    CHECK(image->pixels() == std::vector<render::Pixel>{{30, 20, 10}});
  }
}

} // namespace model_paint_test
