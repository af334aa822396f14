// glTF in: by hand-made documents, whole and hostile.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "support/nasty_meshes.hpp"
#include "support/temporary_folder.hpp"

namespace gltf_file_test {

using namespace nendo::deform;
using nendo::Errc;
using nendo::test::cube_of_cells;
using nendo::test::TemporaryFolder;
using Json = nlohmann::json;

static nendo::Result<Mesh> parse(const std::string& text) {
  auto model = parse_model(std::as_bytes(std::span(text)), "t");
  if (!model) return model.error();
  return std::move(model->mesh);
}

template <class Number>
static void append(std::string& bytes, std::initializer_list<Number> numbers) {
  for (const Number number : numbers) {
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number); // tests run on little-endian machines
    bytes.append(raw, sizeof number);
  }
}

static std::string glb(const Json& json, const std::string& binary) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string file = "glTF";
  append<std::uint32_t>(file, {2, static_cast<std::uint32_t>(28 + text.size() + binary.size()),
                               static_cast<std::uint32_t>(text.size()), 0x4E4F534A});
  file += text;
  append<std::uint32_t>(file, {static_cast<std::uint32_t>(binary.size()), 0x004E4942});
  return file + binary;
}

/// A square of two triangles, in a document that has all that a model may have.
struct Square {
  std::string binary;
  Json json;

  Square() {
    append<float>(binary, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}); // 48 bytes: places
    append<std::uint16_t>(binary, {0, 1, 2, 0, 2, 3});           // 12: indices
    append<float>(binary, {0, 0, 1, 0, 1, 0.25F, 0, 1});         // 32: texture coordinates
    append<std::uint8_t>(binary, {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 51, 51, 51, 51});
    binary += "\x89PNG\r\n\x1A\n";
    json = {
        {"asset", {{"version", "2.0"}}},
        {"buffers", {{{"byteLength", binary.size()}}}},
        {"bufferViews",
         {{{"buffer", 0}, {"byteLength", 48}},
          {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 12}},
          {{"buffer", 0}, {"byteOffset", 60}, {"byteLength", 32}},
          {{"buffer", 0}, {"byteOffset", 92}, {"byteLength", 16}},
          {{"buffer", 0}, {"byteOffset", 108}, {"byteLength", 8}}}},
        {"accessors",
         {{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
          {{"bufferView", 1}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}},
          {{"bufferView", 2}, {"componentType", 5126}, {"count", 4}, {"type", "VEC2"}},
          {{"bufferView", 3},
           {"componentType", 5121},
           {"normalized", true},
           {"count", 4},
           {"type", "VEC4"}}}},
        {"images", {{{"name", "skin"}, {"mimeType", "image/png"}, {"bufferView", 4}}}},
        {"textures", {{{"source", 0}}}},
        {"materials",
         {{{"name", "skin"},
           {"pbrMetallicRoughness",
            {{"baseColorFactor", {0.5, 0.25, 0.125, 0.5}}, {"baseColorTexture", {{"index", 0}}}}}},
          {{"name", "glass"},
           {"alphaMode", "BLEND"},
           {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0}}}}}}},
        {"meshes",
         {{{"primitives",
            {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 2}, {"COLOR_0", 3}}},
              {"indices", 1},
              {"material", 0}}}}}}},
        {"nodes", {{{"name", "square"}, {"mesh", 0}}}},
        {"scenes", {{{"nodes", {0}}}}},
        {"scene", 0}};
  }
  std::string file() const { return glb(json, binary); }
};

