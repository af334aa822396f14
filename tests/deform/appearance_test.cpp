// What a model looks like comes through files and through subdivision.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/subdivision.hpp>

#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"

namespace appearance_test {

using namespace nendo::deform;
using nendo::test::TemporaryFolder;
namespace fs = std::filesystem;

static void put(const fs::path& path, const std::string& contents) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << contents;
}

static std::string contents_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

static Mesh read(const fs::path& path) {
  auto mesh = read_mesh(path);
  REQUIRE_MESSAGE(mesh, mesh.error().message);
  return *std::move(mesh);
}

/// A head as small as can be: a quad and two triangles, of two objects and three materials.
const std::string small_obj =
    "mtllib small.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 2 2\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "o head\ng face front\nusemtl skin\nf 1/1 2/2 3/3 4/4\n"
    "g eyes\nusemtl left eye\nf 1/1 2/2 5/3\no shells\nusemtl shell\nf 2/1 3/2 5/3\n";
const std::string small_mtl =
    "newmtl shell\nKd 1 1 1\nd 0\n"
    "newmtl skin\nKa 1 0 0\nKd 0.5 0.25 0.125\nmap_Kd -s 1 1 1 maps\\skin.png\n"
    "newmtl left eye\nKd .9 .9 .9\nTr 0.25\n"
    "newmtl unused\nKd 0 1 0\n";

static std::string name_of(const FaceNames& names, std::size_t face) {
  if (names.of_face.empty() || names.of_face[face] == no_index) return "";
  return names.names[names.of_face[face]];
}

static void check_small(const Mesh& mesh, const std::string& texture) {
  CHECK(mesh.face_starts == std::vector<std::uint32_t>{0, 4, 7, 10});
  CHECK(mesh.face_corners == std::vector<std::uint32_t>{0, 1, 2, 3, 0, 1, 4, 1, 2, 4});
  CHECK(mesh.corner_texcoords == std::vector<std::uint32_t>{0, 1, 2, 3, 0, 1, 2, 0, 1, 2});
  const Appearance& look = mesh.look;
  REQUIRE(look.materials.size() == 3);
  REQUIRE(look.face_materials.size() == 3);
  const auto* const skin = look.material_of(0);
  const auto* const eye = look.material_of(1);
  const auto* const shell = look.material_of(2);
  CHECK(skin->name == "skin");
  CHECK(*skin->colour == Eigen::Vector4f(0.5F, 0.25F, 0.125F, 1.0F));
  REQUIRE(skin->texture < look.textures.size());
  CHECK(look.textures[skin->texture].file == texture);
  REQUIRE(look.textures[skin->texture].contents);
  CHECK(*look.textures[skin->texture].contents == "no picture");
  CHECK(eye->name == "left eye");
  CHECK(*eye->colour == Eigen::Vector4f(0.9F, 0.9F, 0.9F, 0.75F));
  CHECK(eye->texture == no_index);
  CHECK(eye->drawn);
  CHECK(shell->name == "shell");
  CHECK_FALSE(shell->drawn);
  CHECK(name_of(look.groups, 0) == "face front");
  CHECK(name_of(look.groups, 1) == "eyes");
  CHECK(name_of(look.groups, 2) == "eyes");
  CHECK(name_of(look.objects, 0) == "head");
  CHECK(name_of(look.objects, 2) == "shells");
}

TEST_CASE("deform/appearance/an OBJ comes out as it came in") {
  const TemporaryFolder folder;
  put(folder.path() / "in/small.obj", small_obj);
  put(folder.path() / "in/small.mtl", small_mtl);
  put(folder.path() / "in/maps/skin.png", "no picture");
  const Mesh mesh = read(folder.path() / "in/small.obj");
  check_small(mesh, "maps/skin.png");
  fs::create_directory(folder.path() / "out");
  const fs::path out = folder.path() / "out/shaped.obj";
  for (int again = 0; again < 2; ++again) { // our own files are replaced
    REQUIRE(write_mesh(out, mesh));
    const Mesh back = read(out);
    check_small(back, "maps_skin.png");
    CHECK(back.vertices == mesh.vertices);
    CHECK(back.texcoords == mesh.texcoords);
  }
  CHECK(std::distance(fs::directory_iterator(folder.path() / "out"), {}) == 3);
  // In the model's own folder, what others wrote stays.
  REQUIRE(write_mesh(folder.path() / "in/small.obj", mesh));
  check_small(read(folder.path() / "in/small.obj"), "maps/skin.png");
  CHECK(contents_of(folder.path() / "in/small.mtl") == small_mtl);
}

TEST_CASE("deform/appearance/an OBJ without materials writes none") {
  const TemporaryFolder folder;
  REQUIRE(write_mesh(folder.path() / "plain.obj", nendo::test::grid(3, 1.0)));
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);
  const Mesh mesh = read(folder.path() / "plain.obj");
  CHECK(mesh.look.materials.empty());
  CHECK(mesh.look.face_materials.empty());
  CHECK(mesh.look.groups == FaceNames{});
  CHECK(mesh.look.vertex_colours.cols() == 0);
}

