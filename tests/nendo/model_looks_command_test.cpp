// What people see of a model, and which messages they get where that is less than its files have.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "render/image.hpp"
#include "support/program.hpp"

namespace model_looks_command_test {

using namespace nendo;
using nendo::test::TemporaryFolder;
using nlohmann::json;
using render::Pixel;
namespace fs = std::filesystem;

namespace {

void put(const fs::path& path, const std::string& contents) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << contents;
}

/// A square of 2 by 2 that faces the viewer, all of it textured.
std::string square_obj(const std::string& library) {
  return "mtllib " + library +
         "\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl skin\n"
         "f 1/1 2/2 3/3 4/4\n";
}

/// 2 by 2 pixels, red over blue, in TGA.
std::string two_colours_tga() {
  std::string file{0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, 0x20};
  for (const int pixel : {0, 0, 2, 2})
    for (const int channel : {2, 1, 0}) // blue, green, red
      file += (pixel == 0 ? channel == 0 : channel == 2) ? '\xC8' : '\x14';
  return file;
}

/// The pixel in the middle of the upper or the lower half of the picture of the model.
Pixel middle_of(const fs::path& model, bool upper) {
  const fs::path out = model.parent_path() / "picture.png";
  const auto done = test::nendo(
      {"picture", model.string(), "--out", out.string(), "--pixels", "100x100", "--camera", "0,0"});
  REQUIRE_MESSAGE(done.exit_code == 0, done.err);
  const auto image = render::read_png(out);
  REQUIRE(image);
  return image->at(50, upper ? 35 : 65);
}

bool is_red(Pixel pixel) {
  return pixel[0] > pixel[2] + 60;
}

bool is_blue(Pixel pixel) {
  return pixel[2] > pixel[0] + 60;
}

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// A file of one control vector that moves a corner a little.
std::string vectors_in(const TemporaryFolder& folder) {
  const fs::path file = folder.path() / "v.csv";
  put(file, "x,y,z,dx,dy,dz\n1,1,0,0.1,0,0\n");
  return file.string();
}

} // namespace

