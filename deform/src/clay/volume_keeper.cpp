#include "clay/volume_keeper.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

namespace nendo::deform {

using Eigen::Vector4f;

namespace {

/// Of a step to the mean of the neighbours, for each edge that a vertex is moved by.
constexpr float fairness = 2.0F;
constexpr float most_fairing = 0.3F;
constexpr float least_square = 1e-30F; // instead of a division by 0

/// Eigen's cross product of vectors of four waits for memory, and takes thrice as long.
using Four = float __attribute__((vector_size(16)));
Four four(const Vector4f& vector) noexcept {
  Four result;
  std::memcpy(&result, vector.data(), sizeof(result));
  return result;
}
Vector4f vector(const Four& numbers) noexcept {
  Vector4f result;
  std::memcpy(result.data(), &numbers, sizeof(numbers));
  return result;
}
/// y, z, x, w. A cross product is turned(a * turned(b) - turned(a) * b).
Four turned(const Four& numbers) noexcept {
  return __builtin_shufflevector(numbers, numbers, 1, 2, 0, 3);
}

float smooth_step(float t) noexcept {
  const float s = std::clamp(t, 0.0F, 1.0F);
  return s * s * (3.0F - 2.0F * s);
}

bool is_closed_surface(std::span<const std::uint32_t> corners) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Edge> ahead, back;
  for (std::size_t at = 0; at + 2 < corners.size(); at += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      ahead.emplace_back(corners[at + k], corners[at + (k + 1) % 3]);
      back.emplace_back(corners[at + (k + 1) % 3], corners[at + k]);
    }
  std::sort(ahead.begin(), ahead.end());
  std::sort(back.begin(), back.end());
  return !ahead.empty() && ahead == back &&
         std::adjacent_find(ahead.begin(), ahead.end()) == ahead.end();
}

} // namespace

VolumeKeeper::VolumeKeeper(const BlockLayout& layout, std::span<const std::uint32_t> triangles)
    : vertices_(layout.vertex_count()), is_closed_(is_closed_surface(triangles)) {
  if (!is_closed_) return;
  build_fans(layout, triangles);
  const std::size_t blocks = layout.block_count();
  build_neighbours(blocks);
  stamps_.assign(blocks, 0);
  volumes_.assign(blocks, 0.0);
  is_free_.assign(blocks, 0);
  for (auto* vectors : {&points_, &normals_, &directions_, &fairing_})
    vectors->assign(vertices_, Vector4f::Zero());
  rates_.assign(vertices_, 0.0F);
  curvatures_.assign(vertices_, 0.0F);
  weights_.assign(blocks * block_size, 0.0F);
}

/// Orders the neighbours of each vertex as they are met when one goes round it, counter-clockwise.
/// Where several fans meet, each begins and ends with the same neighbour, so that the products of
/// neighbours in a row are still those of the triangles: what leads from fan to fan cancels out.
void VolumeKeeper::build_fans(const BlockLayout& layout, std::span<const std::uint32_t> corners) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  const std::vector<std::uint32_t> places = layout.places();
  auto edges = rows_by_key<Edge>(vertices_, [&](const auto& visit) {
    for (std::size_t at = 0; at < corners.size(); ++at) {
      const std::size_t first = at / 3 * 3;
      visit(places[corners[at]],
            Edge{places[corners[first + (at + 1) % 3]], places[corners[first + (at + 2) % 3]]});
    }
  });
  fans_.starts.assign(1, 0);
  for (std::size_t place = 0; place < vertices_; ++place) {
    const std::span<Edge> around = edges[place];
    std::size_t fan = 0; // its first edge
    for (std::size_t at = 0; at < around.size(); ++at) {
      fans_.items.push_back(around[at].first);
      if (around[at].second == around[fan].first) { // round
        if (fan > 0 || at + 1 < around.size()) fans_.items.push_back(around[fan].first);
        fan = at + 1;
        continue;
      }
      const auto next =
          std::find_if(around.begin() + static_cast<std::ptrdiff_t>(at) + 1, around.end(),
                       [&](const Edge& edge) { return edge.first == around[at].second; });
      if (next != around.end())
        std::iter_swap(around.begin() + static_cast<std::ptrdiff_t>(at) + 1, next);
    }
    fans_.starts.push_back(static_cast<std::uint32_t>(fans_.items.size()));
  }
}

