// What a glTF has and a model here has not, and shapes that depend on weights and instances.

#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/deform/mesh_file.hpp>

#include "support/temporary_folder.hpp"

namespace gltf_notes_test {

using namespace nendo::deform;
using nendo::test::TemporaryFolder;
using Json = nlohmann::json;

static std::string base64_of(const std::string& bytes) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += at + k > bytes.size() ? '=' : digits[three >> (18 - 6 * k) & 63];
  }
  return text;
}

/// A document whose numbers are added one accessor after the other.
struct Document {
  std::string binary;
  Json json = {{"asset", {{"version", "2.0"}}},
               {"nodes", {{{"mesh", 0}}}},
               {"scenes", {{{"nodes", {0}}}}},
               {"bufferViews", Json::array()},
               {"accessors", Json::array()}};

  template <class Number>
  std::size_t add(const char* type, std::size_t width, int component,
                  std::initializer_list<Number> numbers) {
    while (binary.size() % 4 != 0)
      binary += '\0';
    const std::size_t begin = binary.size();
    for (const Number number : numbers) {
      char raw[sizeof number];
      std::memcpy(raw, &number, sizeof number);
      binary.append(raw, sizeof number);
    }
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", binary.size() - begin}});
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", numbers.size() / width},
                                 {"type", type}});
    return json["accessors"].size() - 1;
  }
  std::size_t add_places(std::initializer_list<float> numbers) {
    return add<float>("VEC3", 3, 5126, numbers);
  }
  Json& primitive() { return json["meshes"][0]["primitives"][0]; }

  Document() {
    const auto places = add_places({0, 0, 0, 1, 0, 0, 0, 1, 0});
    json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", places}}}}}}}};
  }
  std::string text() const {
    Json whole = json;
    whole["buffers"] = {{{"byteLength", binary.size()},
                         {"uri", "data:application/octet-stream;base64," + base64_of(binary)}}};
    return whole.dump();
  }
};

static nendo::Result<ReadModel> parse(const Document& document) {
  const std::string text = document.text();
  return parse_model(std::as_bytes(std::span(text)), "t");
}

static ReadModel read(const Document& document) {
  auto model = parse(document);
  REQUIRE_MESSAGE(model, model.error().message);
  return *std::move(model);
}

static std::string all(const ReadModel& model) {
  std::string text;
  for (const std::string& note : model.notes)
    text += note + "\n";
  return text;
}

TEST_CASE("deform/gltf_notes/a plain model has no notes") {
  CHECK(all(read(Document())) == "");
}

TEST_CASE("deform/gltf_notes/default weights of morph targets make the shape") {
  Document document;
  const auto up = document.add_places({0, 0, 2, 0, 0, 0, 0, 0, 0});
  const auto aside = document.add_places({0, 0, 0, 4, 0, 0, 0, 0, 0});
  document.primitive()["targets"] = {{{"POSITION", up}}, {{"POSITION", aside}}};
  CHECK(read(document).mesh.vertices.col(0) == Eigen::Vector3d::Zero());
  document.json["meshes"][0]["weights"] = {0.5, 0.25};
  const ReadModel by_mesh = read(document);
  CHECK(by_mesh.mesh.vertices.col(0) == Eigen::Vector3d(0, 0, 1));
  CHECK(by_mesh.mesh.vertices.col(1) == Eigen::Vector3d(2, 0, 0));
  CHECK(all(by_mesh) ==
        "2 morph targets left out; the model is read in its default shape and pose\n");
  // A node's own weights count instead, before the node moves them.
  document.json["nodes"][0]["weights"] = {1, 0};
  document.json["nodes"][0]["translation"] = {10, 0, 0};
  const ReadModel by_node = read(document);
  CHECK(by_node.mesh.vertices.col(0) == Eigen::Vector3d(10, 0, 2));
  CHECK(by_node.mesh.vertices.col(1) == Eigen::Vector3d(11, 0, 0));
}

