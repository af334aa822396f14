#include "clay/ring_layout.hpp"

#include <array>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/triangles.hpp>

#include "reference/icosphere.hpp"
#include "support/test_meshes.hpp"

namespace ring_layout_test {

using namespace nendo::deform;

namespace {

/// The places of a vertex' neighbours as the rows have them; each vertex' x is its place.
std::vector<std::uint32_t> neighbours_of(const RingLayout& rings, const BlockShape& numbered,
                                         std::size_t place) {
  const std::size_t block = place / block_size, lane = place % block_size;
  std::vector<std::uint32_t> found;
  RingTable table;
  for (std::size_t part = 0; part < rings.parts(block); ++part) {
    rings.fill(
        block, part, [&](std::size_t of) -> const VertexBlock& { return numbered[of]; }, table);
    for (const RingRow& row : rings.rows(block, part))
      found.push_back(static_cast<std::uint32_t>(table[row[lane]][0]));
  }
  const auto count = static_cast<std::size_t>(rings.counts(block)[lane]);
  CHECK(count <= found.size());
  for (std::size_t at = count; at < found.size(); ++at)
    CHECK(found[at] == found[count - 1]); // the last one again
  found.resize(count);
  return found;
}

/// Two balls that share a vertex.
Mesh touching_balls() {
  Mesh both = nendo::reference::icosphere(2, 1.0);
  const Eigen::Index count = both.vertices.cols();
  Points vertices(3, 2 * count - 1);
  vertices.leftCols(count) = both.vertices;
  const Eigen::Vector3d shared = both.vertices.col(0);
  vertices.rightCols(count - 1) = -both.vertices.rightCols(count - 1);
  vertices.rightCols(count - 1).colwise() += 2.0 * shared;
  const std::vector<std::uint32_t> corners = corners_of_triangles(both);
  const auto mirrored = [&](std::uint32_t corner) {
    return corner == 0 ? 0U : corner + static_cast<std::uint32_t>(count) - 1U;
  };
  for (std::size_t at = 0; at < corners.size(); at += 3) {
    for (const std::size_t next : {0U, 2U, 1U}) // turned, as a mirror does
      both.face_corners.push_back(mirrored(corners[at + next]));
    both.face_starts.push_back(static_cast<std::uint32_t>(both.face_corners.size()));
  }
  both.vertices = vertices;
  return both;
}

} // namespace

TEST_SUITE("ring_layout") {
  TEST_CASE("who goes round a vertex by its neighbours meets each of its triangles once") {
    for (const Mesh& mesh : {nendo::reference::icosphere(4, 1.0), nendo::test::sphere(1, 100, 1.0),
                             nendo::test::sphere(1, 1000, 1.0), touching_balls()}) {
      CAPTURE(mesh.vertices.cols());
      const BlockLayout layout(mesh.vertices);
      const std::vector<std::uint32_t> corners = corners_of_triangles(mesh);
      const RingLayout rings(layout, corners);
      BlockShape numbered = layout.pack();
      for (std::size_t place = 0; place < numbered.block_count() * block_size; ++place)
        numbered.data()[place / block_size].x[place % block_size] = static_cast<float>(place);
      using Edge = std::pair<std::uint32_t, std::uint32_t>;
      const std::vector<std::uint32_t> places = layout.places();
      std::vector<std::set<Edge>> opposite(layout.vertex_count());
      for (std::size_t at = 0; at < corners.size(); ++at) {
        const std::size_t first = at / 3 * 3;
        opposite[places[corners[at]]].insert(
            {places[corners[first + (at + 1) % 3]], places[corners[first + (at + 2) % 3]]});
      }
      for (std::size_t place = 0; place < layout.vertex_count(); ++place) {
        const auto around = neighbours_of(rings, numbered, place);
        REQUIRE_FALSE(around.empty());
        std::set<Edge> met, beside; // what leads from fan to fan is run along in both directions
        for (std::size_t at = 0; at < around.size(); ++at) {
          const Edge edge{around[at], around[(at + 1) % around.size()]};
          const bool is_one = opposite[place].count(edge) > 0;
          CHECK((is_one ? met : beside).insert(edge).second);
        }
        CHECK(met == opposite[place]);
        for (const auto& [from, to] : beside)
          CHECK((from == to || beside.count({to, from}) > 0));
      }
    }
  }

  TEST_CASE("each neighbour's block is one of those around") {
    const Mesh ball = nendo::reference::icosphere(4, 1.0);
    const BlockLayout layout(ball.vertices);
    const std::vector<std::uint32_t> corners = corners_of_triangles(ball);
    const RingLayout rings(layout, corners);
    const std::vector<std::uint32_t> places = layout.places();
    std::vector<std::set<std::uint32_t>> blocks(layout.block_count());
    for (std::size_t at = 0; at < corners.size(); ++at)
      for (std::size_t k = 0; k < 3; ++k)
        blocks[places[corners[at]] / block_size].insert(
            static_cast<std::uint32_t>(places[corners[at / 3 * 3 + k]] / block_size));
    for (std::size_t block = 0; block < blocks.size(); ++block) {
      const auto around = rings.blocks_around(block);
      CHECK(std::set<std::uint32_t>(around.begin(), around.end()) == blocks[block]);
    }
  }
}

} // namespace ring_layout_test
