#include <nendo/deform/mesh_file.hpp>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"

namespace mesh_file_test {

using namespace nendo::deform;
using nendo::Errc;
using nendo::test::TemporaryFolder;
namespace fs = std::filesystem;

TEST_SUITE("mesh_file") {
  using Indices = std::vector<std::uint32_t>;

  static nendo::Result<Mesh> parse(std::string_view text) {
    auto model = parse_model(std::as_bytes(std::span(text)), "t");
    if (!model) return model.error();
    return std::move(model->mesh);
  }

  static std::string contents_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  static void check_same(const Mesh& mesh, const Mesh& expected) {
    CHECK(mesh.vertices == expected.vertices);
    CHECK(mesh.face_starts == expected.face_starts);
    CHECK(mesh.face_corners == expected.face_corners);
  }

  /// A triangle, a quad and a pentagon over vertices that only a shortest-round-trip writer keeps.
  static Mesh odd_mesh() {
    Mesh mesh;
    std::mt19937 random(41);
    mesh.vertices = nendo::test::random_points(random, 7, 1.0);
    mesh.vertices.col(0) << 0.1, 1.0 / 3.0, -0.0;
    mesh.vertices.col(1) << 5e-324, 1e100, -1.7976931348623157e-300;
    nendo::test::add_face(mesh, {0, 1, 2});
    nendo::test::add_face(mesh, {6, 5, 4, 3});
    nendo::test::add_face(mesh, {2, 3, 4, 0, 6});
    return mesh;
  }

  /// Most significant byte first if `big`, by shifts: not by the code under test.
  template <class Number>
  static std::string bytes(Number number, bool big) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof number); // tests run on little-endian machines
    std::string text;
    for (std::size_t i = 0; i < sizeof number; ++i)
      text += static_cast<char>(bits >> (8 * (big ? sizeof number - 1 - i : i)) & 0xFF);
    return text;
  }

  const std::string ascii_ply = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 3\n"
                                "property float x\nproperty float y\nproperty float z\n"
                                "element face 1\nproperty list uchar int vertex_indices\n"
                                "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

  static std::string replaced(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  }

  TEST_CASE("an OBJ is read whatever way it is written") {
    const auto mesh =
        parse("# c\r\nmtllib a.mtl\r\no thing\r\nv 0 0 0\r\nv\t1.0e0 +0 0 0.5 0.5 1\r\n"
              "v 0 1 \\\r\n 0 # the third\nv 0 0 1 1.0\nvn 0 0 1\nvt .5\nvt 0 1 0\n"
              "l 1 2\np 1\ns off\nf 1 2 3\nf -4 -2 -1 \\\n2\n"
              "f 1/1 2/2/1 3/-1\nf 1//1 2//1 4//-1\n#f 9 9 9\nf 1 2 5\nv 2 2 2");
    REQUIRE_MESSAGE(mesh, mesh.error().message);
    CHECK(mesh->vertices.cols() == 5);
    CHECK(mesh->vertices.col(2) == Eigen::Vector3d(0, 1, 0));
    CHECK(mesh->face_starts == Indices{0, 3, 7, 10, 13, 16});
    CHECK(mesh->face_corners == Indices{0, 1, 2, 0, 2, 3, 1, 0, 1, 2, 0, 1, 3, 0, 1, 4});
    // Corners without a texture coordinate get one of their own, at the origin.
    CHECK(mesh->texcoords.cols() == 3);
    CHECK(mesh->texcoords.col(0) == Eigen::Vector2d(0.5, 0));
    CHECK(mesh->texcoords.col(2).isZero(0.0));
    CHECK(mesh->corner_texcoords == Indices{2, 2, 2, 2, 2, 2, 2, 0, 1, 1, 2, 2, 2, 2, 2, 2});
  }

  /// The text with other line ends in place of \n.
  static std::string with_line_ends(const std::string& text, const std::string& line_end) {
    std::string changed;
    for (const char c : text)
      changed += c == '\n' ? line_end : std::string(1, c);
    return changed;
  }

  TEST_CASE("whatever ends the lines, and with a byte-order mark, it is the same mesh") {
    const std::string obj = "# a\nv 0 0 0\nv 1 0 0\n\nv 0 1 \\\n0\nvt 0 1\n"
                            "f 1/1 2/1 3/1\nf 3 2 1 # b\nf 1 3 2";
    for (const std::string& text : {obj, ascii_ply}) {
      const auto expected = parse(text);
      REQUIRE_MESSAGE(expected, expected.error().message);
      CHECK(expected->vertices.cols() == 3);
      for (const std::string line_end : {"\n", "\r\n", "\r"}) {
        for (const std::string mark : {"", "\xEF\xBB\xBF"}) {
          const auto mesh = parse(mark + with_line_ends(text, line_end));
          REQUIRE_MESSAGE(mesh, mesh.error().message);
          check_same(*mesh, *expected);
          CHECK(mesh->texcoords == expected->texcoords);
        }
      }
    }
    const auto wrong = parse("v 0 0 0\rv 1 0 0\r\rf 1 2 x\r");
    REQUIRE_FALSE(wrong);
    CHECK(wrong.error().message.starts_with("t:4: ")); // lines are counted all the same
  }

  TEST_CASE("a binary PLY whose lines end with CR may begin its body with any byte") {
    for (const std::uint8_t first : {std::uint8_t{'\n'}, std::uint8_t{'\r'}, std::uint8_t{7}}) {
      std::string text = "ply\rformat binary_little_endian 1.0\relement vertex 1\r"
                         "property uchar x\rproperty uchar y\rproperty uchar z\rend_header\r";
      text += static_cast<char>(first);
      text += "\x01\x02";
      const auto mesh = parse(text);
      REQUIRE_MESSAGE(mesh, mesh.error().message);
      CHECK(mesh->vertices.col(0) == Eigen::Vector3d(first, 1, 2));
    }
  }

  TEST_CASE("a mesh that has no surface or no size is remarked on") {
    const auto remark = [](std::string_view text) {
      const auto mesh = parse(text);
      REQUIRE_MESSAGE(mesh, mesh.error().message);
      return std::string(warning_about(*mesh));
    };
    CHECK(remark("v 0 0 0\nv 1 0 0\nv 0 1 0\n").find("no faces") != std::string::npos);
    CHECK(remark("v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n").find("one place") != std::string::npos);
    CHECK(remark("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").empty()); // thin, but not nothing
  }

  TEST_CASE("texture coordinates that no face uses are dropped") {
    const auto mesh = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1 2 3\n");
    REQUIRE(mesh);
    CHECK(mesh->texcoords.cols() == 0);
    CHECK(mesh->corner_texcoords.empty());
  }

  TEST_CASE("a PLY is read in ASCII and either byte order, with any types, order and extras") {
    const Mesh expected = odd_mesh();
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      const bool ascii = *format == 'a';
      const bool big = std::strcmp(format, "binary_big_endian") == 0;
      std::string text = std::string("ply\r\nformat ") + format +
                         " 1.0\r\nobj_info x\r\nelement face 3\r\nproperty uchar red\r\n"
                         "property list ushort uint vertex_index\r\nelement empty 4294967295\r\n"
                         "element other 2\r\nproperty list int8 float64 weights\r\n"
                         "element vertex 7\r\nproperty double z\r\nproperty float32 quality\r\n"
                         "property double x\r\nproperty double y\r\nend_header\r\n";
      const auto put = [&](auto number) {
        if (!ascii) {
          text += bytes(number, big);
          return;
        }
        char digits[40];
        std::snprintf(digits, sizeof digits, "%.17g ", static_cast<double>(number));
        text += digits;
      };
      for (std::size_t face = 0; face < 3; ++face) {
        put(std::uint8_t{200});
        put(static_cast<std::uint16_t>(face + 3));
        for (auto at = expected.face_starts[face]; at < expected.face_starts[face + 1]; ++at)
          put(expected.face_corners[at]);
      }
      put(std::int8_t{0});
      put(std::int8_t{1});
      put(std::nan(""));
      for (Eigen::Index vertex = 0; vertex < 7; ++vertex) {
        put(expected.vertices(2, vertex));
        put(0.5F);
        put(expected.vertices(0, vertex));
        put(expected.vertices(1, vertex));
      }
      const auto mesh = parse(text);
      REQUIRE_MESSAGE(mesh, mesh.error().message);
      check_same(*mesh, expected);
    }
  }

  TEST_CASE("every scalar type of a PLY is understood") {
    struct Case {
      const char* type;
      std::string bytes;
    };
    const Case cases[] = {
        {"char", bytes(std::int8_t{-7}, true)},
        {"uchar", bytes(std::uint8_t{249}, true)},
        {"short", bytes(std::int16_t{-7}, true)},
        {"ushort", bytes(std::uint16_t{249}, true)},
        {"int", bytes(std::int32_t{-7}, true)},
        {"uint32", bytes(std::uint32_t{249}, true)},
        {"float", bytes(-7.0F, true)},
        {"float64", bytes(249.0, true)},
    };
    for (const Case& one : cases) {
      std::string text = "ply\nformat binary_big_endian 1.0\nelement vertex 1\n";
      for (const char* axis : {" x\n", " y\n", " z\n"})
        text.append("property ").append(one.type).append(axis);
      text += "end_header\n";
      for (int axis = 0; axis < 3; ++axis)
        text += one.bytes;
      const auto mesh = parse(text);
      REQUIRE(mesh);
      CHECK((mesh->vertices(2, 0) == -7.0 || mesh->vertices(2, 0) == 249.0));
    }
  }

  TEST_CASE("what is written reads back exactly") {
    const TemporaryFolder folder;
    for (const char* name : {"mesh.obj", "mesh.ply"}) {
      const fs::path path = folder.path() / name;
      REQUIRE(write_mesh(path, odd_mesh()));
      const auto mesh = read_mesh(path);
      REQUIRE(mesh);
      check_same(*mesh, odd_mesh());
      CHECK(std::signbit(mesh->vertices(2, 0)));
      CHECK(contents_of(path).find("nendo") != std::string::npos);
    }
  }

  TEST_CASE("texture coordinates survive an OBJ, faces of more than 255 corners a PLY") {
    const TemporaryFolder folder;
    Mesh mesh = odd_mesh();
    mesh.texcoords = mesh.vertices.topRows<2>();
    mesh.corner_texcoords = mesh.face_corners;
    std::rotate(mesh.corner_texcoords.begin(), mesh.corner_texcoords.begin() + 1,
                mesh.corner_texcoords.end());
    REQUIRE(write_mesh(folder.path() / "m.obj", mesh));
    const auto textured = read_mesh(folder.path() / "m.obj");
    REQUIRE(textured);
    check_same(*textured, mesh);
    CHECK(textured->texcoords == mesh.texcoords);
    CHECK(textured->corner_texcoords == mesh.corner_texcoords);

    for (std::uint32_t corner = 0; corner < 300; ++corner) // never one twice in a row
      mesh.face_corners.push_back(corner % static_cast<std::uint32_t>(mesh.vertices.cols()));
    mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
    REQUIRE(write_mesh(folder.path() / "m.ply", mesh));
    const auto large = read_mesh(folder.path() / "m.ply");
    REQUIRE(large);
    check_same(*large, mesh);
  }

  TEST_CASE("a file that cannot be used is refused with the place and the reason") {
    struct Case {
      std::string text;
      const char* message;
    };
    const std::string v3 = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const std::string binary =
        replaced(ascii_ply.substr(0, ascii_ply.find("0 0 0")), "ascii", "binary_little_endian");
    const std::string vertices(36, '\0');
    const Case cases[] = {
        {"", "t: is empty"},
        {"\n\n# nothing\n", "t: has no vertices"},
        {std::string("\0\xff\n\x89PNG", 7), "t: has no vertices"},
        {"v 1 2\n", "t:1: needs 3 numbers, has 2"},
        {"v 0 0 0\nv 1 2 x\n", "t:2: 'x' is not"},
        {"v 0 0 nan\n", "t:1: 'nan'"},
        {"v 0 -inf 0\n", "t:1: '-inf'"},
        {"v 0 1e999 0\n", "t:1: '1e999'"},
        {"v 0 1,5 0\n", "t:1: '1,5'"},
        {"v 0 0x10 0\n", "t:1: '0x10'"},
        {v3 + "f 1 2 4\n", "t:4: a face names vertex 4 of 3"},
        {v3 + "f 1 2 3\nf 1 \\\n 2 -4\n", "t:6: '-4' names no vertex"},
        {v3 + "f 0 1 2\n", "t:4: '0' names no vertex"},
        {v3 + "f 1 2 99999999999999999999\n", "t:4: '99999999999999999999' names"},
        {v3 + "f 1 2 4294967296\n", "t:4: '4294967296' names no vertex"},
        {v3 + "f 1 2 3.5\n", "t:4: '3.5' names no vertex"},
        {v3 + "f /1 2 3\n", "t:4: '/1' names no vertex"},
        {v3 + "vt 0 0\nf 1/1 2/2 3/1\n", "t:5: a face names texture coordinate 2 of 1"},
        {v3 + "f 1/0 2/1 3/1\n", "t:4: '1/0' names no texture"},
        {"vt\n", "t:1: needs 1 numbers"},
        {std::string(1 << 20, 'v') + "\nv 1 2 " + std::string(1 << 20, '9'), "t:2: '9999"},
        {"ply\n", "t:2: the file ends within its header"},
        {"ply\nelement vertex 1\nend_header\n", "t:3: the header ends without a format"},
        {replaced(ascii_ply, "1.0", "2.0"), "t:2: PLY version '2.0'"},
        {replaced(ascii_ply, "ascii", "ebcdic"), "t:2: PLY format 'ebcdic'"},
        {replaced(ascii_ply, "comment", "remark"), "t:3: 'remark'"},
        {replaced(ascii_ply, "vertex 3", "vertex -3"), "t:4: '-3' is not a number of"},
        {replaced(ascii_ply, "vertex 3", "vertex many"), "t:4: 'many' is not a number of"},
        {replaced(ascii_ply, "vertex 3", "vertex 1000000000"), "t:11: the header promises"},
        {replaced(ascii_ply, "face 1", "face 4000000000"), "t:13: the header promises"},
        {replaced(ascii_ply, "element face", "element vertex"),
         "t:8: element 'vertex' comes twice"},
        {replaced(ascii_ply, "float z", "vec3 z"), "t:7: type 'vec3'"},
        {replaced(ascii_ply, "list uchar", "list pair"), "t:9: type 'pair'"},
        {replaced(ascii_ply, "float z", "float"), "t:7: a property without a name"},
        {replaced(ascii_ply, "float z", "float w"), "t: a PLY vertex needs one x"},
        {replaced(ascii_ply, "vertex_indices", "strip"), "t: a PLY face needs one list"},
        {replaced(ascii_ply, "1 0 0", "1 nan 0"), "t:12: a coordinate is not finite"},
        {replaced(ascii_ply, "1 0 0", "1 x 0"), "t:12: 'x' is not a number"},
        {replaced(ascii_ply, "3 0 1 2", "3 0 1"), "the file is cut off"},
        {replaced(ascii_ply, "3 0 1 2", "-3 0 1 2"), "t:14: the length of a list"},
        {replaced(ascii_ply, "3 0 1 2", "3000 0 1"), "t:14: a list of 3000 reaches"},
        {replaced(ascii_ply, "3 0 1 2", "3 0 1 3"), "t:14: a face names vertex 3"},
        {replaced(ascii_ply, "3 0 1 2", "3 0 1 -1"), "t:14: a vertex index is not"},
        {replaced(ascii_ply, "3 0 1 2", "3 0 1 1.5"), "t:14: a vertex index is not"},
        {replaced(ascii_ply, "vertex 3", "vertex 0"), "t: has no vertices"},
        {binary + vertices.substr(1), "t: byte 185: the header promises 3 of 'vertex'"},
        {binary + vertices, "the header promises 1 of 'face'"},
        {binary + vertices + '\xff', "a list of 255 reaches beyond"},
        {binary + bytes(std::nanf(""), false) + vertices, "a coordinate is not finite"},
        {replaced(binary, "uchar", "char") + vertices + '\xff', "the length of a list"},
    };
    for (const Case& one : cases) {
      CAPTURE(one.text.substr(0, 300));
      const auto mesh = parse(one.text);
      REQUIRE_FALSE(mesh);
      CHECK(mesh.error().code == Errc::bad_input);
      CAPTURE(mesh.error().message);
      CHECK(mesh.error().message.find(one.message) != std::string::npos);
      CHECK(mesh.error().message.find('\n') == std::string::npos);
      CHECK(mesh.error().message.size() < 200);
    }
  }

  TEST_CASE("a binary PLY cut anywhere is refused") {
    const TemporaryFolder folder;
    REQUIRE(write_mesh(folder.path() / "m.ply", odd_mesh()));
    const std::string whole = contents_of(folder.path() / "m.ply");
    CHECK(parse(whole));
    for (std::size_t length = 5; length < whole.size(); ++length)
      CHECK_FALSE(parse(std::string_view(whole).substr(0, length)));
  }

  TEST_CASE("what is not a readable regular file is refused at once") {
    const TemporaryFolder folder;
    const fs::path pipe = folder.path() / "pipe";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    const fs::path huge = folder.path() / "huge.obj";
    std::ofstream(huge).close();
    std::error_code unsupported;
    fs::resize_file(huge, (std::uintmax_t{4} << 30) + 1, unsupported);
    for (const fs::path& path :
         {fs::path("/nowhere.obj"), folder.path(), fs::path("/dev/zero"), pipe, huge}) {
      const auto mesh = read_mesh(path);
      REQUIRE_FALSE(mesh);
      CHECK(mesh.error().code == Errc::bad_input);
      CHECK(mesh.error().message.starts_with(path.string() + ": "));
    }
  }

  TEST_CASE("a write that fails leaves the old file and nothing else") {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "m.obj";
    REQUIRE(write_mesh(path, nendo::test::grid(2, 1.0)));
    const std::string before = contents_of(path);
    // A limit on the size of files fails a write half-way, as a full disk does.
    rlimit old{};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &old) == 0);
    const rlimit low{1000, old.rlim_max};
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &low) == 0);
    const auto written = write_mesh(path, nendo::test::grid(50, 1.0));
    ::setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, old_handler);
    REQUIRE_FALSE(written);
    CHECK(written.error().code == Errc::failed);
    CHECK(contents_of(path) == before);
    CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);

    Mesh spoilt = nendo::test::grid(2, 1.0);
    spoilt.vertices(1, 3) = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(write_mesh(path, spoilt));
    CHECK(contents_of(path) == before);
  }

  TEST_CASE("writing where it cannot be done is an error, an unknown ending wrong usage") {
    const TemporaryFolder folder;
    const Mesh mesh = nendo::test::grid(1, 1.0);
    const auto nowhere = write_mesh("/nowhere/m.obj", mesh);
    REQUIRE_FALSE(nowhere);
    CHECK(nowhere.error().code == Errc::failed);
    fs::create_directory(folder.path() / "folder.obj");
    CHECK_FALSE(write_mesh(folder.path() / "folder.obj", mesh));
    fs::create_symlink("/dev/null", folder.path() / "device.obj");
    CHECK_FALSE(write_mesh(folder.path() / "device.obj", mesh));
    const auto ending = write_mesh(folder.path() / "m.off", mesh);
    REQUIRE_FALSE(ending);
    CHECK(ending.error().code == Errc::usage);
  }

  TEST_CASE("a symbolic link stays one and its target is replaced") {
    const TemporaryFolder folder;
    REQUIRE(write_mesh(folder.path() / "real.obj", nendo::test::grid(1, 1.0)));
    fs::create_symlink("real.obj", folder.path() / "link.obj");
    REQUIRE(write_mesh(folder.path() / "link.obj", nendo::test::grid(2, 1.0)));
    CHECK(fs::is_symlink(folder.path() / "link.obj"));
    const auto mesh = read_mesh(folder.path() / "real.obj");
    REQUIRE(mesh);
    CHECK(mesh->vertices.cols() == 9);
  }
}

} // namespace mesh_file_test
