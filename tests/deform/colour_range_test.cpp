// Which number stands for full in the colours of a file.

#include <cmath>
#include <span>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

namespace colour_range_test {

using namespace nendo::deform;

/// The model, and what is noted about its colours.
static ReadModel parse(const std::string& text) {
  auto model = parse_model(std::as_bytes(std::span(text)), "model");
  REQUIRE_MESSAGE(model, model.error().message);
  std::erase_if(model->notes,
                [](const std::string& note) { return note.find("colour") == note.npos; });
  return *std::move(model);
}

/// sRGB's curve (IEC 61966-2-1), written down here once more.
static double linear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

static void check_colour(const Mesh& mesh, Eigen::Index vertex, double r, double g, double b) {
  REQUIRE(mesh.look.vertex_colours.cols() == mesh.vertices.cols());
  const Eigen::Vector4f is = mesh.look.vertex_colours.col(vertex);
  CHECK(static_cast<double>(is[0]) == doctest::Approx(linear(r)));
  CHECK(static_cast<double>(is[1]) == doctest::Approx(linear(g)));
  CHECK(static_cast<double>(is[2]) == doctest::Approx(linear(b)));
}

static std::string obj_of(const std::string& one, const std::string& two,
                          const std::string& three) {
  return "v 0 0 0 " + one + "\nv 1 0 0 " + two + "\nv 0 1 0 " + three + "\nf 1 2 3\n";
}

static std::string ply_of(const std::string& type, const std::string& one, const std::string& two,
                          const std::string& three) {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nproperty " +
         type + " red\nproperty " + type + " green\nproperty " + type +
         " blue\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 " + one +
         "\n1 0 0 " + two + "\n0 1 0 " + three + "\n3 0 1 2\n";
}

TEST_CASE("deform/colour_range/colours of an OBJ from 0 to 1 are as they are written") {
  const ReadModel model = parse(obj_of("0 0.5 1", "1 1 1", "0.25 0 0"));
  check_colour(model.mesh, 0, 0.0, 0.5, 1.0);
  check_colour(model.mesh, 2, 0.25, 0.0, 0.0);
  CHECK(model.notes.empty());
}

TEST_CASE("deform/colour_range/one number above 1 means that an OBJ's colours are bytes") {
  const ReadModel model = parse(obj_of("0 128 1", "1 0 0", "255 51 102"));
  check_colour(model.mesh, 0, 0.0, 128.0 / 255.0, 1.0 / 255.0);
  check_colour(model.mesh, 1, 1.0 / 255.0, 0.0, 0.0);
  check_colour(model.mesh, 2, 1.0, 0.2, 0.4);
  REQUIRE(model.notes.size() == 1);
  CHECK(model.notes[0] == "colours above 1 were found, so colours are read as 0 to 255");
  // Of fractions, and of dark ones.
  check_colour(parse(obj_of("0 0 0", "1 2 0", "0 0 3")).mesh, 1, 1.0 / 255.0, 2.0 / 255.0, 0.0);
  check_colour(parse(obj_of("127.5 0 0", "0 0 0", "0 0 0.5")).mesh, 0, 0.5, 0.0, 0.0);
}

TEST_CASE("deform/colour_range/colours that a filter has sharpened beyond 1 are full") {
  const ReadModel model = parse(obj_of("0.5 1.02 0", "0 0 0", "0.25 -0.01 1"));
  check_colour(model.mesh, 0, 0.5, 1.0, 0.0);
  check_colour(model.mesh, 2, 0.25, 0.0, 1.0);
  REQUIRE(model.notes.size() == 1);
  CHECK(model.notes[0] == "some colours are above 1; they are taken as 1");
}

TEST_CASE("deform/colour_range/vertices of an OBJ without a colour are white in each range") {
  const ReadModel model = parse(obj_of("255 0 0", "", "0 0 51"));
  check_colour(model.mesh, 0, 1.0, 0.0, 0.0);
  check_colour(model.mesh, 1, 1.0, 1.0, 1.0);
  check_colour(model.mesh, 2, 0.0, 0.0, 0.2);
}

TEST_CASE("deform/colour_range/floats of a PLY are from 0 to 1 or from 0 to 255") {
  const ReadModel parts = parse(ply_of("float", "0 0.5 1", "1 1 1", "0.25 0 0"));
  check_colour(parts.mesh, 0, 0.0, 0.5, 1.0);
  CHECK(parts.notes.empty());
  const ReadModel bytes = parse(ply_of("float", "0 127.5 255", "1 1 1", "51 0 0"));
  check_colour(bytes.mesh, 0, 0.0, 0.5, 1.0);
  check_colour(bytes.mesh, 1, 1.0 / 255.0, 1.0 / 255.0, 1.0 / 255.0);
  CHECK(bytes.notes.size() == 1);
}

TEST_CASE("deform/colour_range/integers of a PLY go to the greatest of their kind") {
  for (const char* const type : {"uchar", "int", "ushort"}) {
    CAPTURE(type);
    const ReadModel model = parse(ply_of(type, "0 51 255", "1 1 1", "102 0 0"));
    check_colour(model.mesh, 0, 0.0, 0.2, 1.0);
    check_colour(model.mesh, 1, 1.0 / 255.0, 1.0 / 255.0, 1.0 / 255.0);
    CHECK(model.notes.empty() == (std::string(type) != "ushort"));
  }
  const ReadModel words = parse(ply_of("ushort", "0 13107 65535", "0 0 0", "257 0 0"));
  check_colour(words.mesh, 0, 0.0, 0.2, 1.0);
  check_colour(words.mesh, 2, 257.0 / 65535.0, 0.0, 0.0);
  CHECK(words.notes.empty());
  // One byte of full is full, also where all else is black.
  check_colour(parse(ply_of("uchar", "1 0 0", "0 0 0", "0 0 0")).mesh, 0, 1.0 / 255.0, 0.0, 0.0);
}

TEST_CASE("deform/colour_range/senseless colours do no harm") {
  const ReadModel model = parse(ply_of("double", "nan 0.5 1e300", "-1 0 0", "inf 0 0"));
  for (const float part : model.mesh.look.vertex_colours.reshaped()) {
    CHECK(part >= 0.0F);
    CHECK(part <= 1.0F);
  }
}

} // namespace colour_range_test
