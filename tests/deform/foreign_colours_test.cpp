// Triangle strips of PLY, and colours as other programs name them.

#include <array>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nendo/deform/mesh_file.hpp>

namespace foreign_colours_test {

using namespace nendo::deform;

TEST_SUITE("foreign_colours") {
  using Indices = std::vector<std::uint32_t>;

  static ReadModel read(const std::string& text) {
    auto model = parse_model(std::as_bytes(std::span(text)), "t", {UpAxis::y, true});
    REQUIRE_MESSAGE(model, model.error().message);
    return *std::move(model);
  }

  static std::string ply(const std::string& more_of_vertex, const std::string& elements,
                         const std::string& body) {
    return "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
           "property float z\n" +
           more_of_vertex + elements + "end_header\n" + body;
  }
  const std::string six = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n";

  TEST_CASE("strips of triangles become triangles that face one way") {
    const std::string list = "element tristrips 1\nproperty list int int vertex_indices\n";
    const auto model = read(ply("", list, six + "12 0 1 2 3 4 -1 2 3 4 -1 4 5\n"));
    // Every second triangle is turned, and each strip begins again.
    CHECK(model.mesh.face_corners == Indices{0, 1, 2, 2, 1, 3, 2, 3, 4, 2, 3, 4});
    CHECK(model.mesh.face_starts == Indices{0, 3, 6, 9, 12});
    // A corner twice leads the strip to another place, and keeps count of the turns.
    const auto led = read(ply("", list, six + "8 0 1 2 3 3 2 4 5\n"));
    CHECK(led.mesh.face_corners == Indices{0, 1, 2, 2, 1, 3, 3, 2, 4, 4, 2, 5});
    const std::string unsigned_list = "element tristrips 1\nproperty list uint uint vertex_index\n";
    const auto other = read(ply("", unsigned_list, six + "7 0 1 2 4294967295 2 1 3\n"));
    CHECK(other.mesh.face_corners == Indices{0, 1, 2, 2, 1, 3});
    const std::string beyond = ply("", list, six + "3 0 1 6\n");
    CHECK_FALSE(parse_model(std::as_bytes(std::span(beyond)), "t"));
  }

  TEST_CASE("colours are known by several names") {
    const std::string body = "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n1 1 0 255 255 255\n"
                             "0 2 0 0 0 0\n1 2 0 0 0 0\n3 0 1 2\n3 3 4 5\n";
    const std::string face = "element face 2\nproperty list uchar int vertex_indices\n";
    for (const std::array<const char*, 3>& names :
         {std::array{"red", "green", "blue"}, std::array{"r", "g", "b"},
          std::array{"diffuse_red", "diffuse_green", "diffuse_blue"},
          std::array{"ambient_red", "ambient_green", "ambient_blue"}}) {
      std::string properties;
      for (const char* const name : names)
        properties += std::string("property uchar ") + name + "\n";
      const auto model = read(ply(properties, face, body));
      CAPTURE(names[0]);
      const Eigen::Matrix4Xf& colours = model.mesh.look.vertex_colours;
      REQUIRE(colours.cols() == 6);
      CHECK(colours.col(0) == Eigen::Vector4f(1, 0, 0, 1));
      CHECK(colours.col(1) == Eigen::Vector4f(0, 1, 0, 1));
      CHECK(colours.col(2) == Eigen::Vector4f(0, 0, 1, 1));
    }
  }

  TEST_CASE("what a PLY has and a mesh cannot keep is said, but normals") {
    const auto model =
        read(ply("property float nx\nproperty float quality\nproperty float s\n",
                 "element face 1\nproperty list uchar int vertex_indices\nproperty uchar flags\n"
                 "element edge 2\nproperty int vertex1\nproperty int vertex2\n",
                 "0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n1 1 0 1 2 3\n0 2 0 1 2 3\n1 2 0 1 2 3\n"
                 "6 0 1 2 3 4 5 7\n0 1\n1 2\n"));
    REQUIRE(model.notes.size() == 3);
    CHECK(model.notes[0] == "the properties quality, s of each 'vertex' are left out");
    CHECK(model.notes[1] == "the property flags of each 'face' is left out");
    CHECK(model.notes[2] == "2 of the element 'edge' are left out");
  }

  TEST_CASE("ZBrush's colours in comments of an OBJ are colours of vertices") {
    const std::string obj = "#Vertex Count 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                            "# as text\n#MRGB ffff0000FF00FF00\n#MRGB 000000bc\nf 1 2 3\n";
    const auto model = read(obj);
    const Eigen::Matrix4Xf& colours = model.mesh.look.vertex_colours;
    REQUIRE(colours.cols() == 3);
    CHECK(colours.col(0) == Eigen::Vector4f(1, 0, 0, 1));
    CHECK(colours.col(1) == Eigen::Vector4f(0, 1, 0, 1));
    // 0xBC of sRGB is about half of the light.
    CHECK(colours(2, 2) == doctest::Approx(0.5).epsilon(0.01));
    CHECK(model.notes.empty());
  }
}

} // namespace foreign_colours_test
