// STL, text and binary, against bytes that are put together here.

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"

namespace stl_file_test {

using namespace nendo::deform;
using nendo::test::TemporaryFolder;

TEST_SUITE("stl_file") {
  using Indices = std::vector<std::uint32_t>;

  struct Triangle {
    float corners[9];
    std::uint16_t attribute = 0;
  };

  static nendo::Result<ReadModel> parse(std::string_view text, const char* name = "t.stl",
                                        const ReadOptions& options = {UpAxis::y, true}) {
    return parse_model(std::as_bytes(std::span(text)), name, options);
  }

  static std::string bytes_of(const void* data, std::size_t size) {
    return {static_cast<const char*>(data), size}; // tests run on little-endian machines
  }

  static std::string binary(const std::vector<Triangle>& triangles, std::string header = "made",
                            std::int64_t count = -1) {
    header.resize(80);
    const auto counted =
        static_cast<std::uint32_t>(count < 0 ? static_cast<std::int64_t>(triangles.size()) : count);
    std::string text = header + bytes_of(&counted, 4);
    for (const Triangle& one : triangles)
      text += std::string(12, '\0') + bytes_of(one.corners, 36) + bytes_of(&one.attribute, 2);
    return text;
  }

  /// A tetrahedron that faces outwards.
  const std::vector<Triangle> four{{{0, 0, 0, 0, 1, 0, 1, 0, 0}},
                                   {{0, 0, 0, 1, 0, 0, 0, 0, 1}},
                                   {{0, 0, 0, 0, 0, 1, 0, 1, 0}},
                                   {{1, 0, 0, 0, 1, 0, 0, 0, 1}}};
  const Indices four_corners{0, 1, 2, 0, 2, 3, 0, 3, 1, 2, 1, 3};

  static std::string facet(const std::string& corners) {
    std::string text = "facet normal 0 0 0\nouter loop\n";
    for (std::size_t at = 0; at < corners.size(); at += 6)
      text += "vertex " + corners.substr(at, 5) + "\n";
    return text + "endloop\nendfacet\n";
  }
  const std::string facets = facet("0 0 0,0 1 0,1 0 0") + facet("0 0 0,1 0 0,0 0 1") +
                             facet("0 0 0,0 0 1,0 1 0") + facet("1 0 0,0 1 0,0 0 1");

  static void check_tetrahedron(const nendo::Result<ReadModel>& model, const Indices& corners) {
    REQUIRE_MESSAGE(model, model.error().message);
    CHECK(model->mesh.vertices.cols() == 4);
    CHECK(model->mesh.face_starts == Indices{0, 3, 6, 9, 12});
    CHECK(model->mesh.face_corners == corners);
    CHECK(check_closed_manifold(model->mesh));
  }

  TEST_CASE("both forms are read, and vertices of one place are one") {
    for (const std::string& text :
         {binary(four), binary(four, "solid of a program that begins so"),
          "solid\n" + facets + "endsolid\n", "solid a b\r\n" + facets + "endsolid a b\r\n",
          "  SOLID x\n" + facets + "EndSolid x\n", facets, "solid facet\n" + facets + "endsolid"}) {
      CAPTURE(text.substr(0, 40));
      const auto model = parse(text);
      check_tetrahedron(model, four_corners);
      CHECK(model->notes.empty());
    }
  }

  TEST_CASE("a text may have any case, blanks and line ends, and an ending of any case") {
    std::string text = "solid\n" + facets + "endsolid\n";
    for (char& c : text)
      c = c == '\n' ? '\r' : c == ' ' ? '\t' : static_cast<char>(std::toupper(c));
    check_tetrahedron(parse(text, "A.STL"), four_corners);
    check_tetrahedron(parse(text, "no ending"), four_corners);
    check_tetrahedron(parse(binary(four), "no ending"), four_corners);
  }

  TEST_CASE("solids are objects") {
    const auto model =
        parse("solid big part\n" + facet("0 0 0,0 1 0,1 0 0") + "endsolid big part\n" + "solid\n" +
              facet("0 0 0,1 0 0,0 0 1") + "endsolid\n");
    REQUIRE_MESSAGE(model, model.error().message);
    const FaceNames& objects = model->mesh.look.objects;
    CHECK(objects.names == std::vector<std::string>{"big part", "solid 2"});
    CHECK(objects.of_face == Indices{0, 1});
  }

  TEST_CASE("degenerate facets are left out and counted, thin ones stay") {
    auto triangles = four;
    triangles.push_back({{1, 0, 0, 1, 0, 0, 0, 0, 1}});
    triangles.push_back({{2, 0, 0, 3, 0, 0, 4, 0, 0}});
    const auto model = parse(binary(triangles));
    REQUIRE_MESSAGE(model, model.error().message);
    CHECK(model->mesh.face_count() == 5);
    CHECK(model->mesh.vertices.cols() == 4 + 3);
    REQUIRE(model->notes.size() == 1);
    CHECK(model->notes[0] ==
          "1 facet (facet 5) has fewer than three different corners and is left out");
  }

  TEST_CASE("a count that disagrees with the bytes is refused or noted") {
    const auto cut_off = parse(binary(four).substr(0, 84 + 180));
    REQUIRE_FALSE(cut_off);
    CHECK(cut_off.error().message.find("4 triangles, and has bytes for 3") != std::string::npos);
    const auto trailing = parse(binary(four) + "more");
    check_tetrahedron(trailing, four_corners);
    REQUIRE(trailing->notes.size() == 1);
    CHECK(trailing->notes[0] == "4 bytes after the last triangle are left out");
    for (const std::int64_t unknown : {std::int64_t{0}, std::int64_t{0xFFFFFFFF}}) {
      const auto counted = parse(binary(four, "made", unknown));
      check_tetrahedron(counted, four_corners);
      CHECK(counted->notes.size() == 1);
    }
    CHECK_FALSE(parse(binary({})));
    const std::string whole = binary(four);
    for (std::size_t length = 1; length < whole.size(); ++length)
      CHECK_FALSE(parse(std::string_view(whole).substr(0, length)));
  }

  TEST_CASE("what is no number is refused with the place") {
    auto triangles = four;
    triangles[2].corners[4] = std::numeric_limits<float>::quiet_NaN();
    const auto nan = parse(binary(triangles));
    REQUIRE_FALSE(nan);
    // The header, two facets, a normal and four numbers before it; counted from 1.
    CHECK(nan.error().message == "t.stl: byte 213: a coordinate of triangle 3 is not finite");
    const auto word = parse("solid\n" + facet("0 0 0,x 1 0,1 0 0") + "endsolid\n");
    REQUIRE_FALSE(word);
    CHECK(word.error().message.starts_with("t.stl:5: 'x' is not"));
    const auto cut_off = parse("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1");
    REQUIRE_FALSE(cut_off);
    CHECK(cut_off.error().message.find("cut off") != std::string::npos);
    const auto none = parse("solid x\nendsolid x\n");
    REQUIRE_FALSE(none);
    CHECK(none.error().message == "t.stl: is an STL without a facet; export it once more");
  }

  TEST_CASE("colours of facets are materials, in the forms of both programs") {
    auto triangles = four;
    triangles[1].attribute = 0x8000 | 31 << 10; // VisCAM: red
    const auto one = parse(binary(triangles));
    REQUIRE_MESSAGE(one, one.error().message);
    const Appearance& look = one->mesh.look;
    CHECK(look.face_materials == Indices{no_index, 0, no_index, no_index});
    REQUIRE(look.materials.size() == 1);
    CHECK(*look.materials[0].colour == Eigen::Vector4f(1, 0, 0, 1));
    for (auto& triangle : triangles)
      triangle.attribute = 0x8000;
    triangles[1].attribute = 31; // Magics: red
    const auto other = parse(binary(triangles, std::string("x COLOR=\0\xFF\0\xFF", 12)));
    REQUIRE_MESSAGE(other, other.error().message);
    CHECK(other->mesh.look.face_materials == Indices{0, 1, 0, 0});
    CHECK(*other->mesh.look.materials[0].colour == Eigen::Vector4f(0, 1, 0, 1));
    CHECK(*other->mesh.look.materials[1].colour == Eigen::Vector4f(1, 0, 0, 1));
    triangles = four;
    triangles[3].attribute = 7;
    const auto none = parse(binary(triangles));
    REQUIRE(none);
    CHECK(none->mesh.look.materials.empty());
    CHECK(none->notes.size() == 1);
  }

  static std::string contents_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TEST_CASE("what is written is what binary STL is, and reads back") {
    const TemporaryFolder folder;
    const auto path = folder.path() / "m.STL";
    const Mesh sphere = nendo::test::sphere(5, 8, 1.0);
    REQUIRE(write_mesh(path, sphere));
    const std::string text = contents_of(path);
    // 16 triangles at the poles, and two for each of the 32 quads.
    REQUIRE(text.size() == 84 + 80 * 50);
    CHECK_FALSE(text.starts_with("solid"));
    std::uint32_t count = 0;
    std::memcpy(&count, text.data() + 80, 4);
    CHECK(count == 80);
    for (std::size_t at = 84; at < text.size(); at += 50) {
      float numbers[12];
      std::memcpy(numbers, text.data() + at, sizeof numbers);
      const Eigen::Vector3f normal(numbers[0], numbers[1], numbers[2]);
      const Eigen::Vector3f middle = Eigen::Vector3f(numbers[3], numbers[4], numbers[5]) +
                                     Eigen::Vector3f(numbers[6], numbers[7], numbers[8]) +
                                     Eigen::Vector3f(numbers[9], numbers[10], numbers[11]);
      CHECK(normal.norm() == doctest::Approx(1.0));
      CHECK(normal.dot(middle) > 0.0F); // outwards
    }
    const auto back = read_model(path);
    REQUIRE_MESSAGE(back, back.error().message);
    CHECK(back->notes.empty()); // its own files need no advice
    CHECK(back->mesh.vertices.cols() == sphere.vertices.cols());
    CHECK(check_closed_manifold(back->mesh));
    // What was read is written to the bit. The first file's normals were those of doubles.
    REQUIRE(write_mesh(folder.path() / "again.stl", back->mesh));
    const auto again = read_model(folder.path() / "again.stl");
    REQUIRE(again);
    REQUIRE(write_mesh(folder.path() / "third.stl", again->mesh));
    CHECK(contents_of(folder.path() / "third.stl") == contents_of(folder.path() / "again.stl"));
  }

  TEST_CASE("what an STL cannot keep is said") {
    const auto note = [](const Mesh& mesh) {
      const auto notes = lost_in_file("m.stl", mesh);
      return notes.empty() ? std::string() : notes.front();
    };
    Mesh tetrahedron = parse(binary(four))->mesh;
    CHECK(note(tetrahedron).empty());
    CHECK(lost_in_file("m.obj", nendo::test::sphere(3, 4, 1.0)).empty());
    CHECK(note(nendo::test::sphere(3, 4, 1.0)).find("more than three corners") !=
          std::string::npos);
    tetrahedron.vertices.array() += 100000.1;
    CHECK(note(tetrahedron).find("far from the origin") != std::string::npos);
    tetrahedron.vertices.array() *= 1e40;
    const TemporaryFolder folder;
    const auto too_large = write_mesh(folder.path() / "m.stl", tetrahedron);
    REQUIRE_FALSE(too_large);
    CHECK(too_large.error().message.find("too large for the floats") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder.path() / "m.stl"));
  }
}

} // namespace stl_file_test
