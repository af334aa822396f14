// What an OBJ looks like where its files disagree with it, and what its reader says then.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/read_notes.hpp>

#include "support/temporary_folder.hpp"

namespace model_notes_test {

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

static ReadModel read(const fs::path& path) {
  auto model = read_model(path);
  REQUIRE_MESSAGE(model, model.error().message);
  return *std::move(model);
}

static std::string all(const ReadNotes& notes) {
  std::string text;
  for (const std::string& note : notes)
    text += note + "\n";
  return text;
}

/// A triangle for each material.
static std::string obj_of(const std::string& libraries,
                          std::initializer_list<const char*> materials) {
  std::string text = libraries + "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
  for (const char* const name : materials)
    text += "usemtl " + std::string(name) + "\nf 1/1 2/2 3/3\n";
  return text;
}

/// One material, as an MTL describes it.
static ReadModel with_mtl(const std::string& lines) {
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", obj_of("mtllib m.mtl\n", {"skin"}));
  put(folder.path() / "m.mtl", "newmtl skin\nKd 1 1 1\n" + lines);
  return read(folder.path() / "m.obj");
}

TEST_CASE("deform/model_notes/d wins over Tr, whichever comes first") {
  for (const char* const lines : {"d 1\nTr 1\n", "Tr 1\nd 1\n", "d 1\nTr 0\n", "Tr 0.5\nd 1.0\n"}) {
    CAPTURE(lines);
    const ReadModel model = with_mtl(lines);
    CHECK((*model.mesh.look.materials[0].colour)[3] == 1.0F);
    CHECK(model.mesh.look.materials[0].drawn);
    CHECK(all(model.notes) == "");
  }
  CHECK((*with_mtl("Tr 0\nd 0.75\n").mesh.look.materials[0].colour)[3] == 0.75F);
  CHECK((*with_mtl("d -halo 0.75\n").mesh.look.materials[0].colour)[3] == 0.75F);
}

TEST_CASE("deform/model_notes/Tr alone is 1 - d, and Tr 1 is opaque") {
  const ReadModel opaque = with_mtl("Tr 1.000000\n");
  CHECK((*opaque.mesh.look.materials[0].colour)[3] == 1.0F);
  CHECK(opaque.mesh.look.materials[0].drawn);
  CHECK(all(opaque.notes).find("material 'skin': 'Tr 1' without 'd' is taken as opaque") == 0);
  CHECK((*with_mtl("Tr 0.25\n").mesh.look.materials[0].colour)[3] == 0.75F);
  CHECK((*with_mtl("Tr 0\n").mesh.look.materials[0].colour)[3] == 1.0F);
}

TEST_CASE("deform/model_notes/a model of which nothing could be seen is opaque") {
  const ReadModel model = with_mtl("d 0\n");
  CHECK((*model.mesh.look.materials[0].colour)[3] == 1.0F);
  CHECK(all(model.notes) == "all materials have the opacity 0; they are taken as opaque\n");
  // Of two, one may be invisible on purpose.
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", obj_of("mtllib m.mtl\n", {"skin", "shell", "glass"}));
  put(folder.path() / "m.mtl", "newmtl skin\nd 1\nnewmtl shell\nd 0\nnewmtl glass\nd 0.2\n");
  const ReadModel two = read(folder.path() / "m.obj");
  CHECK(two.mesh.look.material_of(0)->drawn);
  CHECK_FALSE(two.mesh.look.material_of(1)->drawn);
  CHECK(all(two.notes) ==
        "material 'glass': is more than half transparent, so its faces are not drawn\n");
}

TEST_CASE("deform/model_notes/bytes as Kd, and a black Kd below a texture") {
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", obj_of("mtllib m.mtl\n", {"skin"}));
  put(folder.path() / "m.mtl", "newmtl other\nKd 255 255 255\nnewmtl skin\nKd 255 51 0\n");
  const ReadModel bytes = read(folder.path() / "m.obj");
  CHECK(bytes.mesh.look.materials[0].colour->isApprox(Eigen::Vector4f(1.0F, 0.2F, 0.0F, 1.0F)));
  CHECK(bytes.notes.size() == 1);
  put(folder.path() / "m.mtl", "newmtl skin\nKd 0 0 0\nmap_Kd skin.png\n");
  put(folder.path() / "skin.png", "picture");
  const ReadModel black = read(folder.path() / "m.obj");
  CHECK(*black.mesh.look.materials[0].colour == Eigen::Vector4f::Ones());
  CHECK(all(black.notes).find("material 'skin': its Kd of 0 0 0") == 0);
}

TEST_CASE("deform/model_notes/a file of materials that is missing is named, and nothing else") {
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", obj_of("mtllib nowhere.mtl\n", {"skin", "eye"}));
  CHECK(all(read(folder.path() / "m.obj").notes) ==
        "file of materials 'nowhere.mtl': there is no such file; put it beside the model\n");
  put(folder.path() / "m.obj", obj_of("mtllib /home/me/a b.mtl\n", {"skin"}));
  CHECK(all(read(folder.path() / "m.obj").notes) ==
        "file of materials '/home/me/a b.mtl': is named outside of the model's folder, where "
        "nothing is read; copy the file beside the model\n");
  put(folder.path() / "m.obj", obj_of("", {"skin", "eye", "hair"}));
  CHECK(all(read(folder.path() / "m.obj").notes) ==
        "material 'skin' (and 2 others): no file of materials is named (mtllib), so it has no "
        "colour of its own\n");
  put(folder.path() / "m.obj", obj_of("mtllib m.mtl\n", {}) + "f 1/1 2/2 3/3\n");
  CHECK(all(read(folder.path() / "m.obj").notes) ==
        "file of materials 'm.mtl': is not used, because no face has one (usemtl)\n");
}

TEST_CASE("deform/model_notes/several files in one mtllib, of which one is missing") {
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", obj_of("mtllib one.mtl two.mtl\n", {"skin", "eye"}));
  put(folder.path() / "one.mtl", "newmtl skin\nKd 1 0 0\nnewmtl unused\nKd 0 0 0\n");
  const ReadModel model = read(folder.path() / "m.obj");
  CHECK(model.mesh.look.materials[0].colour);
  CHECK(all(model.notes) ==
        "file of materials 'two.mtl': there is no such file; put it beside the model\n"
        "material 'eye': no MTL file describes it, so it has no colour of its own\n");
}

TEST_CASE("deform/model_notes/names of another case are the same, also of folders") {
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", obj_of("mtllib Mats\\MODEL.MTL\n", {"skin"}));
  put(folder.path() / "mats/Model.mtl", "newmtl skin\nmap_Kd MAPS/Skin  One.PNG\n");
  put(folder.path() / "maps/skin one.png", "picture");
  const ReadModel model = read(folder.path() / "m.obj");
  CHECK(all(model.notes) == "");
  REQUIRE(model.mesh.look.textures.size() == 1);
  CHECK(model.mesh.look.textures[0].file == "maps/skin one.png");
  CHECK(*model.mesh.look.textures[0].contents == "picture");
}

TEST_CASE("deform/model_notes/a texture is looked for beside its MTL, too") {
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", obj_of("mtllib mats/m.mtl\n", {"skin"}));
  put(folder.path() / "mats/m.mtl", "newmtl skin\nmap_Kd skin.png\n");
  put(folder.path() / "mats/skin.png", "picture");
  const ReadModel model = read(folder.path() / "m.obj");
  CHECK(all(model.notes) == "");
  CHECK(model.mesh.look.textures[0].file == "mats/skin.png");
}

TEST_CASE("deform/model_notes/the advice about a texture above the model's folder works") {
  const TemporaryFolder folder;
  const fs::path obj = folder.path() / "source/m.obj";
  put(obj, obj_of("mtllib m.mtl\n", {"skin"}));
  put(folder.path() / "textures/skin.png", "picture");
  for (const char* const named : {"../textures/skin.png", "..\\textures\\skin.png",
                                  "D:\\scan\\textures\\skin.png", "/work/textures/skin.png"}) {
    CAPTURE(named);
    put(folder.path() / "source/m.mtl", "newmtl skin\nmap_Kd " + std::string(named) + "\n");
    const ReadModel model = read(obj);
    CHECK(all(model.notes) ==
          "texture '" + std::string(named) +
              "': is named outside of the model's folder, where nothing is read; copy the file "
              "beside the model\n");
    CHECK_FALSE(model.mesh.look.textures[0].contents);
    fs::copy_file(folder.path() / "textures/skin.png", folder.path() / "source/skin.png");
    const ReadModel beside = read(obj);
    CHECK(all(beside.notes) == "");
    CHECK(beside.mesh.look.textures[0].file == "skin.png");
    fs::remove(folder.path() / "source/skin.png");
    // So does copying the folder.
    fs::copy(folder.path() / "textures", folder.path() / "source/textures");
    const ReadModel below = read(obj);
    CHECK(all(below.notes) == "");
    CHECK(below.mesh.look.textures[0].file == "textures/skin.png");
    fs::remove_all(folder.path() / "source/textures");
  }
}

TEST_CASE("deform/model_notes/textures that cannot be read are named with the reason") {
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", obj_of("mtllib m.mtl\n", {"a", "b", "c", "d", "e"}));
  put(folder.path() / "m.mtl", "newmtl a\nmap_Kd gone.png\nnewmtl b\nmap_Kd -bm 1 gone too.png\n"
                               "newmtl c\nmap_Kd empty.png\nnewmtl d\nmap_Kd folder\n"
                               "newmtl e\nmap_Kd -s 1 1 1 -bm 0.5 gone.png\n");
  put(folder.path() / "empty.png", "");
  put(folder.path() / "folder/x", "");
  CHECK(all(read(folder.path() / "m.obj").notes) ==
        "texture 'gone.png' (and 1 other): there is no such file; put it beside the model\n"
        "texture 'empty.png': is empty; export it once more\n"
        "texture 'folder': is no regular file\n");
}

TEST_CASE("deform/model_notes/what moves or cuts a texture away is named") {
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", obj_of("mtllib m.mtl\n", {"leaf"}));
  put(folder.path() / "m.mtl", "newmtl leaf\nmap_Kd -s 2 2 1 -o 0 0 0 leaf.png\nmap_d leaf.png\n");
  put(folder.path() / "leaf.png", "picture");
  CHECK(all(read(folder.path() / "m.obj").notes) ==
        "texture 'leaf.png': its options -o, -s and -t are left out, so it is neither moved nor "
        "scaled\nopacity texture 'leaf.png': is left out, so what it cuts away is seen\n");
}

TEST_CASE("deform/model_notes/textures of other properties are named") {
  CHECK(all(with_mtl("map_Bump -bm 1 bumps.png\nmap_Ks shine.png\nnorm n.png\nillum 2\n").notes) ==
        "texture statement 'map_bump' (and 2 others): is left out; of textures, map_Kd is read\n");
}

TEST_CASE("deform/model_notes/a texture without texture coordinates is named") {
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  put(folder.path() / "m.mtl", "newmtl a\nmap_Kd skin.png\n");
  put(folder.path() / "skin.png", "picture");
  CHECK(all(read(folder.path() / "m.obj").notes) ==
        "texture 'skin.png': the model has no texture coordinates, so it is not shown\n");
}

TEST_CASE("deform/model_notes/what is written names no texture that is missing") {
  const TemporaryFolder folder;
  put(folder.path() / "m.obj", obj_of("mtllib m.mtl\n", {"a", "b"}));
  put(folder.path() / "m.mtl", "newmtl a\nKd 1 0 0\nmap_Kd gone.png\nnewmtl b\nmap_Kd there.png\n");
  put(folder.path() / "there.png", "picture");
  const ReadModel model = read(folder.path() / "m.obj");
  fs::create_directory(folder.path() / "out");
  REQUIRE(write_mesh(folder.path() / "out/o.obj", model.mesh));
  const std::string mtl = contents_of(folder.path() / "out/o.mtl");
  CHECK(mtl.find("gone.png") == std::string::npos);
  CHECK(mtl.find("map_Kd there.png\n") != std::string::npos);
  CHECK(contents_of(folder.path() / "out/there.png") == "picture");
  CHECK(all(read(folder.path() / "out/o.obj").notes) == "");
}

TEST_CASE("deform/model_notes/notes are few, printable lines, however hostile the model is") {
  const TemporaryFolder folder;
  std::string obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
  std::string mtl;
  for (int at = 0; at < 3000; ++at) {
    const std::string name = "m\x1B[31m" + std::to_string(at);
    obj += "usemtl " + name + "\nf 1 2 3\n";
    mtl += "newmtl " + name + "\nTr 1\nmap_Kd \x07" + std::string(900, 'x') + std::to_string(at) +
           ".png\n";
  }
  put(folder.path() / "m.obj", obj);
  put(folder.path() / "m.mtl", mtl);
  const ReadModel model = read(folder.path() / "m.obj");
  CHECK(model.notes.size() == 2);
  CHECK(all(model.notes).find("(and 2999 others)") != std::string::npos);
  for (const std::string& note : model.notes) {
    CHECK(note.size() < 400);
    for (const char c : note)
      CHECK((c >= ' ' && c <= '~'));
  }
  ReadNotes many(50, "a\nb");
  bound_notes(many);
  REQUIRE(many.size() == max_notes);
  CHECK(many[0] == "a?b");
  CHECK(many.back() == "and 31 notes more");
}

} // namespace model_notes_test
