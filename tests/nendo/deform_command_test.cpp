#include <cmath>
#include <random>

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "reference/icosphere.hpp"
#include "support/program.hpp"

namespace deform_command_test {

using namespace nendo;
using deform::Mesh;
using deform::Points;
using nendo::test::is_one_line_about;
using nendo::test::TemporaryFolder;

namespace {

Mesh plane(Eigen::Index side) {
  Mesh mesh;
  mesh.vertices.resize(3, side * side);
  for (Eigen::Index i = 0; i < side * side; ++i) {
    mesh.vertices.col(i) << 50.0 * static_cast<double>(i % side) / static_cast<double>(side - 1),
        50.0 * static_cast<double>(i / side) / static_cast<double>(side - 1), 0.0;
  }
  for (Eigen::Index i = 0; i + side < side * side; ++i) {
    if (i % side == side - 1) continue;
    for (const auto corner : {i, i + 1, i + side + 1, i + side}) {
      mesh.face_corners.push_back(static_cast<std::uint32_t>(corner));
    }
    mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
  }
  return mesh;
}

// The formula, evaluated from its definition: the full saddle-point matrix, solved by LU with full
// pivoting.
double kernel(int smoothness, double t) {
  if (t >= 1.0) return 0.0;
  switch (smoothness) {
  case 0:
    return std::pow(1 - t, 2);
  case 2:
    return std::pow(1 - t, 4) * (4 * t + 1);
  case 4:
    return std::pow(1 - t, 6) * (35 * t * t + 18 * t + 3) / 3;
  default:
    return std::pow(1 - t, 8) * (32 * t * t * t + 25 * t * t + 8 * t + 1);
  }
}

Points reference(const Points& vertices, const Points& starts, const Points& moves, double radius,
                 int smoothness, int terms) {
  const Eigen::Index n = starts.cols();
  const auto basis = [&](const Eigen::Vector3d& x) {
    Eigen::VectorXd q(4);
    q << 1.0, x;
    return q.head(terms).eval();
  };
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n + terms, n + terms);
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(n + terms, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      M(i, j) = kernel(smoothness, (starts.col(i) - starts.col(j)).norm() / radius);
    }
    M.block(i, n, 1, terms) = basis(starts.col(i)).transpose();
    M.block(n, i, terms, 1) = basis(starts.col(i));
    rhs.row(i) = moves.col(i).transpose();
  }
  const Eigen::MatrixXd solution = M.fullPivLu().solve(rhs);
  Points out = vertices;
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
    for (Eigen::Index i = 0; i < n; ++i) {
      out.col(v) += kernel(smoothness, (vertices.col(v) - starts.col(i)).norm() / radius) *
                    solution.row(i).transpose();
    }
    out.col(v) += solution.bottomRows(terms).transpose() * basis(vertices.col(v));
  }
  return out;
}

std::string csv_of(const Points& starts, const Points& moves) {
  std::ostringstream text;
  text.precision(17);
  text << "x,y,z,dx,dy,dz\n";
  for (Eigen::Index i = 0; i < starts.cols(); ++i) {
    for (int k = 0; k < 3; ++k)
      text << starts(k, i) << ',';
    text << moves(0, i) << ',' << moves(1, i) << ',' << moves(2, i) << '\n';
  }
  return text.str();
}

} // namespace