TEST_CASE("deform/gltf_file/a model comes in with its materials, texture and colours") {
  const auto mesh = parse(Square().file());
  REQUIRE_MESSAGE(mesh, mesh.error().message);
  CHECK(mesh->vertices.col(2) == Eigen::Vector3d(1, 1, 0));
  CHECK(mesh->face_corners == std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3});
  CHECK(mesh->face_starts == std::vector<std::uint32_t>{0, 3, 6});
  // The picture's top is glTF's 0, and 1 of all others.
  CHECK(mesh->texcoords.col(mesh->corner_texcoords[2]) == Eigen::Vector2d(1.0, 0.75));
  const Material* const skin = mesh->look.material_of(1);
  REQUIRE(skin != nullptr);
  CHECK(skin->name == "skin");
  CHECK(*skin->colour == Eigen::Vector4f(0.5F, 0.25F, 0.125F, 1.0F)); // opaque whatever it says
  REQUIRE(skin->texture == 0);
  CHECK(mesh->look.textures[0].file == "skin.png");
  CHECK(*mesh->look.textures[0].contents == "\x89PNG\r\n\x1A\n");
  CHECK_FALSE(mesh->look.materials[1].drawn);
  REQUIRE(mesh->look.vertex_colours.cols() == 4);
  CHECK(mesh->look.vertex_colours.col(1) == Eigen::Vector4f(0, 1, 0, 1));
  CHECK(mesh->look.vertex_colours(0, 3) == doctest::Approx(0.2));
  CHECK(mesh->look.objects.names == std::vector<std::string>{"square"});
}

TEST_CASE("deform/gltf_file/several meshes in their places are one model") {
  Square square;
  const double half = std::sqrt(0.5);
  square.json["nodes"] = {
      {{"name", "head"}, {"mesh", 0}, {"children", {1}}, {"translation", {10, 0, 0}}},
      // A quarter turn about z, and twice as large.
      {{"name", "eye"},
       {"mesh", 0},
       {"rotation", {0, 0, half, half}},
       {"scale", {2, 2, 2}},
       {"children", {2}}},
      {{"name", "mirrored"},
       {"mesh", 0},
       {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}}},
      {{"name", "of another scene"}, {"mesh", 0}}};
  const auto mesh = parse(square.file());
  REQUIRE_MESSAGE(mesh, mesh.error().message);
  REQUIRE(mesh->vertices.cols() == 12);
  CHECK((mesh->vertices.col(1) - Eigen::Vector3d(11, 0, 0)).norm() < 1e-12);
  CHECK((mesh->vertices.col(4 + 1) - Eigen::Vector3d(10, 2, 0)).norm() < 1e-12);
  CHECK((mesh->vertices.col(8 + 1) - Eigen::Vector3d(10, -2, 10)).norm() < 1e-12);
  CHECK(mesh->look.objects.names == std::vector<std::string>{"head", "eye", "mirrored"});
  CHECK(mesh->look.objects.of_face == std::vector<std::uint32_t>{0, 0, 1, 1, 2, 2});
  // Each face still faces along z, also the mirrored one's.
  for (std::size_t face = 0; face < 6; ++face) {
    const auto at = [&](std::size_t k) -> Eigen::Vector3d {
      return mesh->vertices.col(mesh->face_corners[3 * face + k]);
    };
    CHECK((at(1) - at(0)).cross(at(2) - at(0)).z() > 0.5);
  }
}

TEST_CASE("deform/gltf_file/strips, fans, points and no indices") {
  Square square;
  Json& primitive = square.json["meshes"][0]["primitives"][0];
  const auto corners = [&](int mode, bool indexed) {
    primitive["mode"] = mode;
    if (!indexed) primitive.erase("indices");
    const auto mesh = parse(square.file());
    REQUIRE_MESSAGE(mesh, mesh.error().message);
    CHECK(mesh->vertices.cols() == 4);
    return mesh->face_corners;
  };
  using Corners = std::vector<std::uint32_t>;
  CHECK(corners(4, true) == Corners{0, 1, 2, 0, 2, 3});
  CHECK(corners(0, true).empty());
  CHECK(corners(4, false) == Corners{0, 1, 2}); // the fourth is no triangle
  CHECK(corners(5, false) == Corners{0, 1, 2, 1, 3, 2});
  CHECK(corners(6, false) == Corners{0, 1, 2, 0, 2, 3});
  CHECK(corners(1, false).empty());
}