void VolumeKeeper::build_neighbours(std::size_t blocks) {
  neighbours_.starts.assign(1, 0);
  std::vector<std::uint32_t> of_block;
  for (std::size_t block = 0; block < blocks; ++block) {
    of_block.assign(1, static_cast<std::uint32_t>(block));
    for (std::size_t place = block * block_size; place < end_of(block); ++place)
      for (const std::uint32_t other : fans_[place])
        of_block.push_back(static_cast<std::uint32_t>(other / block_size));
    std::sort(of_block.begin(), of_block.end());
    of_block.erase(std::unique(of_block.begin(), of_block.end()), of_block.end());
    neighbours_.items.insert(neighbours_.items.end(), of_block.begin(), of_block.end());
    neighbours_.starts.push_back(static_cast<std::uint32_t>(neighbours_.items.size()));
  }
}

bool VolumeKeeper::has_changed(const BoundedShape& shape, std::size_t block) const noexcept {
  const auto around = neighbours_[block];
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t other) {
    return stamps_[other] != shape.shape.stamp(other);
  });
}

void VolumeKeeper::read(const BoundedShape& shape, std::size_t block) noexcept {
  const VertexBlock& content = shape.shape[block];
  const std::size_t first = block * block_size;
  for (std::size_t place = first; place < end_of(block); ++place)
    points_[place] = {content.x[place - first], content.y[place - first], content.z[place - first],
                      0.0F};
}

/// The volume's derivative by a vertex is a sixth of the sum of its triangles' cross products, and
/// the sum of vertices times derivatives is three times the volume. The direction is that of the
/// derivatives of the vertex and of its neighbours, because those of single vertices are rough;
/// some of the neighbours' may be those of the call before. Where neighbours lie on a circle with a
/// radius of h, their middle is H h^2 / 2 below the vertex, H being the mean curvature; and the
/// area of a surface that moves by f along its normals grows with 2 H f.
double VolumeKeeper::measure(std::size_t place) noexcept {
  const Vector4f at = points_[place];
  const auto fan = fans_[place];
  if (fan.empty()) return 0.0;
  const Four here = four(at);
  Four crosses{};
  Four all_normals{};
  Four all_ways{};
  Four all_squares{};
  Four before = four(points_[fan.back()]) - here;
  for (const std::uint32_t other : fan) {
    const Four way = four(points_[other]) - here;
    crosses += before * turned(way) - turned(before) * way;
    all_normals += four(normals_[other]);
    all_ways += way;
    all_squares += way * way;
    before = way;
  }
  const Vector4f normal = vector(turned(crosses)) / 6.0F;
  Vector4f around = vector(all_normals);
  const Vector4f ways = vector(all_ways);
  const Vector4f squares = vector(all_squares);
  normals_[place] = normal;
  around += normal;
  const auto count = static_cast<float>(fan.size());
  const float per_square = count / std::max(squares.sum(), least_square);
  const Vector4f direction = around / std::sqrt(std::max(around.squaredNorm(), least_square));
  const float height = ways.dot(direction) / count;
  directions_[place] = direction;
  fairing_[place] = ways / count - height * direction;
  fairing_[place][3] = std::sqrt(per_square);
  rates_[place] = direction.dot(normal);
  curvatures_[place] = -2.0F * height * per_square;
  return static_cast<double>(at.dot(normal));
}

void VolumeKeeper::measure_block(std::size_t block) noexcept {
  double sum = 0.0;
  for (std::size_t place = block * block_size; place < end_of(block); ++place)
    sum += measure(place);
  volumes_[block] = sum / 3.0;
}

double VolumeKeeper::volume(const BoundedShape& shape) noexcept {
  for (std::size_t block = 0; block < volumes_.size(); ++block)
    if (stamps_[block] != shape.shape.stamp(block)) read(shape, block);
  double sum = 0.0;
  for (std::size_t block = 0; block < volumes_.size(); ++block) {
    if (has_changed(shape, block)) measure_block(block);
    sum += volumes_[block];
  }
  for (std::size_t block = 0; block < volumes_.size(); ++block)
    stamps_[block] = shape.shape.stamp(block);
  return sum;
}

void VolumeKeeper::forget() noexcept {
  std::fill(stamps_.begin(), stamps_.end(), 0);
  std::fill(normals_.begin(), normals_.end(), Vector4f::Zero());
}