TEST_CASE("deform/appearance/a model does without its materials' file") {
  const TemporaryFolder folder;
  put(folder.path() / "small.obj", small_obj);
  const Mesh mesh = read(folder.path() / "small.obj");
  REQUIRE(mesh.look.materials.size() == 3);
  for (const Material& material : mesh.look.materials) {
    CHECK_FALSE(material.colour);
    CHECK(material.drawn);
  }
  // The names are kept, and nothing is invented.
  REQUIRE(write_mesh(folder.path() / "out.obj", mesh));
  const Mesh back = read(folder.path() / "out.obj");
  CHECK(back.look.material_of(1)->name == "left eye");
  CHECK_FALSE(back.look.material_of(1)->colour);
}

TEST_CASE("deform/appearance/no file outside of the model's folder is read") {
  const TemporaryFolder folder;
  const fs::path model = folder.path() / "models/small.obj";
  put(folder.path() / "secret.mtl", small_mtl);
  put(folder.path() / "secret.png", "secret");
  fs::create_directories(folder.path() / "models");
  fs::create_symlink(folder.path() / "secret.mtl", folder.path() / "models/link.mtl");
  fs::create_directory_symlink(folder.path(), folder.path() / "models/up");
  const std::string absolute = (folder.path() / "secret.mtl").string();
  for (const std::string& library :
       {std::string("../secret.mtl"), std::string("..\\secret.mtl"),
        std::string("x/../../secret.mtl"), absolute, std::string("link.mtl"),
        std::string("up/secret.mtl"), std::string(".."), std::string("."), std::string("/"),
        std::string("/dev/zero")}) {
    CAPTURE(library);
    put(model, "mtllib " + library + "\n" + small_obj.substr(small_obj.find('v')));
    const Mesh mesh = read(model);
    REQUIRE(mesh.look.materials.size() == 3);
    for (const Material& material : mesh.look.materials)
      CHECK_FALSE(material.colour);
  }
  put(model, small_obj);
  for (const std::string& texture : {std::string("../secret.png"), std::string("up/secret.png"),
                                     (folder.path() / "secret.png").string()}) {
    CAPTURE(texture);
    put(folder.path() / "models/small.mtl", "newmtl skin\nmap_Kd " + texture + "\n");
    for (const Texture& found : read(model).look.textures)
      CHECK_FALSE(found.contents);
  }
  // An exporter's absolute path means the file beside the model, where there is one.
  put(folder.path() / "models/skin.png", "beside");
  put(folder.path() / "models/small.mtl", "newmtl skin\nmap_Kd C:\\work\\skin.png\n");
  const Mesh mesh = read(model);
  REQUIRE(mesh.look.textures.size() == 1);
  REQUIRE(mesh.look.textures[0].contents);
  CHECK(*mesh.look.textures[0].contents == "beside");
}

TEST_CASE("deform/appearance/senseless lines of an MTL do no harm") {
  const TemporaryFolder folder;
  put(folder.path() / "small.obj", small_obj);
  put(folder.path() / "small.mtl",
      "Kd 1 0 0\nd 0\nmap_Kd a.png\nnewmtl\nnewmtl skin\nKd\nKd x y z\nKd nan 0 0\nd inf\nd\nTr\n"
      "map_Kd\nmap_Kd -s\nmap_Kd ..\nKd 2 -1 0.5\nnewmtl left eye\nKd 0.25\n" +
          std::string("\0\xFF\\\n", 4));
  const Mesh mesh = read(folder.path() / "small.obj");
  CHECK(*mesh.look.material_of(0)->colour == Eigen::Vector4f(1.0F, 0.0F, 0.5F, 1.0F));
  CHECK(*mesh.look.material_of(1)->colour == Eigen::Vector4f(0.25F, 0.25F, 0.25F, 1.0F));
  CHECK_FALSE(mesh.look.material_of(2)->colour);
  CHECK(mesh.look.textures.empty());
}

TEST_CASE("deform/appearance/names that a line cannot hold are changed, and stay apart") {
  const TemporaryFolder folder;
  Mesh mesh = nendo::test::grid(2, 1.0);
  for (const char* const name : {"a\nf 1 1 1", "", "#", "a\nf 1 1 1"})
    mesh.look.materials.push_back({name, Eigen::Vector4f::Constant(1.0F), no_index, true});
  mesh.look.face_materials = {0, 1, 2, 3};
  mesh.look.groups = {{"x\rv 1 2 3", "y\\"}, {0, 1, no_index, 0}};
  REQUIRE(write_mesh(folder.path() / "out.obj", mesh));
  const Mesh back = read(folder.path() / "out.obj");
  CHECK(back.vertices == mesh.vertices);
  CHECK(back.face_corners == mesh.face_corners);
  CHECK(back.look.face_materials == mesh.look.face_materials);
  CHECK(back.look.groups.of_face == mesh.look.groups.of_face);
}

