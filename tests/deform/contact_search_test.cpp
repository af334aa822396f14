#include "clay/contact_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include <doctest/doctest.h>

#include "clay/contact_points.hpp"
#include "support/contact_parts.hpp"
#include "support/rounds.hpp"
#include "support/test_meshes.hpp"

namespace contact_search_test {

using namespace nendo::deform;
using Eigen::Vector3d;
using nendo::test::random_points;
using nendo::test::sampled_distance;

namespace {

ContactPart random_contact_part(std::mt19937& random) {
  std::uniform_real_distribution<double> radius(0.02, 0.3);
  ContactPart part;
  part.corner_count = 2 + random() % 2;
  for (std::size_t at = 0; at < 3; ++at) {
    part.corners[at] = random_points(random, 1, 0.8).col(0);
    part.radii[at] = radius(random);
  }
  return part;
}

} // namespace

TEST_SUITE("contact_search") {
  TEST_CASE("each vertex near a body is found, with its distance, normal and part") {
    std::mt19937 random(31);
    const BlockLayout layout(random_points(random, 1000, 1.0));
    const BoundedShape shape(layout.pack());
    for (int trial = 0; trial < 8; ++trial) {
      const double margin = trial < 4 ? 0.1 : 0.6;
      std::vector<ContactPart> parts;
      for (int part = 0; part < 6; ++part) {
        parts.push_back(random_contact_part(random));
        parts.back().radii[0] *= trial % 2 == 0 ? 1.0 : 3.0; // one ball may contain another
      }
      ContactSearch search(2, 3);
      search.set_parts(parts);
      for (std::size_t body = 0; body < 2; ++body) {
        const std::span<const ContactPart> own{parts.data() + 3 * body, 3};
        std::vector<double> found(shape.shape.block_count() * block_size, 1e9);
        search.each_near(shape, body, margin, [&](std::size_t block, const NearestLanes& nearest) {
          for (std::size_t lane = 0; lane < block_size; ++lane) {
            const auto distance = static_cast<double>(nearest.distance[lane]);
            const std::size_t place = block * block_size + lane;
            found[place] = distance;
            if (distance > margin) continue;
            const auto part = static_cast<std::size_t>(nearest.part[lane]);
            REQUIRE(part / 3 == body);
            const Vector3d at = vertex_at(shape.shape, place).cast<double>();
            CHECK(std::abs(sampled_distance(parts[part], at) - distance) < 1e-5);
            const Vector3d out =
                (at -
                 Eigen::Vector3f(nearest.x[lane], nearest.y[lane], nearest.z[lane]).cast<double>())
                    .normalized();
            CHECK(std::abs(sampled_distance(parts[part], at + 1e-3 * out) - distance - 1e-3) <
                  2e-5);
          }
        });
        double worst = 0.0;
        for (std::size_t place = 0; place < layout.vertex_count(); ++place) {
          const double truth = sampled_distance(own, vertex_at(shape.shape, place).cast<double>());
          if (truth < margin - 1e-5) worst = std::max(worst, std::abs(found[place] - truth));
          if (truth > margin + 1e-5) CHECK(found[place] > margin);
        }
        CHECK(worst < 1e-5);
      }
    }
  }

  TEST_CASE("what is far away costs nothing") {
    std::mt19937 random(32);
    const BlockLayout layout(random_points(random, 20'000, 1.0));
    const BoundedShape shape(layout.pack());
    ContactSearch search(1, 1);
    const std::vector<ContactPart> small{
        nendo::test::cone({0.9, 0.9, 0.9}, {0.95, 0.9, 0.9}, 0.05, 0.05)};
    search.set_parts(small);
    search.each_near(shape, 0, 0.0, [](std::size_t, const NearestLanes&) {});
    CHECK(search.distances() > 0);
    CHECK(search.distances() < 1000);
    search.distances() = 0;
    search.set_parts(nendo::test::moved(small, Vector3d(5, 0, 0)));
    search.each_near(shape, 0, 0.5, [](std::size_t, const NearestLanes&) { CHECK(false); });
    CHECK(search.distances() == 0);
  }

  TEST_CASE("of a block, the nearest vertex of each cell and part is listed") {
    std::mt19937 random(34);
    std::uniform_real_distribution<float> coordinate(-1.0F, 1.0F);
    for (int round = 0; round < nendo::test::rounds(200); ++round) {
      VertexBlock block{};
      NearestLanes nearest{};
      for (std::size_t lane = 0; lane < block_size; ++lane) {
        block.x[lane] = coordinate(random);
        block.y[lane] = coordinate(random);
        block.z[lane] = coordinate(random);
        // Coarse ones, so that some are equal.
        nearest.distance[lane] = 0.25F * std::round(4.0F * coordinate(random));
        nearest.part[lane] = static_cast<float>(random() % 3);
      }
      ContactPoints points(64);
      points.clear(0.7);
      const SpaceCells cells = points.cells();
      const auto cell = [&](float x) {
        return static_cast<int>(x * cells.per_length + cells.shift);
      };
      using Key = std::tuple<int, int, int, float>;
      std::map<Key, std::size_t> expected;
      for (std::size_t lane = 0; lane < block_size; ++lane) {
        if (!(nearest.distance[lane] < 0.5F)) continue;
        const Key key{cell(block.x[lane]), cell(block.y[lane]), cell(block.z[lane]),
                      nearest.part[lane]};
        const auto kept = expected.emplace(key, lane).first;
        if (nearest.distance[lane] < nearest.distance[kept->second]) kept->second = lane;
      }
      std::array<std::uint8_t, block_size> lanes{};
      const std::size_t count = nearest_of_cells(block, nearest, 0.5F, cells, lanes);
      std::set<std::size_t> listed;
      for (std::size_t at = 0; at < count; ++at) {
        listed.insert(lanes[at]);
        if (at > 0) CHECK(nearest.distance[lanes[at]] >= nearest.distance[lanes[at - 1]]);
      }
      std::set<std::size_t> wanted;
      for (const auto& [key, lane] : expected)
        wanted.insert(lane);
      CHECK(count == wanted.size());
      CHECK(listed == wanted);
    }
  }

  TEST_CASE("points are chosen by depth, without crowds, in whatever order they come") {
    std::mt19937 random(33);
    std::vector<NearVertex> offered;
    std::uniform_real_distribution<float> depth(0.0F, 1.0F);
    for (std::uint32_t place = 0; place < 2000; ++place) {
      const Eigen::Vector3f at = random_points(random, 1, 2.0).col(0).cast<float>();
      offered.push_back({place, 0, static_cast<std::uint32_t>(random() % 3), depth(random), at,
                         at - Eigen::Vector3f::UnitZ()});
    }
    const auto chosen_of = [&](std::size_t most) {
      ContactPoints points(most);
      points.clear(0.5);
      for (const NearVertex& vertex : offered)
        points.offer(vertex);
      std::vector<std::uint32_t> places;
      const auto chosen = points.choose(0.3);
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        places.push_back(chosen[i].place);
        if (i > 0) CHECK(chosen[i].depth <= chosen[i - 1].depth);
        for (std::size_t j = 0; j < i; ++j)
          CHECK((chosen[i].at - chosen[j].at).norm() >= 0.3 - 1e-6);
      }
      return places;
    };
    const auto first = chosen_of(2000);
    CHECK(first.size() > 200);
    const auto deepest = std::max_element(
        offered.begin(), offered.end(),
        [](const NearVertex& a, const NearVertex& b) { return a.depth < b.depth; });
    CHECK(first.front() == deepest->place);
    std::shuffle(offered.begin(), offered.end(), random);
    CHECK(chosen_of(2000) == first);
    const auto few = chosen_of(260);
    CHECK(few.size() <= 260);
  }
}

} // namespace contact_search_test
