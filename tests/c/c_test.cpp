// The C interface against the libraries below it, and its errors.

#include <cmath>
#include <cstring>
#include <limits>
#include <thread>

#include <doctest/doctest.h>
#include <nendo.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/type1.hpp>

#include "support/eventually.hpp"
#include "support/temporary_folder.hpp"

namespace c_test {

using namespace nendo;
using test::eventually;

namespace {

/// Ends the loop with the test.
struct Loop {
  ~Loop() { nendo_loop_end(loop); }
  nendo_loop* loop = nullptr;
};

nendo_loop_options simulated() {
  nendo_loop_options options{};
  options.left = "sim:grasp";
  options.right = "sim:pinch";
  return options;
}

void check_refused(int status, int expected, const std::string& words) {
  CHECK(status == expected);
  const std::string message = nendo_message();
  CHECK_MESSAGE(message.find(words) != std::string::npos, message);
  CHECK(message.find('\n') == std::string::npos);
}

std::vector<double> vertices_of(nendo_loop* loop) {
  std::vector<double> vertices(3 * nendo_loop_vertex_count(loop));
  nendo_loop_vertices(loop, vertices.data());
  return vertices;
}

} // namespace

TEST_SUITE("c") {
  TEST_CASE("a deformer moves vertices as Type1Deformer does, bit for bit, also after a commit") {
    const deform::Points vertices = deform::Points::Random(3, 500);
    const deform::Points starts = deform::Points::Random(3, 7);
    const deform::Points ends = starts + 0.1 * deform::Points::Random(3, 7);
    const deform::Points later = ends + 0.1 * deform::Points::Random(3, 7);
    deform::DeformerOptions options;
    options.supports = deform::one_radius(0.4);
    options.csrbf.kernel = deform::Wendland::c4;
    deform::Type1Deformer own(vertices, 7, options);
    deform::BlockShape shape;
    deform::Points expected;
    nendo_deformer* deformer = nullptr;
    REQUIRE(nendo_deformer_make(vertices.data(), 500, 7, 0.4, "wendland-c4", &deformer) ==
            NENDO_OK);
    deform::Points moved(3, 500);
    REQUIRE(is_solved(own.grab(starts)));
    REQUIRE(nendo_deformer_grab(deformer, starts.data()) == NENDO_OK);
    for (const auto* to : {&ends, &later}) {
      REQUIRE(is_solved(own.apply(*to, shape)));
      own.layout().unpack(shape, expected);
      CHECK(nendo_deformer_move(deformer, to->data(), moved.data()) == NENDO_OK);
      CHECK(moved == expected);
      REQUIRE(is_solved(own.commit(*to)));
      CHECK(nendo_deformer_commit(deformer, to->data()) == NENDO_OK);
    }
    nendo_deformer_free(deformer);
  }

  TEST_CASE("wrong arguments of a deformer are errors that name them") {
    const double inf = std::numeric_limits<double>::infinity();
    const std::vector<double> vertices(30, 0.5);
    std::vector<double> wrong = vertices;
    wrong[29] = inf;
    nendo_deformer* made = nullptr;
    const auto make = [&](const double* from, std::size_t count, std::size_t points, double radius,
                          const char* kernel) {
      return nendo_deformer_make(from, count, points, radius, kernel, &made);
    };
    check_refused(make(nullptr, 10, 1, 1.0, nullptr), NENDO_USAGE, "vertices: is null");
    check_refused(make(wrong.data(), 10, 1, 1.0, nullptr), NENDO_USAGE, "vertices: a number");
    check_refused(make(vertices.data(), 0, 1, 1.0, nullptr), NENDO_USAGE, "vertex_count");
    check_refused(make(vertices.data(), SIZE_MAX, 1, 1.0, nullptr), NENDO_USAGE, "vertex_count");
    check_refused(make(vertices.data(), 10, 0, 1.0, nullptr), NENDO_USAGE, "control_points");
    for (const double radius : {0.0, -1.0, inf, std::nan("")})
      check_refused(make(vertices.data(), 10, 1, radius, nullptr), NENDO_USAGE, "radius");
    check_refused(make(vertices.data(), 10, 1, 1.0, "gauss"), NENDO_USAGE, "wendland-c2");
    check_refused(nendo_deformer_make(vertices.data(), 10, 1, 1.0, nullptr, nullptr), NENDO_USAGE,
                  "made: is null");
    REQUIRE(make(vertices.data(), 10, 1, 1.0, nullptr) == NENDO_OK);
    CHECK(std::string(nendo_message()).empty()); // a success clears it
    const std::array point{inf, 0.0, 0.0};
    check_refused(nendo_deformer_grab(made, point.data()), NENDO_FAILED, "");
    check_refused(nendo_deformer_grab(made, nullptr), NENDO_USAGE, "points: is null");
    check_refused(nendo_deformer_grab(nullptr, point.data()), NENDO_USAGE, "deformer: is null");
    check_refused(nendo_deformer_move(made, point.data(), nullptr), NENDO_USAGE,
                  "vertices: is null");
    nendo_deformer_free(made);
    nendo_deformer_free(nullptr);
    std::string of_other = "x";
    std::thread([&] { of_other = nendo_message(); }).join();
    CHECK(of_other.empty()); // each thread has its own
  }

  TEST_CASE("a glove that is not there is an error, and one that is has a hand") {
    nendo_glove* glove = nullptr;
    check_refused(nendo_glove_open("serial:/dev/none", nullptr, &glove), NENDO_NO_DEVICE,
                  "/dev/none");
    check_refused(nendo_glove_open("sim:none", nullptr, &glove), NENDO_USAGE, "sim:none");
    check_refused(nendo_glove_open(nullptr, nullptr, &glove), NENDO_USAGE, "glove: is null");
    check_refused(nendo_glove_open("sim", "unknown wearer", &glove), NENDO_BAD_INPUT,
                  "unknown wearer");
    CHECK(glove == nullptr);
    REQUIRE(nendo_glove_open("sim:grasp?hand=right", nullptr, &glove) == NENDO_OK);
    nendo_hand hand{};
    CHECK(eventually([&] {
      REQUIRE(nendo_glove_hand(glove, &hand) == NENDO_OK);
      return hand.samples > 5;
    }));
    CHECK(hand.flags == NENDO_PRESENT);
    CHECK(hand.side == NENDO_RIGHT);
    for (const nendo_joint& joint : hand.joints)
      CHECK(Eigen::Map<const Eigen::Vector4f>(joint.orientation).norm() ==
            doctest::Approx(1.0).epsilon(1e-5));
    check_refused(nendo_glove_hand(glove, nullptr), NENDO_USAGE, "hand: is null");
    nendo_glove_close(glove);
    nendo_glove_close(nullptr);
    check_refused(nendo_find_gloves(nullptr, nullptr), NENDO_USAGE, "found: is null");
    int count = 0;
    CHECK(nendo_find_gloves(
              [](void* counted, const char*, const char*) { ++*static_cast<int*>(counted); },
              &count) == NENDO_OK);
  }

  TEST_CASE("a loop shapes a model file, takes requests and settings, and saves the shape") {
    const test::TemporaryFolder folder;
    const std::string out = (folder.path() / "out.obj").string();
    const nendo_loop_options options = simulated();
    Loop owner;
    REQUIRE_MESSAGE(nendo_loop_begin(NENDO_MODELS "/moai.obj", &options, &owner.loop) == NENDO_OK,
                    nendo_message());
    nendo_loop* const loop = owner.loop;
    const auto model = deform::read_mesh(NENDO_MODELS "/moai.obj");
    REQUIRE(model);
    REQUIRE(nendo_loop_vertex_count(loop) == model->vertex_count());
    std::vector<std::uint32_t> triangles(3 * nendo_loop_triangle_count(loop));
    nendo_loop_triangles(loop, triangles.data());
    CHECK(*std::max_element(triangles.begin(), triangles.end()) < model->vertex_count());
    const std::vector<double> rest(model->vertices.data(),
                                   model->vertices.data() + model->vertices.size());
    CHECK(eventually([&] { return nendo_loop_update(loop) == 1 && vertices_of(loop) != rest; }));
    std::array<nendo_hand, 2> hands{};
    nendo_loop_hands(loop, hands.data());
    for (const std::uint32_t side : {0U, 1U}) {
      CHECK(hands[side].flags == NENDO_PRESENT);
      CHECK(hands[side].side == side);
    }
    CHECK(hands[0].joints[1].position[0] < hands[1].joints[1].position[0]); // left is left
    CHECK(nendo_loop_units_per_metre(loop) > 0.0);
    CHECK(nendo_loop_has_ended(loop) == 0);

    CHECK(nendo_loop_change(loop, "mode", "type2") == NENDO_OK);
    CHECK(nendo_loop_change(loop, "radius_m", "0.05") == NENDO_OK);
    CHECK(nendo_loop_change(loop, "injective", "true") == NENDO_OK);
    CHECK(nendo_loop_change(loop, "brushes", "push") == NENDO_OK);
    check_refused(nendo_loop_change(loop, "mode", "type3"), NENDO_USAGE, "mode: use type1");
    check_refused(nendo_loop_change(loop, "radius_m", "-1"), NENDO_BAD_INPUT, "radius");
    check_refused(nendo_loop_change(loop, "radius_m", "wide"), NENDO_USAGE,
                  "use metres, or five numbers");
    check_refused(nendo_loop_change(loop, "colour", "red"), NENDO_USAGE, "use mode, kernel");
    check_refused(nendo_loop_change(loop, nullptr, "x"), NENDO_USAGE, "setting: is null");
    check_refused(nendo_loop_ask(loop, 7), NENDO_USAGE, "request");
    check_refused(nendo_loop_ask(loop, -1), NENDO_USAGE, "request");
    CHECK(nendo_loop_ask(loop, NENDO_RELEASE) == NENDO_OK);
    CHECK(nendo_loop_ask(loop, NENDO_RESET) == NENDO_OK);
    CHECK(eventually([&] {
      nendo_loop_update(loop);
      return vertices_of(loop) == rest;
    }));
    check_refused(nendo_loop_save(loop, (folder.path() / "none/x.obj").string().c_str()),
                  NENDO_FAILED, "none/x.obj");
    check_refused(nendo_loop_save(loop, out.c_str()), NENDO_FAILED, "has finished");
    CHECK(nendo_loop_has_ended(loop) == 1);
    CHECK(nendo_loop_update(loop) == 0);
  }

  TEST_CASE("a model of the caller is shaped as well, far from zero too, and saved") {
    const test::TemporaryFolder folder;
    const std::string out = (folder.path() / "out.obj").string();
    const std::vector<double> vertices{1e6, 0, 0, 1e6 + 1, 0, 0, 1e6, 1, 0, 1e6, 0, 1};
    const std::vector<std::uint32_t> triangles{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    nendo_loop_options options = simulated();
    options.mode = "type2";
    options.rate_hz = 60.0;
    Loop owner;
    REQUIRE_MESSAGE(nendo_loop_begin_with(vertices.data(), 4, triangles.data(), 4, &options,
                                          &owner.loop) == NENDO_OK,
                    nendo_message());
    CHECK(eventually([&] { return nendo_loop_update(owner.loop) == 1; }));
    const auto now = vertices_of(owner.loop);
    REQUIRE(now.size() == vertices.size());
    CHECK(std::abs(now[0] - 1e6) < 2.0);
    CHECK(nendo_loop_save(owner.loop, out.c_str()) == NENDO_OK);
    const auto saved = deform::read_mesh(out);
    REQUIRE(saved);
    CHECK(saved->vertex_count() == 4);
    CHECK(saved->face_count() == 4);
  }

  TEST_CASE("wrong models and options are errors that name them") {
    const std::vector<double> vertices{0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::vector<std::uint32_t> fine{0, 1, 2}, wrong{0, 1, 3};
    nendo_loop* loop = nullptr;
    nendo_loop_options options = simulated();
    const auto begin = [&](const std::vector<std::uint32_t>& triangles) {
      return nendo_loop_begin_with(vertices.data(), 3, triangles.data(), 1, &options, &loop);
    };
    check_refused(begin(wrong), NENDO_USAGE, "triangles");
    check_refused(nendo_loop_begin_with(nullptr, 3, fine.data(), 1, nullptr, &loop), NENDO_USAGE,
                  "vertices: is null");
    check_refused(nendo_loop_begin("/none.obj", nullptr, &loop), NENDO_BAD_INPUT, "/none.obj");
    check_refused(nendo_loop_begin(nullptr, nullptr, &loop), NENDO_USAGE, "model_file: is null");
    options.mode = "type9";
    check_refused(begin(fine), NENDO_USAGE, "mode: use");
    options = simulated();
    options.reserved[3] = 1;
    check_refused(begin(fine), NENDO_USAGE, "reserved");
    options = simulated();
    options.rate_hz = -5.0;
    check_refused(begin(fine), NENDO_USAGE, "rate");
    options = simulated();
    options.left = "serial:/dev/none";
    check_refused(begin(fine), NENDO_NO_DEVICE, "/dev/none");
    CHECK(loop == nullptr);
    nendo_loop_end(nullptr);
  }
}

} // namespace c_test
