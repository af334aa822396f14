#include <nendo/deform/join.hpp>

#include <cmath>
#include <map>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "join/mesh_surface.hpp"
#include "join/overlay.hpp"
#include "join/self_intersections.hpp"
#include "support/nasty_meshes.hpp"
#include "support/placed_meshes.hpp"
#include "support/test_meshes.hpp"

namespace join_test {

using namespace nendo;
using namespace nendo::deform;
using nendo::test::moved;
using nendo::test::normalised;
using nendo::test::turned;

Mesh model(const char* name) {
  auto mesh = read_mesh(std::filesystem::path(NENDO_MODELS) / name);
  REQUIRE(mesh);
  return *mesh;
}

std::vector<std::pair<std::string, Mesh>> shapes() {
  std::vector<std::pair<std::string, Mesh>> all{{"ball", nendo::test::sphere(16, 24, 1.0)},
                                                {"torus", nendo::test::torus(30, 15)},
                                                {"cube", nendo::test::cube_of_cells(5)},
                                                {"comb", nendo::test::comb(7)},
                                                {"moai", model("moai.obj")}};
  for (auto& [name, mesh] : all)
    mesh = normalised(mesh);
  return all;
}

bool cuts_itself(const Mesh& mesh) {
  const Mesh* const one = &mesh;
  const TriangleSurface surface = surfaces_of({&one, 1}).surfaces[0];
  return !self_intersections(surface.points, surface.faces, 1).empty();
}

Result<Joined> join_two(const Mesh& a, const Mesh& b, double seam = 0.0) {
  const JoinPart parts[] = {{&a, "a"}, {&b, "b"}};
  return join(parts, {.seam_width = seam});
}

/// Both choices are closed and cut nothing, and their volumes are those of both.
void check_overlay(const Mesh& a, const Mesh& b) {
  const Mesh* const both[] = {&a, &b};
  const SharedSurfaces shared = surfaces_of(both);
  const auto laid = overlay(shared.surfaces[0], shared.surfaces[1]);
  REQUIRE(laid);
  double volume = 0.0;
  for (const Choice choice : {Choice::union_of_both, Choice::intersection}) {
    const Mesh chosen =
        mesh_of(choose(shared.surfaces[0], shared.surfaces[1], *laid, choice).surface, shared.look);
    if (chosen.face_count() > 0) CHECK(check_closed_manifold(chosen));
    CHECK_FALSE(cuts_itself(chosen));
    volume += volume_of(chosen);
  }
  const double expected = volume_of(a) + volume_of(b);
  CHECK(std::abs(volume - expected) <= 1e-11 * expected);
}

/// Of a join that must succeed or say that the parts do not touch.
void check_join(const Mesh& a, const Mesh& b, double seam) {
  const auto joined = join_two(a, b, seam);
  if (!joined) {
    CHECK(joined.error().message.find("do not touch") != std::string::npos);
    return;
  }
  CHECK(check_closed_manifold(joined->mesh));
  CHECK_FALSE(cuts_itself(joined->mesh));
  const JoinStep& step = joined->steps.at(0);
  CHECK(volume_of(joined->mesh) == doctest::Approx(step.volume).epsilon(1e-11));
  CHECK(std::abs(step.volume - step.sharp_volume) <= step.volume_bound + 1e-12 * step.volume);
}

struct PlaceLess {
  bool operator()(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    return std::tuple(a.x(), a.y(), a.z()) < std::tuple(b.x(), b.y(), b.z());
  }
};

TEST_SUITE("join") {
  TEST_CASE("turned at random, all pairs: closed, nothing cut, and volumes add up") {
    std::mt19937 random(37);
    std::uniform_real_distribution<double> way(-0.8, 0.8);
    for (const auto& [first_name, a] : shapes())
      for (const auto& [second_name, b] : shapes()) {
        const std::string first(first_name),
            second(second_name); // no bindings in what CAPTURE makes
        CAPTURE(first);
        CAPTURE(second);
        const double x = way(random);
        const double y = way(random);
        const Mesh other = moved(turned(b, random), {x, y, way(random)});
        check_overlay(a, other);
        check_join(a, other, 0.0);
        if (first == second || first == "moai") check_join(a, other, 0.08);
      }
  }

  TEST_CASE("copies moved by an edge, a cell or nothing: faces in one plane, edge on edge") {
    for (const auto& [of, a] : shapes()) {
      const std::string name(of);
      CAPTURE(name);
      const std::uint32_t* corner = a.face_corners.data();
      const double edge = (a.vertices.col(corner[0]) - a.vertices.col(corner[1])).norm();
      for (int step = 0; step < 4; ++step) {
        Eigen::Vector3d way = Eigen::Vector3d::Zero();
        way[step % 3] = edge * step;
        if (step % 2 == 1) way[(step + 1) % 3] = 0.5 * edge;
        const Mesh other = moved(a, way);
        check_overlay(a, other);
        check_join(a, other, 0.0);
      }
    }
  }

  TEST_CASE("nested, apart and touching boxes") {
    const Mesh box = nendo::test::cube_of_cells(1);
    Mesh small = box;
    small.vertices = (0.25 * small.vertices).colwise() + Eigen::Vector3d(0.3, 0.3, 0.3);
    check_overlay(box, small);
    const auto nested = join_two(box, small);
    REQUIRE(nested);
    CHECK(nested->steps[0].swallowed);
    CHECK(nested->mesh.vertices == box.vertices);
    check_overlay(box, moved(box, {3, 0, 0}));
    const auto apart = join_two(box, moved(box, {3, 0, 0}));
    REQUIRE_FALSE(apart);
    CHECK(apart.error().code == Errc::failed);
    CHECK(apart.error().message ==
          "a and b: they do not touch; move them into each other a little");
    // A face on a face: it depends on the way the second one gives whether they touch.
    check_overlay(box, moved(box, {1, 0, 0}));
    check_join(box, moved(box, {1, 0, 0}), 0.0);
    check_join(box, moved(box, {0.5, 0, 0}), 0.0);
  }

  TEST_CASE("vertices off the seam keep their bits and their order") {
    const Mesh a = normalised(model("moai.obj"));
    const Mesh b = moved(normalised(nendo::test::sphere(24, 40, 1.0)), {0.4, 0.3, 0.2});
    std::map<Eigen::Vector3d, std::size_t, PlaceLess> numbers;
    for (Eigen::Index at = 0; at < a.vertices.cols(); ++at)
      numbers.emplace(a.vertices.col(at), numbers.size());
    for (Eigen::Index at = 0; at < b.vertices.cols(); ++at)
      numbers.emplace(b.vertices.col(at), numbers.size());
    for (const double seam : {0.0, 0.05}) {
      const auto joined = join_two(a, b, seam);
      REQUIRE(joined);
      std::size_t kept = 0;
      std::size_t last = 0;
      for (Eigen::Index at = 0; at < joined->mesh.vertices.cols(); ++at) {
        const auto found = numbers.find(joined->mesh.vertices.col(at));
        if (found == numbers.end()) continue;
        ++kept;
        CHECK(found->second >= last);
        last = found->second;
      }
      CAPTURE(seam);
      CHECK(kept > static_cast<std::size_t>(a.vertices.cols()) / 2);
    }
  }

  TEST_CASE("the same parts make the same bits") {
    const Mesh a = normalised(nendo::test::torus(24, 12));
    const Mesh b = moved(normalised(nendo::test::sphere(16, 24, 1.0)), {0.3, 0.2, 0.1});
    const auto one = join_two(a, b, 0.05);
    const auto other = join_two(a, b, 0.05);
    REQUIRE(one);
    REQUIRE(other);
    CHECK(one->mesh.vertices == other->mesh.vertices);
    CHECK(one->mesh.face_corners == other->mesh.face_corners);
  }

  TEST_CASE("a wider seam is smoother: the sharpest edge opens") {
    const Mesh a = normalised(nendo::test::sphere(40, 60, 1.0));
    const Mesh b = moved(a, {1.0, 0, 0});
    double last = -1.0;
    for (const double seam : {0.0, 0.1, 0.25}) {
      const auto joined = join_two(a, b, seam);
      REQUIRE(joined);
      CHECK(joined->steps[0].seam_width == seam);
      // Normals of faces within a tenth of the plane of the seam, two at each edge.
      std::map<std::pair<std::uint32_t, std::uint32_t>, Eigen::Vector3d> normals;
      double least = 1.0;
      const Mesh& mesh = joined->mesh;
      for (std::size_t face = 0; face < mesh.face_count(); ++face) {
        const std::uint32_t* corner = &mesh.face_corners[3 * face];
        const Eigen::Vector3d p = mesh.vertices.col(corner[0]);
        const Eigen::Vector3d normal =
            (mesh.vertices.col(corner[1]) - p).cross(mesh.vertices.col(corner[2]) - p).normalized();
        for (std::size_t k = 0; k < 3; ++k) {
          const auto edge = std::minmax(corner[k], corner[(k + 1) % 3]);
          const auto [found, is_new] = normals.try_emplace(edge, normal);
          if (!is_new) least = std::min(least, found->second.dot(normal));
        }
      }
      CHECK(least > last);
      last = least;
    }
    CHECK(last > 0.9);
  }

  TEST_CASE("materials, names, colours and texture go along") {
    Mesh a = nendo::test::cube_of_cells(2);
    Mesh b = moved(nendo::test::cube_of_cells(2), {0.65, 0.2, 0.15});
    a.look.materials = {{"clay", Eigen::Vector4f(1, 0, 0, 1)}};
    b.look.materials = {{"unused", Eigen::Vector4f(0, 0, 0, 1)},
                        {"clay", Eigen::Vector4f(0, 1, 0, 1)}};
    a.look.face_materials.assign(a.face_count(), 0);
    b.look.face_materials.assign(b.face_count(), 1);
    b.look.groups.names = {"arm"};
    b.look.groups.of_face.assign(b.face_count(), 0);
    a.look.vertex_colours = Eigen::Matrix4Xf::Ones(4, a.vertices.cols());
    a.look.vertex_colours.row(0) = a.vertices.row(0).cast<float>();
    // Each vertex of a is at its x and y in the texture, so each point of its faces is.
    a.texcoords = a.vertices.topRows(2);
    a.corner_texcoords = a.face_corners;
    for (const double seam : {0.0, 0.1}) {
      const auto joined = join_two(a, b, seam);
      REQUIRE(joined);
      const Mesh& mesh = joined->mesh;
      REQUIRE(mesh.look.materials.size() == 2);
      CHECK(mesh.look.materials[0].name == "clay");
      CHECK(mesh.look.materials[1].name == "clay-2");
      CHECK(mesh.look.groups.names == std::vector<std::string>{"arm"});
      REQUIRE(mesh.look.face_materials.size() == mesh.face_count());
      REQUIRE(mesh.corner_texcoords.size() == mesh.face_corners.size());
      REQUIRE(mesh.look.vertex_colours.cols() == mesh.vertices.cols());
      for (std::size_t face = 0; face < mesh.face_count(); ++face) {
        const bool is_a = mesh.look.face_materials[face] == 0;
        CHECK((mesh.look.groups.of_face[face] == no_index) == is_a);
        for (std::size_t at = 3 * face; at < 3 * face + 3; ++at) {
          const Eigen::Vector2d texture = mesh.texcoords.col(mesh.corner_texcoords[at]);
          if (!is_a) CHECK(texture.isZero());
          if (is_a && seam == 0.0)
            CHECK((texture - mesh.vertices.col(mesh.face_corners[at]).head<2>()).norm() < 1e-6);
        }
      }
    }
  }

  TEST_CASE("what cannot be joined is refused with a reason") {
    const Mesh box = nendo::test::cube_of_cells(2);
    const auto message = [&](const Mesh& bad, Errc code) {
      const auto joined = join_two(box, bad);
      REQUIRE_FALSE(joined);
      CHECK(joined.error().code == code);
      CHECK(joined.error().message.find('\n') == std::string::npos);
      return joined.error().message;
    };
    Mesh open = box;
    open.face_starts.pop_back();
    open.face_corners.resize(open.face_starts.back());
    CHECK(message(open, Errc::bad_input).find("b: is open at") == 0);
    Mesh inwards = box;
    for (std::size_t face = 0; face < inwards.face_count(); ++face)
      std::swap(inwards.face_corners[3 * face], inwards.face_corners[3 * face + 1]);
    CHECK(message(inwards, Errc::bad_input) ==
          "b: faces inwards; `nendo repair IN --out OUT` turns it outwards");
    Mesh odd = box;
    odd.vertices(0, 3) = std::nan("");
    CHECK(message(odd, Errc::bad_input) == "b: has a coordinate that is not finite");
    Mesh huge = box;
    huge.vertices *= 1e80;
    CHECK(message(huge, Errc::bad_input).find("scale it down") != std::string::npos);
    Mesh tiny = box;
    tiny.vertices *= 1e-80;
    CHECK(message(tiny, Errc::bad_input).find("scale it up") != std::string::npos);
    const JoinPart alone[] = {{&box, "a"}};
    CHECK_FALSE(join(alone, {}));
    CHECK_FALSE(join_two(box, moved(box, {1, 0.1, 0.2}), -1.0));
    CHECK_FALSE(join_two(box, moved(box, {1, 0.1, 0.2}), std::nan("")));
  }

  TEST_CASE("joined and then cut apart, there are as many parts as before") {
    const Mesh ball = nendo::test::sphere(16, 24, 1.0);
    const Mesh second = moved(ball, {1.5, 0.1, 0.05});
    const Mesh third = moved(ball, {3.0, -0.1, 0.1});
    const JoinPart balls[] = {{&ball, "a"}, {&second, "b"}, {&third, "c"}};
    for (const double seam : {0.0, 0.15}) {
      const auto joined = join(balls, {.seam_width = seam});
      REQUIRE(joined);
      std::vector<Mesh> parts{joined->mesh};
      for (const double x : {0.75, 2.25}) {
        const auto cut = cut_model(parts.back(), CutPlane{{x, 0, 0}, {-1, 0.02, 0.01}});
        REQUIRE(cut);
        REQUIRE(cut->parts == 2);
        const std::vector<Mesh> pieces = separate(*cut);
        const bool first_is_left = pieces[0].vertices.row(0).minCoeff() < x - 0.5;
        parts.back() = pieces[first_is_left ? 0 : 1];
        parts.push_back(pieces[first_is_left ? 1 : 0]);
      }
      CHECK(parts.size() == 3);
      double sum = 0.0;
      for (const Mesh& part : parts)
        sum += volume_of(part);
      CHECK(sum == doctest::Approx(volume_of(joined->mesh)).epsilon(1e-11));
    }
  }

  TEST_CASE("a model that was cut in two and is pressed together again is whole") {
    const Mesh whole = normalised(model("moai.obj"));
    const auto cut = cut_model(whole, CutPlane{{0, 0.4, 0}, {0.1, 1, 0.2}});
    REQUIRE(cut);
    std::vector<Mesh> parts = separate(*cut);
    REQUIRE(parts.size() == 2);
    const bool first_is_upper = volume_of(parts[0]) < volume_of(parts[1]);
    Mesh& upper = parts[first_is_upper ? 0 : 1];
    upper = moved(upper, {0, -0.01, 0});
    for (const double seam : {0.0, 0.02}) {
      const auto joined = join_two(parts[first_is_upper ? 1 : 0], upper, seam);
      REQUIRE(joined);
      CHECK(check_closed_manifold(joined->mesh));
      CHECK_FALSE(cuts_itself(joined->mesh));
      CHECK(volume_of(joined->mesh) < volume_of(whole));
      CHECK(volume_of(joined->mesh) > 0.97 * volume_of(whole));
    }
  }

  TEST_CASE("three parts in a row, far from the origin and of very different sizes") {
    const Mesh box = nendo::test::cube_of_cells(2);
    Mesh bead = nendo::test::sphere(10, 16, 0.01);
    const Eigen::Vector3d far(1e5, -1e5, 1e5);
    const Mesh a = moved(box, far);
    const Mesh b = moved(box, far + Eigen::Vector3d(0.95, 0.15, 0.1));
    const Mesh c = moved(bead, far + Eigen::Vector3d(0.31, 0.27, 1.0));
    const JoinPart parts[] = {{&a, "a"}, {&b, "b"}, {&c, "c"}};
    const auto joined = join(parts, {});
    REQUIRE(joined);
    CHECK(joined->steps.size() == 2);
    CHECK(check_closed_manifold(joined->mesh));
    CHECK_FALSE(cuts_itself(joined->mesh));
    const double overlap = 0.05 * 0.85 * 0.9;
    CHECK(joined->steps[0].volume == doctest::Approx(2.0 - overlap).epsilon(1e-5));
    CHECK(joined->steps[1].volume > joined->steps[0].volume);
  }
}

} // namespace join_test