TEST_CASE("deform/gltf_file/a vertex that was split for its texture is one again") {
  Square square;
  std::string more;
  append<float>(more, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0});
  append<float>(more, {0, 0, 1, 0, 1, 1, 0.5F, 0, 0.5F, 1, 0, 1});
  const std::size_t before = square.binary.size();
  square.binary += more;
  square.json["buffers"][0]["byteLength"] = square.binary.size();
  square.json["bufferViews"][0] = {{"buffer", 0}, {"byteOffset", before}, {"byteLength", 72}};
  square.json["bufferViews"][2] = {{"buffer", 0}, {"byteOffset", before + 72}, {"byteLength", 48}};
  square.json["accessors"][0]["count"] = 6;
  square.json["accessors"][2]["count"] = 6;
  auto& primitive = square.json["meshes"][0]["primitives"][0];
  primitive["attributes"].erase("COLOR_0");
  primitive.erase("indices");
  const auto mesh = parse(square.file());
  REQUIRE_MESSAGE(mesh, mesh.error().message);
  CHECK(mesh->vertices.cols() == 4);
  CHECK(mesh->face_corners == std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3});
  CHECK(mesh->texcoords.col(mesh->corner_texcoords[0]).x() == 0.0);
  CHECK(mesh->texcoords.col(mesh->corner_texcoords[3]).x() == 0.5);
}

TEST_CASE("deform/gltf_file/vertices that normals part are one, within the mesh of one node") {
  // A cube of four vertices for each of its sides.
  const Mesh cube = cube_of_cells(1, true);
  std::string places, normals, indices;
  for (std::uint32_t face = 0; face < 6; ++face) {
    const auto corner = [&](std::uint32_t k) -> Eigen::Vector3d {
      return cube.vertices.col(cube.face_corners[4 * face + k]);
    };
    const Eigen::Vector3d normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (std::uint32_t k = 0; k < 4; ++k)
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        append<float>(places, {static_cast<float>(corner(k)[axis])});
        append<float>(normals, {static_cast<float>(normal[axis])});
      }
    for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U})
      append<std::uint16_t>(indices, {static_cast<std::uint16_t>(4 * face + k)});
  }
  const auto view = [](std::size_t from, std::size_t bytes) {
    return Json{{"buffer", 0}, {"byteOffset", from}, {"byteLength", bytes}};
  };
  Json json{
      {"asset", {{"version", "2.0"}}},
      {"buffers", {{{"byteLength", 648}}}},
      {"bufferViews", {view(0, 288), view(288, 288), view(576, 72)}},
      {"accessors",
       {{{"bufferView", 0}, {"componentType", 5126}, {"count", 24}, {"type", "VEC3"}},
        {{"bufferView", 1}, {"componentType", 5126}, {"count", 24}, {"type", "VEC3"}},
        {{"bufferView", 2}, {"componentType", 5123}, {"count", 36}, {"type", "SCALAR"}}}},
      {"meshes",
       {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}}}}}}},
      {"nodes", {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {1, 0, 0}}}}},
      {"scenes", {{{"nodes", {0}}}}},
      {"scene", 0}};
  const std::string binary = places + normals + indices;
  const auto one = parse(glb(json, binary));
  REQUIRE_MESSAGE(one, one.error().message);
  CHECK(one->vertices.cols() == 8);
  CHECK(check_closed_manifold(*one));
  CHECK(volume_of(*one) == doctest::Approx(1.0).epsilon(1e-12));
  // Two nodes are two bodies, though they touch.
  json["scenes"][0]["nodes"] = {0, 1};
  const auto two = parse(glb(json, binary));
  REQUIRE_MESSAGE(two, two.error().message);
  CHECK(two->vertices.cols() == 16);
  CHECK(separate(*two).size() == 2);
  const std::string text = glb(json, binary);
  const auto plain =
      parse_model(std::as_bytes(std::span(text)), "two.glb", {.up = UpAxis::y, .weld = false});
  REQUIRE(plain);
  CHECK(plain->mesh.vertices.cols() == 48);
}