TEST_SUITE("model_looks") {
  TEST_CASE("a TGA is seen, copied as it is, and a PNG in a glb") {
    const TemporaryFolder folder;
    const fs::path model = folder.path() / "in/m.obj";
    put(model, square_obj("m.mtl"));
    put(folder.path() / "in/m.mtl", "newmtl skin\nKd 1 1 1\nmap_Kd Skin.TGA\n");
    put(folder.path() / "in/skin.tga", two_colours_tga());
    CHECK(is_red(middle_of(model, true)));
    CHECK(is_blue(middle_of(model, false)));
    const fs::path out = folder.path() / "out/m.obj";
    fs::create_directory(folder.path() / "out");
    const auto done = test::nendo({"deform", model.string(), "--vectors", vectors_in(folder),
                                   "--radius", "0.5", "--out", out.string()});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    CHECK(done.err == "");
    CHECK(test::contents(folder.path() / "out/skin.tga") == two_colours_tga());
    CHECK(is_red(middle_of(out, true)));
    const fs::path take = folder.path() / "t.nendo";
    REQUIRE(test::nendo({"run", model.string(), "--left", "sim:sculpt", "--duration", "0.2",
                         "--record", take.string()})
                .exit_code == 0);
    const fs::path glb = folder.path() / "m.glb";
    const auto exported = test::nendo({"export", take.string(), "--out", glb.string(), "--json"});
    REQUIRE_MESSAGE(exported.exit_code == 0, exported.err);
    CHECK(json::parse(exported.out)["model_notes"] == json::array());
    const auto back = deform::read_mesh(glb);
    REQUIRE(back);
    REQUIRE(back->look.textures.size() == 1);
    CHECK(back->look.textures[0].contents->starts_with("\x89PNG"));
    const auto picture = render::decode_png(*back->look.textures[0].contents, "texture");
    REQUIRE(picture);
    CHECK(picture->pixels() ==
          std::vector<Pixel>{{200, 20, 20}, {200, 20, 20}, {20, 20, 200}, {20, 20, 200}});
  }

  TEST_CASE("a PLY's texture is seen as that of the same OBJ is") {
    const TemporaryFolder folder;
    put(folder.path() / "m.obj", square_obj("m.mtl"));
    put(folder.path() / "m.mtl", "newmtl skin\nmap_Kd skin.tga\n");
    put(folder.path() / "skin.tga", two_colours_tga());
    const std::string head = "ply\nformat ascii 1.0\ncomment TextureFile skin.tga\n"
                             "element vertex 4\nproperty float x\nproperty float y\n"
                             "property float z\n";
    const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
    put(folder.path() / "vertices.ply",
        head + "property float s\nproperty float t\n" + faces +
            "end_header\n-1 -1 0 0 0\n1 -1 0 1 0\n1 1 0 1 1\n-1 1 0 0 1\n4 0 1 2 3\n");
    put(folder.path() / "faces.ply",
        head + faces + "property list uchar float texcoord\nend_header\n" +
            "-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n");
    CHECK(is_red(middle_of(folder.path() / "m.obj", true)));
    const std::string picture = test::contents(folder.path() / "picture.png");
    for (const char* const name : {"vertices.ply", "faces.ply"}) {
      CHECK(is_red(middle_of(folder.path() / name, true)));
      CHECK(test::contents(folder.path() / "picture.png") == picture);
    }
  }

  TEST_CASE("each command says once what a model lacks, and JSON has it") {
    const TemporaryFolder folder;
    const fs::path model = folder.path() / "source/m.obj";
    put(model, square_obj("m.mtl"));
    put(folder.path() / "source/m.mtl", "newmtl skin\nKd 1 1 1\nmap_Kd ../textures/skin.png\n");
    const std::string note =
        model.string() +
        ": texture '../textures/skin.png': is named outside of the model's folder, "
        "where nothing is read; copy the file beside the model";
    const std::string out = (folder.path() / "o.obj").string();
    const std::string take = (folder.path() / "t.nendo").string();
    const auto deformed = test::nendo({"deform", model.string(), "--vectors", vectors_in(folder),
                                       "--radius", "0.5", "--out", out});
    CHECK(deformed.exit_code == 0);
    CHECK(lines_in(deformed.err) == 1);
    CHECK(deformed.err.find(note) != std::string::npos);
    CHECK(test::contents(folder.path() / "o.mtl").find("map_Kd") == std::string::npos);
    const auto run = test::nendo({"run", model.string(), "--left", "sim:sculpt", "--duration",
                                  "0.2", "--record", take, "--json"});
    REQUIRE_MESSAGE(run.exit_code == 0, run.err);
    CHECK(run.err.find(note) != std::string::npos);
    const std::string last = run.out.substr(run.out.rfind("\n{") + 1);
    CHECK(json::parse(last)["model_notes"] == json::array({note}));
    const auto replayed = test::nendo({"replay", take, "--json"});
    REQUIRE_MESSAGE(replayed.exit_code == 0, replayed.err);
    CHECK(json::parse(replayed.out)["model_notes"] == json::array({note}));
    const auto exported =
        test::nendo({"export", take, "--out", (folder.path() / "o.glb").string(), "--json"});
    REQUIRE_MESSAGE(exported.exit_code == 0, exported.err);
    CHECK(json::parse(exported.out)["model_notes"] == json::array({note}));
  }

  TEST_CASE("pictures that cannot be shown are named by what they are") {
    const TemporaryFolder folder;
    const fs::path model = folder.path() / "m.obj";
    put(model, square_obj("m.mtl"));
    put(folder.path() / "m.mtl", "newmtl skin\nmap_Kd skin.png\n");
    for (const auto& [contents, fault] :
         {std::pair{std::string("RIFF1234WEBPVP8 "), "is a WebP picture, which is not read"},
          {std::string("<!DOCTYPE html>"), "is an HTML page"},
          {std::string("words"), "is no picture"},
          {std::string("\x89PNG\r\n\x1A\nrest"), "is a damaged PNG picture"},
          {two_colours_tga().substr(0, 20), "is cut off"}}) {
      put(folder.path() / "skin.png", contents);
      const auto done = test::nendo({"picture", model.string(), "--out",
                                     (folder.path() / "p.png").string(), "--pixels", "32x32"});
      CHECK(done.exit_code == 0);
      CHECK(lines_in(done.err) == 1);
      CHECK_MESSAGE(done.err.find("texture 'skin.png': " + std::string(fault)) != std::string::npos,
                    done.err);
    }
  }

  TEST_CASE(
      "nendo/model_looks/opaque by MeshLab is opaque here, in pictures and in what is written") {
    const TemporaryFolder folder;
    const fs::path model = folder.path() / "m.obj";
    put(model, square_obj("m.obj.mtl"));
    for (const char* const lines : {"Tr 1.000000\n", "d 1.0\nTr 1.0\n", "Tr 1.0\nd 1.0\n"}) {
      CAPTURE(lines);
      put(folder.path() / "m.obj.mtl", "newmtl skin\nKd 0.9 0.02 0.02\n" + std::string(lines));
      CHECK(is_red(middle_of(model, true)));
      const fs::path out = folder.path() / "o.obj";
      REQUIRE(test::nendo({"deform", model.string(), "--vectors", vectors_in(folder), "--radius",
                           "0.5", "--out", out.string()})
                  .exit_code == 0);
      CHECK(test::contents(folder.path() / "o.mtl").find("\nd 1\n") != std::string::npos);
    }
  }
}

} // namespace model_looks_command_test