TEST_CASE("deform/gltf_notes/damaged morph targets are refused where they count") {
  Document document;
  const auto two = document.add_places({0, 0, 2, 0, 0, 0});
  document.primitive()["targets"] = {{{"POSITION", two}}};
  CHECK(parse(document));
  document.json["meshes"][0]["weights"] = {1};
  const auto refused = parse(document);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message == "t: a morph target is of another size than its vertices");
  document.json["meshes"][0]["weights"] = {"x"};
  CHECK_FALSE(parse(document));
}

TEST_CASE("deform/gltf_notes/instances are as many meshes") {
  Document document;
  const auto places = document.add_places({1, 0, 0, 0, 5, 0});
  const auto turns = document.add<float>("VEC4", 4, 5126, {0, 0, 0, 1, 0, 0, 1, 0}); // 180 degrees
  const auto sizes = document.add_places({1, 1, 1, 2, 2, 2});
  document.json["nodes"][0]["translation"] = {0, 0, 7};
  document.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", places}, {"ROTATION", turns}, {"SCALE", sizes}};
  document.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  document.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const ReadModel model = read(document);
  CHECK(all(model) == "");
  REQUIRE(model.mesh.face_count() == 2);
  REQUIRE(model.mesh.vertices.cols() == 6);
  CHECK(model.mesh.vertices.col(1).isApprox(Eigen::Vector3d(2, 0, 7)));
  CHECK(model.mesh.vertices.col(4).isApprox(Eigen::Vector3d(-2, 5, 7)));
  CHECK(model.mesh.vertices.col(5).isApprox(Eigen::Vector3d(0, 3, 7)));
}

TEST_CASE("deform/gltf_notes/compressed models are refused for what they are") {
  for (const char* const name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    Document document;
    document.json["extensionsRequired"] = {name};
    const auto refused = parse(document);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message ==
          "t: is compressed by meshopt (" + std::string(name) +
              "), which is not read; export it without compression (gltfpack without -c and -cc), "
              "or run: gltf-transform copy IN.glb OUT.glb");
    // gltfpack leaves the buffer empty that others may fall back to.
    Json json = Document().json;
    json["buffers"] = {{{"byteLength", 36}, {"extensions", {{name, {{"fallback", true}}}}}}};
    const std::string text = json.dump();
    const auto fallback = parse_model(std::as_bytes(std::span(text)), "t");
    REQUIRE_FALSE(fallback);
    CHECK(fallback.error().message == refused.error().message);
  }
  Document document;
  document.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const auto refused = parse(document);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message.find("is compressed by Draco (KHR_draco_mesh_compression)") !=
        std::string::npos);
}

TEST_CASE("deform/gltf_notes/what is left out is named and counted") {
  Document document;
  document.json["animations"] = {Json::object(), Json::object()};
  document.json["skins"] = {{{"joints", {0}}}};
  document.json["cameras"] = {Json::object()};
  document.json["scenes"].push_back(Json::object());
  document.json["extensionsUsed"] = {"VRM", "KHR_lights_punctual", "KHR_materials_unlit"};
  document.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "red"}},
                                                                       {{"name", "blue"}}};
  document.json["materials"] = {
      {{"normalTexture", {{"index", 0}}}, {"emissiveTexture", {{"index", 0}}}}};
  document.primitive()["attributes"]["TEXCOORD_1"] = 0;
  document.primitive()["attributes"]["COLOR_1"] = 0;
  Json lines = document.primitive();
  lines["mode"] = 1;
  Json points = document.primitive();
  points["mode"] = 0;
  document.json["meshes"][0]["primitives"].push_back(lines);
  document.json["meshes"][0]["primitives"].push_back(points);
  document.json["meshes"][0]["primitives"].push_back(points);
  CHECK(all(read(document)) ==
        "2 animations and 1 skeleton left out; the model is read in its default shape and pose\n"
        "2 sets of points and 1 set of lines left out; only faces are read\n"
        "colours of vertices 'COLOR_1': are left out; those of COLOR_0 are read\n"
        "of materials, base colours and their textures are read; left out: emissive and normal "
        "textures\n"
        "variant of materials 'red' (and 1 other): is left out; the default materials are read\n"
        "1 scene left out; the default scene is read, so export each by itself if it is wanted\n"
        "glTF's extension 'VRM': is not known here, so what it adds is left out\n"
        "texture coordinates 'TEXCOORD_1': are left out; those of the base colour are read\n");
}

