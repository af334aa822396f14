// Models as people have them: what is left out of them, and what files of other formats are called.

#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/mesh_file.hpp>

namespace odd_models_test {

using namespace nendo::deform;

TEST_SUITE("odd_models") {
  using Indices = std::vector<std::uint32_t>;

  static nendo::Result<ReadModel> parse(std::string_view text, const ReadOptions& options = {}) {
    return parse_model(std::as_bytes(std::span(text)), "t", options);
  }

  static ReadModel read(std::string_view text, const ReadOptions& options = {}) {
    auto model = parse(text, options);
    REQUIRE_MESSAGE(model, model.error().message);
    return *std::move(model);
  }

  const std::string v4 = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  const std::string tetrahedron = v4 + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

  TEST_CASE("an OBJ's faces that are none are left out, and its repeated corners are one") {
    const auto model =
        read(v4 + "vt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1 2\nf 1/1 3/2 2/3 1/1\n"
                  "usemtl b\nf\nf 2 2 2\nf 1 2 1 2\nf 1 1 2 2 4\nusemtl c\nf 1 4 3\n");
    CHECK(model.mesh.face_starts == Indices{0, 3, 6, 9});
    CHECK(model.mesh.face_corners == Indices{0, 2, 1, 0, 1, 3, 0, 3, 2});
    CHECK(model.mesh.corner_texcoords == Indices{0, 1, 2, 3, 3, 3, 3, 3, 3});
    CHECK(model.mesh.look.face_materials == Indices{0, 1, 2});
    REQUIRE(model.notes.size() == 2);
    CHECK(model.notes[0] == "4 faces (the first is face 1) have fewer than three different corners "
                            "and are left out");
    CHECK(model.notes[1] ==
          "2 faces (the first is face 2) name a corner twice in a row, which is taken once");
  }

  TEST_CASE("a corner that comes back later is a bridge to a hole, and stays") {
    const auto model = read(v4 + "v 2 2 2\nf 1 2 3 1 4 5\n");
    CHECK(model.mesh.face_corners == Indices{0, 1, 2, 0, 3, 4});
    CHECK(model.notes.empty());
  }

  TEST_CASE("a PLY's faces that are none are left out") {
    const std::string text = "ply \nformat ascii 1.0\ncomment nendo\nelement vertex 4\n"
                             "property float x\nproperty float y\nproperty float z\n"
                             "element face 6\nproperty list uchar int vertex_index\nend_header\n"
                             "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                             "0\n3 0 2 1\n2 0 1\n4 0 1 3 0\n3 0 3 2\n3 1 2 3\n";
    const auto model = read(text);
    CHECK(model.mesh.face_corners == Indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
    CHECK(check_closed_manifold(model.mesh));
    CHECK(model.notes.size() == 2);
  }

  TEST_CASE("a backslash before blanks continues an OBJ's line") {
    const auto model = read(v4 + "f 1 3 \\ \t \r\n  2\nf 1 2 4 \\  \n# no more\nf 1 4 3\n");
    CHECK(model.mesh.face_corners == Indices{0, 2, 1, 0, 1, 3, 0, 3, 2});
    CHECK(model.notes.empty());
    const auto wrong = parse(v4 + "f 1 2 \\ \n 3\nf x\n");
    REQUIRE_FALSE(wrong);
    CHECK(wrong.error().message.starts_with("t:7:")); // lines are counted all the same
  }

  TEST_CASE("loose lines, points, curves and weights are left out and noted") {
    const auto model = read(tetrahedron + "l 1 2\nl 2 3\np 1\ncstype bezier\ncurv 0 1 1 2 3\nend\n"
                                          "vn 0 0 1\ns off\nshine 3\nv 1 1 1 0.5\nv 1 1 1 1.0\n");
    REQUIRE(model.notes.size() == 4); // the last is of vertices without a face
    CHECK(model.notes[0] == "2 lines of edges (l), 1 line of points (p), 1 curve or curved surface "
                            "(curv, surf) are left out; only faces (f) are read");
    CHECK(model.notes[1].starts_with("the fourth number of 1 vertex is left out"));
    CHECK(model.notes[2] == "1 line of an unknown kind is left out ('shine' in line 17)");
    CHECK(model.mesh.look.vertex_colours.cols() == 0);
  }

  TEST_CASE("of seven numbers of a vertex, the fourth is w and the last three are its colour") {
    const auto model = read("v 0 0 0 1 1 0 0\nv 1 0 0 2 0 1 0\nv 0 1 0 1 0 0 1\nv 0 0 1 1 1 1 1\n"
                            "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    REQUIRE(model.mesh.look.vertex_colours.cols() == 4);
    CHECK(model.mesh.look.vertex_colours.col(0).head<3>() == Eigen::Vector3f(1, 0, 0));
    CHECK(model.mesh.look.vertex_colours.col(1).head<3>() == Eigen::Vector3f(0, 1, 0));
    CHECK(model.mesh.look.vertex_colours.col(2).head<3>() == Eigen::Vector3f(0, 0, 1));
    CHECK(model.mesh.vertices.col(1) == Eigen::Vector3d(1, 0, 0));
    REQUIRE(model.notes.size() == 1);
    CHECK(model.notes[0].starts_with("the fourth number of 1 vertex is left out"));
  }

  TEST_CASE("exponents with D, as Fortran writes them, are read in each format of text") {
    const std::string obj = "v 0 0 0\nv 1.5D+02 0 0\nv 0 25d-1 0\nf 1 2 3\n";
    const std::string ply = "ply\nformat ascii 1.0\ncomment nendo\nelement vertex 3\n"
                            "property double x\nproperty double y\nproperty double z\n"
                            "element face 1\nproperty list uchar int vertex_index\nend_header\n"
                            "0 0 0\n1.5D+02 0 0\n0 25d-1 0\n3 0 1 2\n";
    const std::string stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
                            "vertex 1.5D+02 0 0\nvertex 0 25d-1 0\nendloop\nendfacet\nendsolid a\n";
    for (const std::string& text : {obj, ply, stl}) {
      CAPTURE(text);
      const auto model = read(text);
      REQUIRE(model.mesh.vertices.cols() == 3);
      CHECK(model.mesh.vertices.col(1) == Eigen::Vector3d(150, 0, 0));
      CHECK(model.mesh.vertices.col(2) == Eigen::Vector3d(0, 2.5, 0));
    }
    for (const char* wrong : {"1D", "D+02", "1DD2", "1e2D2", "0x1D", "1.5D+400"})
      CHECK_FALSE(parse("v 0 0 " + std::string(wrong) + "\n"));
  }

  TEST_CASE("an index of 0 is refused with what to do") {
    const auto model = parse(v4 + "f 0 1 2\n");
    REQUIRE_FALSE(model);
    CHECK(model.error().message.find("counts vertices from 1") != std::string::npos);
  }

  TEST_CASE("zeros after the end of a text are ignored") {
    CHECK(read(tetrahedron + std::string(100, '\0')).mesh.face_count() == 4);
  }

  TEST_CASE("stray vertices keep their numbers, and do not count for the size") {
    auto model = read("v 900 900 900\n" + v4 + "f 2 4 3\nf 2 3 5\nf 2 5 4\nf 3 4 5\nv -700 0 0\n");
    CHECK(model.mesh.vertices.cols() == 6);
    CHECK(stray_vertices(model.mesh) == Indices{0, 5});
    CHECK(box_of_faces(model.mesh).lowest.isZero(0.0));
    CHECK(box_of_faces(model.mesh).highest == Eigen::Vector3d::Ones());
    model.mesh.offset = Eigen::Vector3d(7, 8, 9);
    const auto faces = without_stray_vertices(model.mesh);
    REQUIRE(faces);
    CHECK(faces->offset == model.mesh.offset);
    CHECK(faces->vertices == model.mesh.vertices.middleCols(1, 4));
    CHECK(faces->face_corners == Indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
    CHECK_FALSE(without_stray_vertices(*faces));
    REQUIRE(model.notes.size() == 1);
    CHECK(model.notes[0].starts_with("2 vertices belong to no face"));
    const auto cloud = read(v4);
    CHECK(cloud.notes.empty());
    CHECK(box_of_faces(cloud.mesh).highest == Eigen::Vector3d(1, 1, 1));
  }

  static std::string utf16(std::string_view text, bool big, bool with_mark) {
    std::string wide = with_mark ? (big ? "\xFE\xFF" : "\xFF\xFE") : "";
    for (const char c : text)
      wide += big ? std::string{'\0', c} : std::string{c, '\0'};
    return wide;
  }

  TEST_CASE("a file of another format is called what it is, and what to do is said") {
    using namespace std::string_literals;
    struct Case {
      std::string bytes;
      const char* what;
      const char* remedy;
    };
    const Case cases[] = {
        {"Kaydara FBX Binary  \0\x1A\0"s, "FBX", "export it"},
        {"; FBX 7.3.0 project file\n", "FBX", "export it"},
        {"ISO-10303-21;\nHEADER;\n", "STEP", "STL"},
        {"#usda 1.0\n", "USD", "export it"},
        {"PXR-USDC\0\1"s, "USD", "export it"},
        {"PK\3\4model.usdc"s, "USD", "export it"},
        {"PK\3\4[Content_Types].xml"s, "3MF", "export it"},
        {"PK\3\4readme"s, "zip archive", "unpack"},
        {"Ogawa\xFF"s, "Alembic", "export it"},
        {"\x89HDF\r\n\x1A\n", "HDF5", "export it"},
        {"BLENDER-v304", "Blender", "export it"},
        {"<?xml version=\"1.0\"?>\n<COLLADA>", "Collada", "export it"},
        {"#VRML V2.0 utf8\n", "VRML", "export it"},
        {"OFF\n3 1 0\n", "OFF", "save it"},
        {"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"s, "SolidWorks", "export it"},
        {"DRACO\2\2"s, "Draco", "decode it"},
        {utf16("v 0 0 0\nv 1 0 0\n", false, true), "UTF-16", "UTF-8"},
        {utf16("v 0 0 0\nv 1 0 0\n", true, true), "UTF-16", "UTF-8"},
        {utf16("v 0 0 0\nv 1 0 0\n", false, false), "UTF-16", "UTF-8"},
        {utf16("v 0 0 0\nv 1 0 0\n", true, false), "UTF-16", "UTF-8"},
        {"\xFF\xFE\0\0v\0\0\0"s, "UTF-32", "UTF-8"},
        {"\x1F\x8B\x08"s, "gzip", "unpack"},
        {"BZh91AY", "bzip2", "unpack"},
        {"\xFD\x37zXZ\0"s, "xz", "unpack"},
        {"\x28\xB5\x2F\xFD"s, "zstd", "unpack"},
        {"7z\xBC\xAF\x27\x1C"s, "7z", "unpack"},
        {"Rar!\x1A\7\1\0"s, "RAR", "unpack"},
        {"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "Git LFS", "git lfs pull"},
        {"\n<!DOCTYPE HTML>\n<html>", "page of the web", "download"},
        {"%PDF-1.7", "PDF", "give the file of a model"},
        {"\x89PNG\r\n\x1A\n", "PNG", "give the file of a model"},
        {"\xFF\xD8\xFF\xE0", "JPEG", "give the file of a model"},
        {"# .PCD v0.7\n", "PCD", "MeshLab"},
        {"LASF\0\0"s, "LAS", "MeshLab"},
        {"0.1 0.2 0.3 255 0 0\n0.1 0.2 0.4 1 2 3\n", "XYZ", "MeshLab"},
        {"\x89NENDO\r\n\1\0"s, "recording of Nendo", "nendo replay"},
        {"hello there\n", "'hello there'", "no OBJ"},
        {"hello there\n", "'hello there'", "give the file of a model"},
        {"[1, 2, 3]\n", "JSON or a list", "give the file of a model"},
        {"{\"a\": 1}", "JSON, but no glTF", "give the file of a model"},
        {"{\"type\": \"CityJSON\"}", "CityJSON", "export it"},
        {"{\"type\": \"FeatureCollection\"}", "GeoJSON", "export it"},
        {"{\"metadata\": {}, \"geometries\": []}", "three.js", "export it"},
        {"{\"asset\": {\"version\": \"1.0\"}}", "glTF of version '1.0'", "as glTF 2"},
        {"{\"asset\": {}}", "does not say its version", "as glTF 2"},
        {"{\"asset\": {\"version\"", "damaged JSON", "export it once more"},
        {"\1\2\3\0\5\6"s, "binary data", "give the file of a model"},
    };
    for (const Case& one : cases) {
      const auto model = parse(one.bytes);
      CAPTURE(one.what);
      REQUIRE_FALSE(model);
      const std::string& message = model.error().message;
      CAPTURE(message);
      CHECK(model.error().code == nendo::Errc::bad_input);
      CHECK(message.find(one.what) != std::string::npos);
      CHECK(message.find(one.remedy) != std::string::npos);
      CHECK(message.find('\n') == std::string::npos);
    }
  }

  TEST_CASE("a model with z up is laid so that y is up, and written as it was") {
    const auto model = read(v4 + "v 1 2 3\nf 1 2 3 4 5\n", {UpAxis::z, true});
    CHECK(model.mesh.vertices.col(3) == Eigen::Vector3d(0, 1, 0)); // z, up in the file
    CHECK(model.mesh.vertices.col(2) == Eigen::Vector3d(0, 0, -1));
    CHECK(model.mesh.vertices.col(4) == Eigen::Vector3d(1, 3, -2));
    CHECK(model.notes.empty());
  }

  TEST_CASE("only of formats that cannot say it, a note says which axis is up") {
    const std::string ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                            "property float y\nproperty float z\nend_header\n0 0 0\n";
    REQUIRE(read(ply).notes.size() == 1);
    CHECK(read(ply).notes[0].find("--up z") != std::string::npos);
    CHECK(read(ply, {UpAxis::y, true}).notes.empty());
    CHECK(read(tetrahedron).notes.empty());
  }
}

} // namespace odd_models_test