/// By the distance from the box along the farthest axis.
void VolumeKeeper::weigh_around(const BoundedShape& shape, std::size_t block,
                                const GiveBack& how) noexcept {
  float* const weights = weights_.data() + block * block_size;
  std::fill_n(weights, block_size, 1.0F);
  if (how.around == nullptr) return;
  const VertexBlock& content = shape.shape[block];
  const auto& sides = how.around->limits.sides;
  const std::array<const float*, 3> coordinates{content.x.data(), content.y.data(),
                                                content.z.data()};
  std::array<float, block_size> distances{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t lane = 0; lane < block_size; ++lane) {
      const float coordinate = coordinates[axis][lane];
      const float above = coordinate - sides[axis];
      const float below = -coordinate - sides[axis + 4];
      const float farther = above > below ? above : below;
      distances[lane] = distances[lane] > farther ? distances[lane] : farther;
    }
  const float inverse = 1.0F / static_cast<float>(how.reach);
  for (std::size_t lane = 0; lane < block_size; ++lane)
    weights[lane] = smooth_step(1.0F - distances[lane] * inverse);
}

void VolumeKeeper::weigh(const BoundedShape& shape, ContactSearch& search,
                         const GiveBack& how) noexcept {
  const auto reach = static_cast<float>(how.reach);
  for (std::size_t block = 0; block < volumes_.size(); ++block) {
    const bool is_reached = how.around == nullptr || how.around->meets(shape.bounds[block], reach);
    is_free_[block] = is_reached ? 1 : 0;
    if (is_reached) weigh_around(shape, block, how);
  }
  const auto inverse = static_cast<float>(1.0 / how.near);
  for (std::size_t body = 0; body < search.bodies(); ++body)
    search.each_near(shape, body, how.near, [&](std::size_t block, const NearestLanes& nearest) {
      float* const weights = weights_.data() + block * block_size;
      for (std::size_t lane = 0; lane < block_size; ++lane)
        weights[lane] *= smooth_step(nearest.distance[lane] * inverse);
    });
}

/// How much volume a step along the weighted directions adds.
void VolumeKeeper::sum_rates() noexcept {
  rate_ = bend_ = 0.0;
  for (std::size_t block = 0; block < volumes_.size(); ++block) {
    if (is_free_[block] == 0) continue;
    float rate = 0.0F;
    float bend = 0.0F;
    float largest = 0.0F;
    for (std::size_t place = block * block_size; place < end_of(block); ++place) {
      const float weight = weights_[place];
      rate += weight * rates_[place];
      bend += weight * weight * curvatures_[place] * rates_[place];
      largest = std::max(largest, weight);
    }
    rate_ += static_cast<double>(rate);
    bend_ += static_cast<double>(bend);
    is_free_[block] = largest > 0.0F ? 1 : 0;
  }
}

/// Solves rate * far + bend * far^2 = missing near far = 0.
double VolumeKeeper::distance_for(double missing, double most) const noexcept {
  double far = std::clamp(missing / rate_, -most, most);
  for (int round = 0; round < 3; ++round) {
    const double rate = std::max(rate_ + bend_ * far, 0.5 * rate_);
    far = std::clamp(missing / rate, -most, most);
  }
  return far;
}

/// Besides, each vertex goes a part of the way to the middle of its neighbours, which keeps
/// triangles fair where much swells.
void VolumeKeeper::move(BoundedShape& shape, float far) noexcept {
  const std::uint64_t stamp = BlockShape::new_stamp();
  for (std::size_t block = 0; block < volumes_.size(); ++block) {
    if (is_free_[block] == 0) continue;
    VertexBlock& content = shape.shape.data()[block];
    const std::size_t first = block * block_size;
    const std::size_t used = end_of(block) - first;
    for (std::size_t lane = 0; lane < used; ++lane) {
      const Vector4f& fairing = fairing_[first + lane];
      const float fair = std::min(most_fairing, fairness * std::abs(far) * fairing[3]);
      const Vector4f by =
          weights_[first + lane] * (far * directions_[first + lane] + fair * fairing);
      content.x[lane] += by[0];
      content.y[lane] += by[1];
      content.z[lane] += by[2];
    }
    for (std::size_t lane = used; lane < block_size; ++lane) { // the padding repeats the last one
      content.x[lane] = content.x[used - 1];
      content.y[lane] = content.y[used - 1];
      content.z[lane] = content.z[used - 1];
    }
    shape.shape.set_stamp(block, stamp);
    shape.bounds[block] = fast_bounds_of(content);
  }
}

double VolumeKeeper::give_back(BoundedShape& shape, ContactSearch& search, double missing,
                               const GiveBack& how) noexcept {
  weigh(shape, search, how);
  sum_rates();
  if (!(rate_ > 0.0)) return 0.0;
  const double far = distance_for(missing, how.most);
  move(shape, static_cast<float>(far));
  shape.extent += how.most;
  return (rate_ + bend_ * far) * far;
}

} // namespace nendo::deform