TEST_CASE("deform/gltf_notes/an image that is missing is named") {
  const TemporaryFolder folder;
  Document document;
  document.json["images"] = {{{"uri", "gone%20away.png"}}};
  document.json["textures"] = {{{"source", 0}}};
  document.json["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}, {"alphaMode", "MASK"}}};
  document.primitive()["material"] = 0;
  document.primitive()["attributes"]["TEXCOORD_0"] =
      document.add<float>("VEC2", 2, 5126, {0, 0, 1, 0, 0, 1});
  std::ofstream(folder.path() / "m.gltf") << document.text();
  const auto model = read_model(folder.path() / "m.gltf");
  REQUIRE(model);
  CHECK(all(*model) ==
        "texture 'gone away.png': there is no such file; put it beside the model\n"
        "material: the transparency of its texture is left out, so what it hides is seen\n");
  // The name may be written in other letters.
  std::ofstream(folder.path() / "Gone Away.PNG") << "picture";
  const auto found = read_model(folder.path() / "m.gltf");
  REQUIRE(found);
  REQUIRE(found->mesh.look.textures[0].contents);
  CHECK(found->mesh.look.textures[0].file == "Gone Away.PNG");
}

TEST_CASE("deform/gltf_notes/a picture of another format is the texture where there is no other") {
  Document document;
  document.json["extensionsRequired"] = {"EXT_texture_webp"};
  document.json["images"] = {
      {{"uri", "data:image/webp;base64,UklGRgAAAABXRUJQ"}, {"name", "skin"}}};
  document.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
  document.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  document.primitive()["material"] = 0;
  const ReadModel model = read(document);
  REQUIRE(model.mesh.look.textures.size() == 1);
  CHECK(model.mesh.look.textures[0].contents->starts_with("RIFF"));
  CHECK(all(model).find("a part of the model has no texture coordinates") != std::string::npos);
}

TEST_CASE("deform/gltf_notes/colours of the older extension are base colours") {
  Document document;
  document.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
      {"diffuseFactor", {0.5, 0.25, 0.125, 1.0}}};
  document.primitive()["material"] = 0;
  const ReadModel model = read(document);
  CHECK(*model.mesh.look.materials[0].colour == Eigen::Vector4f(0.5F, 0.25F, 0.125F, 1.0F));
}

TEST_CASE("deform/gltf_notes/colours of vertices that are not called normalized are scaled") {
  Document document;
  document.primitive()["attributes"]["COLOR_0"] =
      document.add<std::uint8_t>("VEC4", 4, 5121, {255, 0, 51, 255, 0, 0, 0, 255, 1, 0, 0, 255});
  const ReadModel bytes = read(document);
  REQUIRE(bytes.mesh.look.vertex_colours.cols() == 3);
  CHECK(bytes.mesh.look.vertex_colours.col(0).isApprox(Eigen::Vector4f(1.0F, 0.0F, 0.2F, 1.0F)));
  CHECK(bytes.mesh.look.vertex_colours(0, 2) == doctest::Approx(1.0 / 255.0));
  document.primitive()["attributes"]["COLOR_0"] = document.add<std::uint16_t>(
      "VEC4", 4, 5123, {65535, 0, 13107, 65535, 0, 0, 0, 65535, 0, 0, 0, 0});
  CHECK(read(document).mesh.look.vertex_colours.col(0).isApprox(
      Eigen::Vector4f(1.0F, 0.0F, 0.2F, 1.0F)));
  document.primitive()["attributes"]["COLOR_0"] =
      document.add<float>("VEC3", 3, 5126, {255, 0, 51, 0, 0, 0, 0, 0, 0});
  const ReadModel floats = read(document);
  CHECK(floats.mesh.look.vertex_colours.col(0).isApprox(Eigen::Vector4f(1.0F, 0.0F, 0.2F, 1.0F)));
  CHECK(all(floats) == "COLOR_0: colours above 1 were found, so colours are read as 0 to 255\n");
}

} // namespace gltf_notes_test
