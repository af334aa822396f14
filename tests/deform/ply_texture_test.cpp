// Texture coordinates and textures of PLY files, in the forms in which programs write them.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "support/temporary_folder.hpp"

namespace ply_texture_test {

using namespace nendo::deform;
using nendo::test::TemporaryFolder;
namespace fs = std::filesystem;

static void put(const fs::path& path, const std::string& contents) {
  std::ofstream(path, std::ios::binary) << contents;
}

/// Reads that text as a file beside a texture. `up` is said, so that no note asks for it.
static ReadModel read(const std::string& text, const std::string& texture = "skin.png") {
  const TemporaryFolder folder;
  put(folder.path() / "m.ply", text);
  if (!texture.empty()) put(folder.path() / texture, "picture");
  auto model = read_model(folder.path() / "m.ply", {.up = UpAxis::y});
  REQUIRE_MESSAGE(model, model.error().message);
  return *std::move(model);
}

/// Two triangles of a square, by their corners.
constexpr std::array<std::array<int, 3>, 2> faces{{{0, 1, 2}, {0, 2, 3}}};
constexpr std::array<std::array<float, 2>, 4> places{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
/// Of each corner; both triangles have a place of their own at the first vertex.
constexpr std::array<std::array<std::array<float, 2>, 3>, 2> texcoords{
    {{{{0.0F, 0.0F}, {0.5F, 0.0F}, {0.5F, 0.75F}}},
     {{{0.25F, 0.0F}, {0.5F, 0.75F}, {0.0F, 0.75F}}}}};

/// Numbers of a body, in each of the three forms.
class Body {
public:
  explicit Body(const std::string& format) : format_(format) {}
  template <class Number>
  void add(Number number) {
    if (format_ == "ascii") {
      text_ += std::to_string(number) + " ";
      return;
    }
    std::array<char, sizeof number> bytes{};
    std::memcpy(bytes.data(), &number, sizeof number);
    const bool little = format_ == "binary_little_endian";
    if (little != (std::endian::native == std::endian::little))
      std::reverse(bytes.begin(), bytes.end());
    text_.append(bytes.data(), bytes.size());
  }
  const std::string& text() const { return text_; }

private:
  std::string format_, text_;
};

static std::string head(const std::string& format, const std::string& comments) {
  return "ply\nformat " + format + " 1.0\n" + comments;
}

/// As MeshLab writes texture coordinates of wedges.
static std::string with_wedges(const std::string& format, const std::string& comments,
                               bool has_numbers = false) {
  Body body(format);
  for (const auto& place : places)
    for (const float number : {place[0], place[1], 0.0F})
      body.add(number);
  for (std::size_t face = 0; face < 2; ++face) {
    body.add(std::uint8_t{3});
    for (const int corner : faces[face])
      body.add(std::int32_t{corner});
    body.add(std::uint8_t{6});
    for (const auto& corner : texcoords[face])
      for (const float number : corner)
        body.add(number);
    if (has_numbers) body.add(static_cast<std::int32_t>(1 - face));
  }
  return head(format, comments) +
         "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 2\nproperty list uchar int vertex_indices\n"
         "property list uchar float texcoord\n" +
         (has_numbers ? "property int texnumber\n" : "") + "end_header\n" + body.text();
}

static void check_wedges(const Mesh& mesh) {
  REQUIRE(mesh.corner_texcoords.size() == 6);
  for (std::size_t face = 0; face < 2; ++face)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& expected = texcoords[face][k];
      const Eigen::Vector2d found = mesh.texcoords.col(mesh.corner_texcoords[3 * face + k]);
      CHECK(found ==
            Eigen::Vector2d(static_cast<double>(expected[0]), static_cast<double>(expected[1])));
    }
  // Corners of one vertex share a place of the texture where they agree, and only there.
  CHECK(mesh.texcoords.cols() == 5);
  CHECK(mesh.corner_texcoords[2] == mesh.corner_texcoords[4]);
  CHECK(mesh.corner_texcoords[0] != mesh.corner_texcoords[3]);
}

static void check_skin(const Mesh& mesh, const std::string& file = "skin.png") {
  REQUIRE(mesh.look.textures.size() == 1);
  CHECK(mesh.look.textures[0].file == file);
  REQUIRE(mesh.look.textures[0].contents);
  CHECK(*mesh.look.textures[0].contents == "picture");
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    REQUIRE(mesh.look.material_of(face) != nullptr);
    CHECK(mesh.look.material_of(face)->texture == 0);
  }
}

