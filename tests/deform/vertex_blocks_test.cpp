#include <nendo/deform/vertex_blocks.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include <doctest/doctest.h>

#include "support/test_meshes.hpp"

namespace vertex_blocks_test {

using namespace nendo::deform;
using nendo::test::random_points;

TEST_SUITE("vertex_blocks") {
  static Points cloud(Eigen::Index count) {
    std::mt19937 random(41);
    return random_points(random, count, 5.0);
  }

  static Points unpacked(const BlockLayout& layout, const BlockShape& shape) {
    Points out;
    layout.unpack(shape, out);
    return out;
  }

  TEST_CASE("a shape that was only packed comes back bit for bit, wherever the model is") {
    for (const double shift : {0.0, 1e3, -1e9})
      for (const double scale : {1.0, 1e-40, 1e60}) {
        Points mesh = scale * (cloud(200).array() + shift).matrix();
        mesh(0, 7) = -0.0;
        const BlockLayout layout(mesh);
        const Points out = unpacked(layout, layout.pack());
        CHECK(out == mesh);
        CHECK(std::signbit(out(0, 7)));
      }
  }

  TEST_CASE("coordinates in blocks are those of the mesh to float's precision of its size") {
    for (const double shift : {0.0, 1e6}) {
      const Points mesh = (cloud(200).array() + shift).matrix();
      const BlockLayout layout(mesh);
      const BlockShape shape = layout.pack();
      REQUIRE(shape.block_count() == 4);
      auto order = layout.order();
      for (std::size_t at = 0; at < order.size(); ++at) {
        const VertexBlock& block = shape[at / block_size];
        const Eigen::Vector3d coordinates(static_cast<double>(block.x[at % block_size]),
                                          static_cast<double>(block.y[at % block_size]),
                                          static_cast<double>(block.z[at % block_size]));
        const Eigen::Vector3d place = layout.origin() + layout.unit() * coordinates;
        CHECK((place - mesh.col(order[at])).norm() < 1e-6);
        CHECK(coordinates.cwiseAbs().maxCoeff() <= 1.0);
      }
      std::sort(order.begin(), order.end());
      std::vector<std::uint32_t> all(200);
      std::iota(all.begin(), all.end(), 0u);
      CHECK(order == all);
      for (std::size_t lane = 200 % block_size; lane < block_size; ++lane)
        CHECK(shape[3].x[lane] == shape[3].x[200 % block_size - 1]);
    }
  }

  TEST_CASE("a vertex that moved is where it went, its neighbours where they were") {
    const Points mesh = (cloud(100).array() + 1000.0).matrix();
    const BlockLayout layout(mesh);
    BlockShape shape = layout.pack();
    const auto vertex = static_cast<Eigen::Index>(layout.order()[70]);
    shape.data()[1].y[6] += static_cast<float>(0.25 / layout.unit());
    Points expected = mesh;
    expected(1, vertex) += 0.25;
    const Points out = unpacked(layout, shape);
    CHECK((out - expected).cwiseAbs().maxCoeff() < 1e-6);
    expected(1, vertex) = out(1, vertex);
    CHECK(out == expected);
  }

  TEST_CASE("what moved is returned exactly as the blocks have it") {
    const BlockLayout layout(cloud(200));
    BlockShape shape = layout.pack();
    std::mt19937 random(42);
    std::uniform_real_distribution<float> way(-1e-6F, 1e-6F); // some steps of a float
    for (std::size_t block = 0; block < shape.block_count(); ++block)
      for (auto* row : {&shape.data()[block].x, &shape.data()[block].y, &shape.data()[block].z})
        for (float& coordinate : *row)
          coordinate += way(random);
    const Points out = unpacked(layout, shape);
    std::size_t exact = 0, kept = 0;
    for (std::size_t at = 0; at < layout.vertex_count(); ++at)
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double coordinate = static_cast<double>(vertex_at(shape, at)[axis]);
        const auto vertex = static_cast<Eigen::Index>(layout.order()[at]);
        exact += out(axis, vertex) == layout.origin()[axis] + layout.unit() * coordinate ? 1U : 0U;
        kept += out(axis, vertex) == layout.original()(axis, vertex) ? 1U : 0U;
      }
    CHECK(exact > 500); // the others were not moved by as much as a step
    CHECK(exact + kept >= 600);
  }

  TEST_CASE("a copy follows what changed, and only that") {
    const BlockLayout layout(cloud(300));
    BlockShape shape = layout.pack();
    BlockShape copy;
    copy.follow(shape);
    CHECK(unpacked(layout, copy) == layout.original());
    shape.data()[2].x[0] = 7.0F;
    shape.set_stamp(2, BlockShape::new_stamp());
    copy.data()[1].x[0] = 9.0F; // unstamped: so it shows whether block 1 is copied
    copy.follow(shape);
    CHECK(copy[2].x[0] == 7.0F);
    CHECK(copy[1].x[0] == 9.0F);
    copy.set_stamp(1, BlockShape::new_stamp());
    copy.follow(shape);
    CHECK(copy[1].x[0] == shape[1].x[0]);
    CHECK(BlockShape::new_stamp() != BlockShape::new_stamp());
  }

  TEST_CASE("the bounds of a block are those of its vertices") {
    const BlockLayout layout(cloud(64));
    const BlockShape shape = layout.pack();
    const auto sides = bounds_of(shape[0]).sides;
    const Points packed = (layout.original().colwise() - layout.origin()) / layout.unit();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(axis);
      CHECK(static_cast<double>(sides[at]) == doctest::Approx(packed.row(axis).minCoeff()));
      CHECK(-static_cast<double>(sides[at + 4]) == doctest::Approx(packed.row(axis).maxCoeff()));
    }
  }

  TEST_CASE("models of no vertex, of one, and with vertices that are not finite") {
    const BlockLayout none(Points(3, 0));
    CHECK(none.pack().block_count() == 0);
    CHECK(unpacked(none, none.pack()).cols() == 0);
    const BlockLayout one(Points::Constant(3, 1, 4.5));
    CHECK(unpacked(one, one.pack()) == one.original());
    Points spoilt = cloud(70);
    spoilt(2, 3) = std::numeric_limits<double>::infinity();
    spoilt(0, 9) = -std::numeric_limits<double>::max();
    const BlockLayout layout(spoilt);
    const BlockShape shape = layout.pack();
    for (std::size_t block = 0; block < 2; ++block)
      for (const auto& coordinates : {shape[block].x, shape[block].y, shape[block].z})
        for (const float coordinate : coordinates)
          CHECK(std::abs(coordinate) <= 2.0F);
    CHECK(unpacked(layout, shape) == spoilt);
  }

  TEST_CASE("a rounded place is one that float holds, and near") {
    const BlockLayout layout((cloud(100).array() + 100.0).matrix());
    const Eigen::Vector3d place(100.1, 99.7, 103.3);
    const Eigen::Vector3d rounded = layout.rounded(place);
    CHECK((rounded - place).norm() < 1e-6);
    CHECK(rounded != place);
    CHECK(layout.rounded(rounded) == rounded);
    CHECK(layout.rounded_radius(0.3) == doctest::Approx(0.3).epsilon(1e-6));
    CHECK(layout.rounded(Eigen::Vector3d::Constant(1e80)) == Eigen::Vector3d::Constant(1e80));
    CHECK(std::isnan(layout.rounded_radius(std::nan(""))));
  }
}

} // namespace vertex_blocks_test