TEST_SUITE("deform") {
  TEST_CASE("deform agrees with an independent evaluation, and keeps vertices and faces in order") {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> u(0.0, 50.0);
    std::normal_distribution<double> push(0.0, 3.0);
    const Mesh mesh = plane(21);
    const double diagonal = deform::diagonal_of(mesh.vertices);
    const TemporaryFolder folder;
    const auto in = folder.path() / "plane.ply";
    REQUIRE(deform::write_mesh(in, mesh));

    int round = 0;
    for (const int smoothness : {0, 2, 4, 6}) {
      for (const auto& [polynomial, terms] :
           {std::pair{"none", 0}, std::pair{"constant", 1}, std::pair{"linear", 4}}) {
        Points starts(3, 10);
        Points moves(3, 10);
        for (Eigen::Index i = 0; i < 10; ++i) {
          starts.col(i) << u(random), u(random), push(random);
          moves.col(i) << push(random), push(random), push(random);
        }
        const auto vectors = folder.path() / "vectors.csv";
        nendo::test::write_file(vectors, csv_of(starts, moves));
        const auto out = folder.path() / (++round % 2 == 0 ? "out.obj" : "out.ply");
        const auto done =
            nendo::test::nendo({"deform", in.string(), "--vectors", vectors.string(), "--radius",
                                "20", "--kernel", "wendland-c" + std::to_string(smoothness),
                                "--polynomial", polynomial, "--out", out.string()});
        CAPTURE(done.err);
        REQUIRE(done.exit_code == 0);
        const auto result = deform::read_mesh(out);
        REQUIRE(result);
        CHECK(result->face_corners == mesh.face_corners);
        CHECK(result->face_starts == mesh.face_starts);
        const Points expected = reference(mesh.vertices, starts, moves, 20.0, smoothness, terms);
        CHECK((result->vertices - expected).cwiseAbs().maxCoeff() < 1e-9 * diagonal);
      }
    }
  }

  TEST_CASE(
      "bad meshes and bad vectors get one clear line and exit code 5, and nothing is written") {
    const TemporaryFolder folder;
    const auto good_mesh = (folder.path() / "good.obj").string();
    const auto good_vectors = (folder.path() / "good.csv").string();
    nendo::test::write_file(good_mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    nendo::test::write_file(good_vectors, "x,y,z,dx,dy,dz\n0,0,0,0,0,1\n");
    const std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex ";
    const std::string vertex =
        "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    struct Case {
      std::string name;
      std::string text;
    };
    for (const Case& c :
         {Case{"empty.obj", ""}, Case{"nan.obj", "v nan 0 0\n"},
          Case{"index.obj", "v 0 0 0\nf 1 2 3\n"}, Case{"cut.ply", ply + "3" + vertex + "0123"},
          Case{"lie.ply", ply + "1000000000" + vertex}, Case{"none.ply", ply + "0" + vertex}}) {
      const auto path = (folder.path() / c.name).string();
      nendo::test::write_file(path, c.text);
      const auto out = folder.path() / "out.obj";
      const auto done = nendo::test::nendo(
          {"deform", path, "--vectors", good_vectors, "--radius", "1", "--out", out.string()});
      CAPTURE(done.err);
      CHECK(done.exit_code == 5);
      CHECK(is_one_line_about(done.err, c.name));
      CHECK_FALSE(std::filesystem::exists(out));
    }
    for (const Case& c :
         {Case{"head.csv", "a,b\n"}, Case{"word.csv", "x,y,z,dx,dy,dz\n0,0,zero,0,0,1\n"},
          Case{"inf.csv", "x,y,z,dx,dy,dz\n0,0,inf,0,0,1\n"},
          Case{"short.csv", "x,y,z,dx,dy,dz\n1,2\n"}}) {
      const auto path = (folder.path() / c.name).string();
      nendo::test::write_file(path, c.text);
      const auto done = nendo::test::nendo({"deform", good_mesh, "--vectors", path, "--radius", "1",
                                            "--out", (folder.path() / "out.obj").string()});
      CAPTURE(done.err);
      CHECK(done.exit_code == 5);
      CHECK(is_one_line_about(done.err, c.name));
    }
    const auto missing =
        nendo::test::nendo({"deform", (folder.path() / "no.obj").string(), "--vectors",
                            good_vectors, "--radius", "1", "--out", "x.obj"});
    CHECK(missing.exit_code == 5);
    CHECK(is_one_line_about(missing.err, "no.obj"));
  }

  TEST_CASE("difficult control vectors give a finite mesh or a clear error, never NaN") {
    const TemporaryFolder folder;
    const auto mesh = (folder.path() / "plane.obj").string();
    REQUIRE(deform::write_mesh(mesh, plane(11)));
    const std::string head = "x,y,z,dx,dy,dz\n";
    const std::string radii = "x,y,z,dx,dy,dz,radius\n";
    for (const std::string& text :
         {head + "9,9,0,0,0,1\n9,9,0,0,0,1\n", head + "9,9,0,0,0,1\n9,9,0,0,5,-1\n",
          head + "9,9,0,0,0,1\n9.0000000001,9,0,0,0,-1\n",
          head + "1,1,0,0,0,1\n2,2,0,0,0,1\n3,3,0,0,0,2\n", head + "9,9,0,0,0,0\n",
          head + "9,9,0,1e150,0,0\n", head + "1e300,9,0,0,0,1\n", head + "9,9,0,0,0,1e30\n",
          radii + "9,9,0,0,0,1,5\n12,9,0,0,0,1,30\n", radii + "9,9,0,0,0,1,5\n9,9,0,0,0,2,30\n"}) {
      for (const std::string polynomial : {"none", "constant", "linear"}) {
        const auto vectors = folder.path() / "vectors.csv";
        const auto out = folder.path() / "out.ply";
        std::filesystem::remove(out);
        nendo::test::write_file(vectors, text);
        const auto done =
            nendo::test::nendo({"deform", mesh, "--vectors", vectors.string(), "--radius", "10",
                                "--polynomial", polynomial, "--out", out.string()});
        CAPTURE(text);
        CAPTURE(done.err);
        if (done.exit_code == 0) {
          const auto result = deform::read_mesh(out); // refuses what is not finite
          REQUIRE(result);
          CHECK(result->vertices.cols() == 121);
        } else {
          CHECK(done.exit_code == 5);
          CHECK(is_one_line_about(done.err, "vectors.csv"));
          CHECK_FALSE(std::filesystem::exists(out));
        }
      }
    }
  }

  TEST_CASE("several radii, as a mix or a control vector each, reach the end points") {
    const TemporaryFolder folder;
    const auto mesh = (folder.path() / "m.obj").string();
    const auto vectors = (folder.path() / "v.csv").string();
    const auto out = folder.path() / "o.obj";
    nendo::test::write_file(mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 0 0\nf 1 2 3\n");
    const auto moved = [&](const std::string& rows, std::vector<std::string> more) {
      nendo::test::write_file(vectors, rows);
      std::vector<std::string> all{"deform", mesh, "--vectors", vectors, "--out", out.string()};
      all.insert(all.end(), more.begin(), more.end());
      const auto done = nendo::test::nendo(all);
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      const auto result = deform::read_mesh(out);
      REQUIRE(result);
      return result->vertices;
    };
    const std::string head = "x,y,z,dx,dy,dz";
    const Points mixed = moved(head + "\n0,0,0,0,0,1\n1,0,0,0,0,2\n", {"--radius", "2+20:0.5"});
    CHECK(mixed(2, 0) == doctest::Approx(1.0));
    CHECK(mixed(2, 1) == doctest::Approx(2.0));
    CHECK(mixed(2, 3) > 0.01); // only the radius of 20 reaches it
    const std::string own = head + ",radius\n0,0,0,0,0,1,2\n1,0,0,0,0,2,2+20:0.5\n";
    const Points apart = moved(own, {});
    CHECK(apart(2, 0) == doctest::Approx(1.0));
    CHECK(apart(2, 1) == doctest::Approx(2.0));
    CHECK(apart(2, 3) > 0.01);
    const Points common = moved(own, {"--common-radius", "3:1000"});
    CHECK(common(2, 1) == doctest::Approx(2.0));
    CHECK(std::abs(common(2, 3)) < 0.01); // all but left to the common radius
  }

  TEST_CASE("thousands of control vectors are no matter") {
    std::mt19937 random(23);
    std::uniform_real_distribution<double> u(0.0, 50.0);
    const Mesh mesh = plane(41);
    const TemporaryFolder folder;
    const auto in = folder.path() / "plane.ply";
    REQUIRE(deform::write_mesh(in, mesh));
    Points starts(3, 5000);
    for (auto start : starts.colwise())
      start << u(random), u(random), 0.0;
    // The mesh's own corner is one of the start points.
    starts.col(4999) = mesh.vertices.col(0);
    const Points moves = Points::Random(3, 5000);
    const auto vectors = folder.path() / "vectors.csv";
    const auto out = folder.path() / "out.ply";
    nendo::test::write_file(vectors, csv_of(starts, moves));
    const auto done = nendo::test::nendo({"deform", in.string(), "--vectors", vectors.string(),
                                          "--radius", "1.5", "--out", out.string()});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto result = deform::read_mesh(out);
    REQUIRE(result);
    CHECK((result->vertices.col(0) - mesh.vertices.col(0) - moves.col(4999)).norm() < 1e-6);
    const auto wide = nendo::test::nendo({"deform", in.string(), "--vectors", vectors.string(),
                                          "--radius", "40", "--out", out.string()});
    CHECK(wide.exit_code == 5);
    CHECK(is_one_line_about(wide.err, "smaller radii or fewer points"));
  }

  TEST_CASE("with --injective a plane that would fold does not, and what it took is reported") {
    const TemporaryFolder folder;
    const Mesh mesh = plane(51);
    const auto in = (folder.path() / "plane.ply").string();
    const auto out = (folder.path() / "out.ply").string();
    const auto vectors = (folder.path() / "vectors.csv").string();
    REQUIRE(deform::write_mesh(in, mesh));
    // Faces of the plane, pushed within it, that turned over.
    const auto turned = [&] {
      const auto result = deform::read_mesh(out);
      REQUIRE(result);
      int count = 0;
      for (std::size_t at = 0; at < result->face_corners.size(); at += 4) {
        const auto corner = [&](std::size_t k) -> Eigen::Vector3d {
          return result->vertices.col(result->face_corners[at + k]);
        };
        const Eigen::Vector3d area = (corner(2) - corner(0)).cross(corner(3) - corner(1));
        if (area.z() <= 0.0) ++count;
      }
      return count;
    };
    const auto run = [&](const std::string& rows, std::vector<std::string> more) {
      nendo::test::write_file(vectors, "x,y,z,dx,dy,dz\n" + rows);
      std::vector<std::string> all{"deform",   in,   "--vectors", vectors,
                                   "--radius", "20", "--out",     out};
      all.insert(all.end(), more.begin(), more.end());
      const auto done = nendo::test::nendo(all);
      CHECK(done.exit_code == 0);
      CHECK(done.err.empty());
      return done.out;
    };
    const std::string push = "25,25,0,18,3,0\n";
    CHECK(run(push, {}).starts_with(out + ": "));
    CHECK(turned() > 10);
    const std::string report = run(push, {"--injective"});
    CHECK(turned() == 0);
    CHECK(report.starts_with("injective: "));
    CHECK(report.find(" links, bound 0.9 (") != std::string::npos);
    CHECK(report.find("min determinant 0.") != std::string::npos);
    CHECK(report.find(", 0 pairs held apart") != std::string::npos);
    const std::string crossing = "20,25,0,9,0,0\n5,5,0,1,1,0\n30,25,0,-9,0,0\n";
    CHECK(run(crossing, {"--injective"}).find("1 pair held apart: 1-3") != std::string::npos);
    CHECK(turned() == 0);

    run("25,25,0,1,0,0\n", {});
    const auto plain = deform::read_mesh(out);
    CHECK(run("25,25,0,1,0,0\n", {"--injective"}).find(" 1 link, ") != std::string::npos);
    CHECK(deform::read_mesh(out)->vertices == plain->vertices);

    nendo::test::write_file(vectors, "x,y,z,dx,dy,dz\n25,25,0,1e30,0,0\n");
    const auto far = nendo::test::nendo(
        {"deform", in, "--vectors", vectors, "--radius", "20", "--injective", "--out", out});
    CHECK(far.exit_code == 5);
    CHECK(is_one_line_about(far.err, "vectors.csv"));
  }

  TEST_CASE("with --keep-volume what is pressed in comes out nearby") {
    const TemporaryFolder folder;
    const Mesh ball = reference::icosphere(5, 1.0);
    const auto in = (folder.path() / "ball.ply").string();
    const auto out = (folder.path() / "out.ply").string();
    const auto vectors = (folder.path() / "vectors.csv").string();
    REQUIRE(deform::write_mesh(in, ball));
    nendo::test::write_file(vectors, "x,y,z,dx,dy,dz\n0,0,1,0,0,-0.6\n");
    const auto volume = [](const Mesh& mesh) {
      double six = 0.0;
      for (std::size_t at = 0; at < mesh.face_corners.size(); at += 3) {
        const auto corner = [&](std::size_t k) -> Eigen::Vector3d {
          return mesh.vertices.col(mesh.face_corners[at + k]);
        };
        six += corner(0).dot(corner(1).cross(corner(2)));
      }
      return six / 6.0;
    };
    const auto run = [&](std::vector<std::string> more) {
      std::vector<std::string> all{"deform",   in,    "--vectors", vectors,
                                   "--radius", "0.6", "--out",     out};
      all.insert(all.end(), more.begin(), more.end());
      return nendo::test::nendo(all);
    };
    const auto change = [&](const std::string& keep) {
      REQUIRE(run({"--keep-volume", keep}).exit_code == 0);
      return std::abs(volume(*deform::read_mesh(out)) / volume(ball) - 1.0);
    };
    const double air = change("0");
    const double half = change("0.5");
    CHECK(air > 5e-3);
    CHECK(half > 2e-3);
    CHECK(half < air);
    CHECK(change("1") < 3e-4);
    for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--keep-volume", "1.5"},
                                                  {"--keep-volume", "nan"},
                                                  {"--keep-volume", "1", "--polynomial", "linear"},
                                                  {"--keep-volume", "0.5", "--injective"}}) {
      const auto done = run(wrong);
      CHECK(done.exit_code == 2);
      CHECK(is_one_line_about(done.err, "--keep-volume"));
    }
  }

  TEST_CASE("what is hardly meant is done, and told in a line") {
    const TemporaryFolder folder;
    const auto in = (folder.path() / "m.obj").string();
    const auto vectors = (folder.path() / "v.csv").string();
    const auto out = (folder.path() / "o.obj").string();
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const std::string lift = "x,y,z,dx,dy,dz\n0,0,0,0,0,1\n";
    const auto shown = [&](const std::string& mesh, const std::string& rows, const char* radius) {
      nendo::test::write_file(in, mesh);
      nendo::test::write_file(vectors, rows);
      const auto done = nendo::test::nendo(
          {"deform", in, "--vectors", vectors, "--radius", radius, "--out", out});
      CHECK(done.exit_code == 0);
      return done.err;
    };
    CHECK(shown(triangle, lift, "0.5").empty());
    CHECK(is_one_line_about(shown("v 0 0 0\nv 1 0 0\n", lift, "0.5"), "no faces"));
    CHECK(is_one_line_about(shown("v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", lift, "0.5"),
                            "in one place"));
    CHECK(is_one_line_about(shown(triangle, lift, "1.5"), "--radius 1.5: reaches all"));
    const std::string far_away = "x,y,z,dx,dy,dz\n9,0,0,0,0,1\n";
    CHECK(is_one_line_about(shown(triangle, far_away, "0.5"), "moves no vertex"));
    const std::string still = "x,y,z,dx,dy,dz\n0,0,0,0,0,0\n";
    CHECK(is_one_line_about(shown(triangle, still, "0.5"), "moves no vertex"));
    const std::string own = "x,y,z,dx,dy,dz,radius\n0,0,0,0,0,1,2\n";
    CHECK(is_one_line_about(shown(triangle, own, "0.5"), vectors + ": reaches all"));
  }

  TEST_CASE("the model itself is written over only with --force, by whatever name") {
    const TemporaryFolder folder;
    const auto in = (folder.path() / "m.obj").string();
    const auto vectors = (folder.path() / "v.csv").string();
    const auto same = (folder.path() / "same.obj").string();
    const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
    nendo::test::write_file(in, text);
    nendo::test::write_file(vectors, "x,y,z,dx,dy,dz\n0,0,0,0,0,1\n");
    std::filesystem::create_symlink("m.obj", same);
    for (const std::string& out : {in, same}) {
      const auto done =
          nendo::test::nendo({"deform", in, "--vectors", vectors, "--radius", "0.5", "--out", out});
      CHECK(done.exit_code == 2);
      CHECK(is_one_line_about(done.err, "--force"));
      CHECK(nendo::test::contents(in) == text);
    }
    const auto forced = nendo::test::nendo(
        {"deform", in, "--vectors", vectors, "--radius", "0.5", "--out", same, "--force"});
    CHECK(forced.exit_code == 0);
    CHECK(std::filesystem::is_symlink(same));
    CHECK(nendo::test::contents(in).find("v 0 0 1") != std::string::npos);
  }

  TEST_CASE("wrong options are wrong usage") {
    const TemporaryFolder folder;
    const auto mesh = (folder.path() / "m.obj").string();
    const auto vectors = (folder.path() / "v.csv").string();
    nendo::test::write_file(mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    nendo::test::write_file(vectors, "x,y,z,dx,dy,dz\n0,0,0,0,0,1\n");
    const auto with = [&](std::vector<std::string> more) {
      std::vector<std::string> all{"deform", mesh, "--vectors", vectors};
      all.insert(all.end(), more.begin(), more.end());
      return nendo::test::nendo(all);
    };
    const auto out = (folder.path() / "o.obj").string();
    CHECK(is_one_line_about(with({"--out", out}).err, "--radius"));
    CHECK(with({"--out", out}).exit_code == 2);
    CHECK(with({"--out", out, "--radius", "0"}).exit_code == 2);
    CHECK(with({"--out", out, "--radius", "-3"}).exit_code == 2);
    CHECK(with({"--out", out, "--radius", "nan"}).exit_code == 2);
    CHECK(with({"--out", out, "--radius", "ten"}).exit_code == 2);
    CHECK(is_one_line_about(with({"--out", out, "--radius", "1+"}).err, "--radius 1+"));
    CHECK(with({"--out", out, "--radius", "1", "--common-radius", "2"}).exit_code == 2);
    CHECK(with({"--out", out, "--radius", "1", "--common-radius", "1+2"}).exit_code == 2);
    CHECK(with({"--out", out, "--radius", "1", "--kernel", "gauss"}).exit_code == 2);
    CHECK(with({"--out", out, "--radius", "1", "--polynomial", "cubic"}).exit_code == 2);
    CHECK(with({"--out", (folder.path() / "o.fbx").string(), "--radius", "1"}).exit_code == 2);
    CHECK(with({"--out", "/no/such/folder/o.obj", "--radius", "1"}).exit_code == 1);
    CHECK(with({"--out", out, "--radius", "1"}).exit_code == 0);
  }
}

} // namespace deform_command_test