TEST_SUITE("ply_texture") {
  TEST_CASE("texture coordinates of faces' corners, in each of the three formats") {
    for (const char* const format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      CAPTURE(format);
      const ReadModel model = read(with_wedges(format, "comment TextureFile skin.png\n"));
      CHECK(model.notes.empty());
      check_wedges(model.mesh);
      check_skin(model.mesh);
      CHECK(model.mesh.look.materials[0].name == "skin");
    }
  }

  TEST_CASE("texture coordinates of vertices, under each of their names") {
    for (const auto& names : {std::pair{"s", "t"},
                              {"u", "v"},
                              {"texture_u", "texture_v"},
                              {"texture_s", "texture_t"}}) {
      const char* const across = names.first;
      const char* const up = names.second;
      CAPTURE(across);
      const ReadModel model =
          read(head("ascii", "comment TextureFile skin.png\n") +
               "element vertex 4\nproperty float x\nproperty float " + up +
               "\nproperty float y\nproperty float z\nproperty double " + across +
               "\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
               "0 0.5 0 0 0.25\n1 0.5 0 0 0.75\n1 1 1 0 0.75\n0 1 1 0 0.25\n4 3 0 1 2\n");
      CHECK(model.notes.empty());
      check_skin(model.mesh);
      const Mesh& mesh = model.mesh;
      CHECK(mesh.vertices.col(2) == Eigen::Vector3d(1, 1, 0));
      REQUIRE(mesh.corner_texcoords.size() == 4);
      CHECK(mesh.texcoords.col(mesh.corner_texcoords[0]) == Eigen::Vector2d(0.25, 1.0));
      CHECK(mesh.texcoords.col(mesh.corner_texcoords[3]) == Eigen::Vector2d(0.75, 1.0));
    }
  }

  TEST_CASE("a texture's name may have blanks and another case") {
    const ReadModel model =
        read(with_wedges("ascii", "comment TextureFile My scan.JPG \ncomment made by hand\n"),
             "my scan.jpg");
    CHECK(model.notes.empty());
    check_skin(model.mesh, "my scan.jpg");
  }

  TEST_CASE("of several textures each face has its own") {
    const ReadModel model = read(
        with_wedges("ascii", "comment TextureFile skin.png\ncomment TextureFile hair.png\n", true));
    CHECK(model.notes == std::vector<std::string>{
                             "texture 'hair.png': there is no such file; put it beside the model"});
    const Appearance& look = model.mesh.look;
    REQUIRE(look.materials.size() == 2);
    CHECK(look.material_of(0)->name == "hair");
    CHECK(look.material_of(1)->name == "skin");
    CHECK(look.textures[look.material_of(1)->texture].contents);
    CHECK_FALSE(look.textures[look.material_of(0)->texture].contents);
  }

  TEST_CASE("a texture that is missing, or outside of the folder, is named as that of an MTL is") {
    const auto notes = [](const std::string& named) {
      return read(with_wedges("ascii", "comment TextureFile " + named + "\n"), "").notes;
    };
    CHECK(notes("skin.png") == std::vector<std::string>{"texture 'skin.png': there is no such "
                                                        "file; put it beside the model"});
    CHECK(notes("../skin.png") ==
          std::vector<std::string>{"texture '../skin.png': is named outside of the model's folder, "
                                   "where nothing is read; copy the file beside the model"});
  }

  TEST_CASE("a texture without texture coordinates is named, and so is what faces lack") {
    const std::string bare = head("ascii", "comment TextureFile skin.png\n") +
                             "element vertex 3\nproperty float x\nproperty float y\n"
                             "property float z\nelement face 2\n"
                             "property list uchar int vertex_indices\n";
    CHECK(read(bare + "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n").notes ==
          std::vector<std::string>{"texture 'skin.png': the model has no texture coordinates, so "
                                   "it is not shown"});
    const ReadModel half =
        read(bare + "property list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
                    "3 0 1 2 6 0 0 1 nan 1 1\n3 2 1 0 0\n");
    CHECK(half.notes ==
          std::vector<std::string>{
              "1 face has no texture coordinates, or not two for each corner; their corners are at "
              "(0, 0) of the texture",
              "1 texture coordinate is not finite; the corners there are at (0, 0) of the "
              "texture"});
    CHECK(half.mesh.corner_texcoords.size() == 6);
    CHECK(half.mesh.texcoords.allFinite());
  }

  TEST_CASE("a texture goes before colours of vertices, which say the same") {
    const auto text = [](const std::string& comments) {
      return head("ascii", comments) +
             "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "property uchar red\nproperty uchar green\nproperty uchar blue\n"
             "property float s\nproperty float t\nelement face 1\n"
             "property list uchar int vertex_indices\nend_header\n"
             "0 0 0 9 9 9 0 0\n1 0 0 9 9 9 1 0\n0 1 0 9 9 9 0 1\n3 0 1 2\n";
    };
    const ReadModel both = read(text("comment TextureFile skin.png\n"));
    CHECK(both.mesh.look.vertex_colours.cols() == 0);
    CHECK(both.notes == std::vector<std::string>{
                            "the colours of vertices are left out, because its texture has them"});
    // A texture that is missing has none.
    CHECK(read(text("comment TextureFile skin.png\n"), "").mesh.look.vertex_colours.cols() == 3);
    CHECK(read(text("")).mesh.look.vertex_colours.cols() == 3);
  }

  TEST_CASE("what a PLY loses of it is reported, and an OBJ keeps it") {
    const ReadModel model = read(with_wedges("ascii", "comment TextureFile skin.png\n"));
    CHECK(lost_in_file("o.ply", model.mesh) ==
          std::vector<std::string>{"a PLY cannot keep materials, texture coordinates; an OBJ can"});
    const TemporaryFolder folder;
    REQUIRE(write_mesh(folder.path() / "o.obj", model.mesh));
    const auto back = read_mesh(folder.path() / "o.obj");
    REQUIRE(back);
    check_wedges(*back);
    check_skin(*back);
  }
}

} // namespace ply_texture_test