TEST_CASE("deform/gltf_file/a JSON glTF reads its bytes beside it, or has them in itself") {
  const TemporaryFolder folder;
  const Square square;
  const auto path = folder.path() / "square.gltf";
  const auto read = [&](const std::string& uri) {
    Json json = square.json;
    json["buffers"][0]["uri"] = uri;
    std::ofstream(path) << json.dump(1);
    return read_mesh(path);
  };
  std::ofstream(folder.path() / "the square.bin", std::ios::binary) << square.binary;
  const auto beside = read("the%20square.bin");
  REQUIRE_MESSAGE(beside, beside.error().message);
  CHECK(beside->vertices == parse(square.file())->vertices);
  std::string digits;
  for (std::size_t at = 0; at < square.binary.size(); at += 3) { // 116 bytes, padded
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits =
          bits << 8 |
          (at + k < square.binary.size() ? static_cast<unsigned char>(square.binary[at + k]) : 0U);
    for (int shift = 18; shift >= 0; shift -= 6)
      digits +=
          "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"[bits >> shift & 63];
  }
  const auto inside = read("data:application/octet-stream;base64," + digits);
  REQUIRE_MESSAGE(inside, inside.error().message);
  CHECK(inside->vertices == beside->vertices);
  for (const char* const missing :
       {"none.bin", "../the%20square.bin.bin", "/etc/passwd", "", "http://example.org/a.bin"}) {
    CAPTURE(missing);
    const auto refused = read(missing);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == Errc::bad_input);
  }
  std::filesystem::create_directory(folder.path() / "below");
  std::filesystem::rename(path, folder.path() / "below/square.gltf");
  CHECK_FALSE(read_mesh(folder.path() / "below/square.gltf")); // nothing above is read
}

TEST_CASE("deform/gltf_file/what is wrong is refused in one line") {
  const Square whole;
  const auto refused = [&](const std::string& what, const auto& change) {
    CAPTURE(what);
    Square square = whole;
    change(square);
    const auto mesh = parse(square.file());
    CHECK_FALSE(mesh);
    if (mesh) return;
    CHECK(mesh.error().code == Errc::bad_input);
    CHECK(mesh.error().message.starts_with("t: "));
    CHECK(mesh.error().message.find('\n') == std::string::npos);
  };
  constexpr std::uint64_t huge = ~std::uint64_t{0};
  const auto at = [](const char* pointer, const Json& value) {
    return [=](Square& square) { square.json[Json::json_pointer(pointer)] = value; };
  };
  for (const Json& count :
       {Json(0), Json(5), Json(huge), Json(huge / 12), Json(-1), Json("4"), Json(4.5)})
    refused("count", at("/accessors/0/count", count));
  for (const Json& offset : {Json(4), Json(48), Json(huge), Json(huge - 11)}) {
    refused("byteOffset of an accessor", at("/accessors/0/byteOffset", offset));
    refused("byteOffset of a view",
            at("/bufferViews/0/byteOffset", Json(offset == Json(4) ? 100 : 1000)));
    refused("byteLength of a view",
            at("/bufferViews/0/byteLength", offset == Json(48) ? Json(47) : offset));
  }
  for (const Json& stride : {Json(4), Json(huge), Json(huge / 3), Json(16)})
    refused("byteStride", at("/bufferViews/0/byteStride", stride));
  for (const Json& other : {Json(9), Json(huge), Json(-1), Json(Json::object())}) {
    refused("view of an accessor", at("/accessors/0/bufferView", other));
    refused("buffer of a view", at("/bufferViews/0/buffer", other));
    refused("accessor of an attribute", at("/meshes/0/primitives/0/attributes/POSITION", other));
    refused("indices", at("/meshes/0/primitives/0/indices", other));
    refused("material", at("/meshes/0/primitives/0/material", other));
    refused("mesh", at("/nodes/0/mesh", other));
    refused("skin", at("/nodes/0/skin", other));
    refused("node", at("/scenes/0/nodes/0", other));
    refused("scene", at("/scene", other));
    refused("texture", at("/materials/0/pbrMetallicRoughness/baseColorTexture/index", other));
    refused("image", at("/textures/0/source", other));
    refused("view of an image", at("/images/0/bufferView", other));
  }
  refused("component", at("/accessors/0/componentType", 5124));
  refused("type", at("/accessors/0/type", "VEC2"));
  refused("more bytes than there are", at("/buffers/0/byteLength", 4096));
  refused("version", at("/asset/version", "1.0"));
  refused("extension", at("/extensionsRequired", Json::array({"KHR_draco_mesh_compression"})));
  refused("scale", at("/nodes/0/scale", Json::array({1, 2})));
  refused("translation", at("/nodes/0/translation", Json::array({1e300, 0, 0})));
  refused("a child of itself", at("/nodes/0/children", Json::array({0})));
  refused("no meshes", [](Square& square) { square.json.erase("meshes"); });
  refused("an index", [](Square& square) { square.binary[48] = 4; });
  refused("not a number",
          [](Square& square) { square.binary.replace(0, 4, "\xFF\xFF\xFF\x7F", 4); });
  refused("zeros without bytes", [](Square& square) {
    square.json["accessors"][0].erase("bufferView");
    square.json["accessors"][0]["count"] = 1000000;
  });
}

