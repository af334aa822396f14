#include <nendo/deform/control_vectors.hpp>

#include <string>

#include <doctest/doctest.h>

namespace control_vectors_test {

using nendo::Errc;
using nendo::deform::parse_control_vectors;
using nendo::deform::read_control_vectors;

TEST_SUITE("control_vectors") {
  const std::string header = "x,y,z,dx,dy,dz\n";

  TEST_CASE("rows become starts, displacements and radii") {
    const auto vectors = parse_control_vectors("# two fingers\n\n x, y ,z,dx,dy,dz,radius\r\n"
                                               "1,2,3,4,5,6,7\r\n  # the other\n"
                                               "-1,+2.5,3e1 , .5,0,-0,0.25",
                                               "t.csv");
    REQUIRE(vectors);
    CHECK(vectors->starts.cols() == 2);
    CHECK(vectors->starts.col(0) == Eigen::Vector3d(1, 2, 3));
    CHECK(vectors->displacements.col(0) == Eigen::Vector3d(4, 5, 6));
    CHECK(vectors->starts.col(1) == Eigen::Vector3d(-1, 2.5, 30));
    CHECK(vectors->displacements.col(1) == Eigen::Vector3d(0.5, 0, 0));
    using nendo::deform::OwnSupport;
    CHECK(vectors->own == std::vector<OwnSupport>{{0, {7.0, 1.0}}, {1, {0.25, 1.0}}});
    const auto mixed = parse_control_vectors(
        "x,y,z,dx,dy,dz,radius\n1,2,3,4,5,6,7+20:0.5\n1,2,3,4,5,6, 9:2\n", "t.csv");
    REQUIRE(mixed);
    CHECK(mixed->own ==
          std::vector<OwnSupport>{{0, {7.0, 1.0}}, {0, {20.0, 0.5}}, {1, {9.0, 2.0}}});
  }

  TEST_CASE("spreadsheets' byte-order marks and any line ends are taken") {
    for (const std::string line_end : {"\n", "\r\n", "\r"}) {
      for (const std::string mark : {"", "\xEF\xBB\xBF"}) {
        const auto vectors = parse_control_vectors(
            mark + "x,y,z,dx,dy,dz" + line_end + "1,2,3,4,5,6" + line_end + "7,8,9,0,0,1", "t.csv");
        REQUIRE_MESSAGE(vectors, vectors.error().message);
        REQUIRE(vectors->starts.cols() == 2);
        CHECK(vectors->starts.col(1) == Eigen::Vector3d(7, 8, 9));
      }
    }
  }

  TEST_CASE("semicolons, decimal commas, any order, other columns") {
    for (const std::string text : {"x;y;z;dx;dy;dz;radius\n0,5;1;0;0;0,2;0;1,5\n",
                                   "x\ty\tz\tdx\tdy\tdz\tradius\n.5\t1\t0\t0\t.2\t0\t1.5",
                                   "# x y z dx dy dz radius\n0.5 1 0 0 0.2 0 1.5\n",
                                   "DZ,DY,DX,Z,Y,X,Radius\n0,0.2,0,0,1,0.5,1.5\n"}) {
      CAPTURE(text);
      const auto vectors = parse_control_vectors(text, "t.csv");
      REQUIRE_MESSAGE(vectors, vectors.error().message);
      CHECK(vectors->starts.col(0) == Eigen::Vector3d(0.5, 1, 0));
      CHECK(vectors->displacements.col(0) == Eigen::Vector3d(0, 0.2, 0));
      CHECK(vectors->own == std::vector<nendo::deform::OwnSupport>{{0, {1.5, 1.0}}});
      CHECK(vectors->columns_not_read.empty());
    }
    const auto more =
        parse_control_vectors("name,x,y,z,dx,dy,dz,weight\na,1,2,3,4,5,6,\n", "t.csv");
    REQUIRE(more);
    CHECK(more->columns_not_read == "name, weight");
  }

  TEST_CASE("without a radius column there are no radii") {
    const auto vectors = parse_control_vectors(header + "1,2,3,4,5,6\n", "t.csv");
    REQUIRE(vectors);
    CHECK(vectors->own.empty());
  }

  TEST_CASE("what is wrong is named with its line and column") {
    struct Case {
      std::string text;
      const char* place;
    };
    const std::string with_radius = "x,y,z,dx,dy,dz,radius\n";
    const Case cases[] = {
        {"", "t.csv: is empty"},
        {header, "t.csv: has no"},
        {"1,2,3,4,5,6\n", "t.csv:1: has numbers where the names"},
        {"x,y,z,dx,dy\n", "t.csv:1: there is no column dz"},
        {"x,y,z,dx,dy,dz,X\n", "t.csv:1: there are two columns x"},
        {header + "1,2,3,4,5\n", "t.csv:2: has 5 cells"},
        {header + "\n1,2,3,4,5,6,7\n", "t.csv:3: has 7 cells"},
        {header + "1,2,three,4,5,6\n", "t.csv:2: column 3 (z): 'three'"},
        {header + "1,2,3,nan,5,6\n", "t.csv:2: column 4 (dx): 'nan'"},
        {header + "1,2,3,4,-inf,6\n", "t.csv:2: column 5 (dy): '-inf'"},
        {header + "1,2,3,4,5,1e101\n", "t.csv:2: column 6 (dz): '1e101'"},
        {header + "1,,3,4,5,6\n", "t.csv:2: column 2 (y): ''"},
        {header + "1,2 3,3,4,5,6\n", "t.csv:2: column 2 (y): '2 3'"},
        {header + "+-1,2,3,4,5,6\n", "t.csv:2: column 1 (x): '+-1'"},
        {header + "1\x01\x7f" + std::string(99, 'a') + ",2,3,4,5,6\n", "(x): '1??aaa"},
        {with_radius + "1,2,3,4,5,6,0\n", "t.csv:2: column 7 (radius)"},
        {with_radius + "1,2,3,4,5,6,-1\n", "t.csv:2: column 7 (radius)"},
        {with_radius + "1,2,3,4,5,6,7+\n", "t.csv:2: column 7 (radius): '7+'"},
        {with_radius + "1,2,3,4,5,6,7:0\n", "t.csv:2: column 7 (radius): '7:0'"},
    };
    for (const Case& one : cases) {
      CAPTURE(one.text);
      const auto vectors = parse_control_vectors(one.text, "t.csv");
      REQUIRE_FALSE(vectors);
      CHECK(vectors.error().code == Errc::bad_input);
      CHECK_MESSAGE(vectors.error().message.find(one.place) != std::string::npos,
                    vectors.error().message);
      CHECK(vectors.error().message.find('\n') == std::string::npos);
      CHECK(vectors.error().message.size() < 200);
    }
  }

  TEST_CASE("tens of thousands of control vectors are taken, more than a million are refused") {
    std::string text = header;
    for (int row = 0; row < 20'000; ++row)
      text += "1,2,3,4,5,6\n";
    const auto many = parse_control_vectors(text, "t.csv");
    REQUIRE(many);
    CHECK(many->starts.cols() == 20'000);
    for (int row = 20'000; row < 1'000'001; ++row)
      text += "1,2,3,4,5,6\n";
    const auto more = parse_control_vectors(text, "t.csv");
    REQUIRE_FALSE(more);
    CHECK(more.error().message == "t.csv:1000002: more than 1000000 control vectors");
  }

  TEST_CASE("a file that is not there is bad input") {
    const auto vectors = read_control_vectors("/nowhere/at/all.csv");
    REQUIRE_FALSE(vectors);
    CHECK(vectors.error().code == Errc::bad_input);
    CHECK(vectors.error().message.starts_with("/nowhere/at/all.csv: cannot be opened"));
  }
}

} // namespace control_vectors_test