TEST_CASE("deform/appearance/each face keeps its material and names when it is subdivided") {
  Mesh mesh = nendo::test::grid(4, 1.0);
  nendo::test::add_face(mesh, {0, 1, 5});
  nendo::test::add_face(mesh, {0, 1});
  mesh.look.materials = {{"a", {}, no_index, true}, {"b", {}, no_index, true}};
  mesh.look.objects.names = {"o"};
  mesh.look.groups.names = {"g", "h", "i"};
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    mesh.look.face_materials.push_back(face % 3 == 2 ? no_index : face % 3);
    mesh.look.groups.of_face.push_back(face * 7 % 3);
    mesh.look.objects.of_face.push_back(face == 5 ? 0 : no_index);
  }
  const Mesh finer = subdivide(mesh).mesh;
  REQUIRE(finer.look.face_materials.size() == finer.face_count());
  REQUIRE(finer.look.groups.of_face.size() == finer.face_count());
  REQUIRE(finer.look.objects.of_face.size() == finer.face_count());
  // In a grid the middle of a face lies within the face that it was part of.
  std::size_t at = 0;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t corners = mesh.face_starts[face + 1] - mesh.face_starts[face];
    const std::size_t pieces = corners == 2 ? 1 : corners == 3 ? 4 : corners;
    for (std::size_t piece = 0; piece < pieces; ++piece, ++at) {
      CHECK(finer.look.face_materials[at] == mesh.look.face_materials[face]);
      CHECK(finer.look.groups.of_face[at] == mesh.look.groups.of_face[face]);
      CHECK(finer.look.objects.of_face[at] == mesh.look.objects.of_face[face]);
    }
  }
  CHECK(at == finer.face_count());
}

TEST_CASE("deform/appearance/colours of vertices come through an OBJ and a PLY") {
  const TemporaryFolder folder;
  Mesh mesh = nendo::test::grid(16, 1.0); // 289 vertices
  mesh.look.vertex_colours.resize(4, mesh.vertices.cols());
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    // The linear values of the 256 steps of an encoded byte (IEC 61966-2-1).
    const double step = static_cast<double>(v % 256) / 255.0;
    const double linear = step <= 0.04045 ? step / 12.92 : std::pow((step + 0.055) / 1.055, 2.4);
    mesh.look.vertex_colours.col(v) << static_cast<float>(linear), 0.0F, 1.0F,
        static_cast<float>(step);
  }
  for (const char* const name : {"out.obj", "out.ply"}) {
    CAPTURE(name);
    REQUIRE(write_mesh(folder.path() / name, mesh));
    const Mesh back = read(folder.path() / name);
    CHECK(back.vertices == mesh.vertices);
    REQUIRE(back.look.vertex_colours.cols() == mesh.vertices.cols());
    // An OBJ has no opacity.
    const Eigen::Index rows = std::string(name).ends_with("ply") ? 4 : 3;
    const Eigen::MatrixXf off =
        (back.look.vertex_colours - mesh.look.vertex_colours).topRows(rows).cwiseAbs();
    CHECK(off.maxCoeff() < 1e-6F);
  }
  const Mesh finer = subdivide(mesh).mesh;
  REQUIRE(finer.look.vertex_colours.cols() == finer.vertices.cols());
  CHECK(finer.look.vertex_colours.leftCols(mesh.vertices.cols()) == mesh.look.vertex_colours);
}

TEST_CASE("deform/appearance/the shipped face is whole, and each of its materials has a colour") {
  const Mesh mesh = read(fs::path(NENDO_MODELS) / "face.obj");
  CHECK(mesh.vertices.cols() == 26719);
  CHECK(mesh.face_count() == 26384);
  // Places that face trackers know, as ICT FaceKit has them.
  CHECK(mesh.vertices.col(0) == Eigen::Vector3d(0.0, -2.48251, 11.8387));
  CHECK((mesh.vertices.col(966) - Eigen::Vector3d(0.0, -7.6, 10.4)).norm() < 0.1); // the chin
  CHECK((mesh.vertices.col(4857) - Eigen::Vector3d(0.0, 0.4, 13.1)).norm() < 0.1); // the nose
  std::size_t drawn = 0;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const Material* const material = mesh.look.material_of(face);
    REQUIRE(material != nullptr);
    REQUIRE(material->colour);
    drawn += material->drawn ? 1 : 0;
  }
  CHECK(drawn > 24000);
  CHECK(drawn < mesh.face_count());
  // Eyeballs shine white, and their pupils do not.
  for (const Material& material : mesh.look.materials) {
    if (material.name.starts_with("M_Sclera")) CHECK(material.colour->minCoeff() > 0.7F);
    if (material.name.starts_with("M_Pupil")) CHECK(material.colour->head<3>().maxCoeff() < 0.02F);
  }
}

} // namespace appearance_test