TEST_CASE("deform/gltf_file/a file that is cut off or spoilt anywhere does no harm") {
  const std::string whole = Square().file();
  for (std::size_t length = 0; length < whole.size(); ++length)
    CHECK_FALSE(parse(whole.substr(0, length)));
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (const char byte : {'\0', '\xFF', '9', '{', '"'}) {
      std::string spoilt = whole;
      spoilt[at] = byte;
      const auto mesh = parse(spoilt);
      if (mesh) CHECK(mesh->vertices.allFinite());
    }
  const auto deep =
      parse("{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(100000, '[') +
            std::string(100000, ']') + "}");
  REQUIRE_FALSE(deep);
  CHECK(deep.error().message.find("levels") != std::string::npos);
}

TEST_CASE("deform/gltf_file/sparse numbers are in their places") {
  Square square;
  const std::size_t before = square.binary.size();
  append<std::uint16_t>(square.binary, {2, 0});
  append<float>(square.binary, {7, 8, 9});
  square.json["buffers"][0]["byteLength"] = square.binary.size();
  square.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", before}, {"byteLength", 2}});
  square.json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", before + 4}, {"byteLength", 12}});
  square.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", 5}, {"componentType", 5123}}},
      {"values", {{"bufferView", 6}}}};
  const auto mesh = parse(square.file());
  REQUIRE_MESSAGE(mesh, mesh.error().message);
  CHECK(mesh->vertices.col(2) == Eigen::Vector3d(7, 8, 9));
  CHECK(mesh->vertices.col(1) == Eigen::Vector3d(1, 0, 0));
  square.binary[before] = 4;
  CHECK_FALSE(parse(square.file()));
}

TEST_CASE("deform/gltf_file/sparse numbers are normalised as the others of their accessor") {
  Square square;
  const std::size_t before = square.binary.size();
  append<std::uint8_t>(square.binary, {2, 0, 0, 0, 255, 255, 255, 255});
  square.json["buffers"][0]["byteLength"] = square.binary.size();
  const std::size_t views = square.json["bufferViews"].size();
  for (const std::size_t at : {before, before + 4})
    square.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", 4}});
  square.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      square.json["accessors"].size();
  square.json["accessors"].push_back(
      {{"componentType", 5121},
       {"normalized", true},
       {"count", 4},
       {"type", "VEC4"},
       {"sparse",
        {{"count", 1},
         {"indices", {{"bufferView", views}, {"componentType", 5121}}},
         {"values", {{"bufferView", views + 1}}}}}});
  const auto mesh = parse(square.file());
  REQUIRE_MESSAGE(mesh, mesh.error().message);
  const auto& colours = mesh->look.vertex_colours;
  REQUIRE(colours.cols() == 4);
  CHECK(colours.col(2).head<3>().isApproxToConstant(1.0F));
  CHECK(colours.col(1).head<3>().isZero());
}

} // namespace gltf_file_test
