#include "clay/volume_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nendo::deform {

using Eigen::Vector3f;

namespace {

/// Of a step to the mean of the neighbours, for each edge that a vertex is moved by.
constexpr float fairness = 2.0F;
constexpr float most_fairing = 0.3F;

Vector3f lane_of(const VertexBlock& block, std::size_t lane) noexcept {
  return {block.x[lane], block.y[lane], block.z[lane]};
}
void set_lane(VertexBlock& block, std::size_t lane, const Vector3f& value) noexcept {
  block.x[lane] = value.x();
  block.y[lane] = value.y();
  block.z[lane] = value.z();
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

/// The distance from a box along the farthest axis.
float distance_from(const BoxGate& box, const Vector3f& place) noexcept {
  float distance = 0.0F;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float coordinate = place[static_cast<Eigen::Index>(axis)];
    distance = std::max(
        {distance, coordinate - box.limits.sides[axis], -coordinate - box.limits.sides[axis + 4]});
  }
  return distance;
}

} // namespace

VolumeKeeper::VolumeKeeper(const BlockLayout& layout, std::span<const std::uint32_t> triangles)
    : vertices_(layout.vertex_count()), is_closed_(is_closed_surface(triangles)) {
  if (!is_closed_) return;
  build_rings(layout, triangles);
  const std::size_t blocks = layout.block_count();
  build_neighbours(blocks);
  stamps_.assign(blocks, 0);
  volumes_.assign(blocks, 0.0);
  normals_.resize(blocks);
  moves_.resize(blocks);
  weights_.assign(blocks * block_size, 0.0F);
  is_free_.assign(blocks, 0);
}

void VolumeKeeper::build_rings(const BlockLayout& layout, std::span<const std::uint32_t> corners) {
  const std::vector<std::uint32_t> places = layout.places();
  starts_.assign(vertices_ + 1, 0);
  for (const std::uint32_t vertex : corners)
    ++starts_[places[vertex] + 1];
  for (std::size_t place = 0; place < vertices_; ++place)
    starts_[place + 1] += starts_[place];
  pairs_.resize(corners.size());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t at = 0; at < corners.size(); ++at) {
    const std::size_t first = at / 3 * 3;
    pairs_[next[places[corners[at]]]++] = {places[corners[first + (at + 1) % 3]],
                                           places[corners[first + (at + 2) % 3]]};
  }
}

void VolumeKeeper::build_neighbours(std::size_t blocks) {
  neighbour_starts_.assign(1, 0);
  std::vector<std::uint32_t> of_block;
  for (std::size_t block = 0; block < blocks; ++block) {
    of_block.assign(1, static_cast<std::uint32_t>(block));
    const std::size_t end = std::min(vertices_, (block + 1) * block_size);
    for (std::uint32_t at = starts_[block * block_size]; at < starts_[end]; ++at)
      for (const std::uint32_t place : {pairs_[at].second, pairs_[at].third})
        of_block.push_back(static_cast<std::uint32_t>(place / block_size));
    std::sort(of_block.begin(), of_block.end());
    of_block.erase(std::unique(of_block.begin(), of_block.end()), of_block.end());
    neighbours_.insert(neighbours_.end(), of_block.begin(), of_block.end());
    neighbour_starts_.push_back(static_cast<std::uint32_t>(neighbours_.size()));
  }
}

bool VolumeKeeper::has_changed(const BoundedShape& shape, std::size_t block) const noexcept {
  for (std::uint32_t at = neighbour_starts_[block]; at < neighbour_starts_[block + 1]; ++at)
    if (stamps_[neighbours_[at]] != shape.shape.stamp(neighbours_[at])) return true;
  return false;
}

/// The volume's derivative by a vertex is a sixth of the sum of its triangles' cross products, and
/// the sum of vertices times derivatives is three times the volume.
void VolumeKeeper::measure(const BoundedShape& shape, std::size_t block) noexcept {
  double sum = 0.0;
  const std::size_t end = std::min(vertices_, (block + 1) * block_size);
  for (std::size_t place = block * block_size; place < end; ++place) {
    const Vector3f at = vertex_at(shape.shape, place);
    Vector3f normal = Vector3f::Zero();
    for (std::uint32_t pair = starts_[place]; pair < starts_[place + 1]; ++pair)
      normal += (vertex_at(shape.shape, pairs_[pair].second) - at)
                    .cross(vertex_at(shape.shape, pairs_[pair].third) - at);
    normal /= 6.0F;
    set_lane(normals_[block], place % block_size, normal);
    sum += at.cast<double>().dot(normal.cast<double>());
  }
  volumes_[block] = sum / 3.0;
}

double VolumeKeeper::volume(const BoundedShape& shape) noexcept {
  double sum = 0.0;
  for (std::size_t block = 0; block < volumes_.size(); ++block) {
    if (has_changed(shape, block)) measure(shape, block);
    sum += volumes_[block];
  }
  for (std::size_t block = 0; block < volumes_.size(); ++block)
    stamps_[block] = shape.shape.stamp(block);
  return sum;
}

void VolumeKeeper::weigh(const BoundedShape& shape, ContactSearch& search,
                         const GiveBack& how) noexcept {
  const auto reach = static_cast<float>(how.reach);
  for (std::size_t block = 0; block < volumes_.size(); ++block) {
    const bool is_reached = how.around == nullptr || how.around->meets(shape.bounds[block], reach);
    is_free_[block] = is_reached ? 1 : 0;
    if (!is_reached) continue;
    const std::size_t end = std::min(vertices_, (block + 1) * block_size);
    for (std::size_t place = block * block_size; place < end; ++place)
      weights_[place] =
          how.around == nullptr
              ? 1.0F
              : smooth_step(1.0F -
                            distance_from(*how.around, vertex_at(shape.shape, place)) / reach);
  }
  const auto near = static_cast<float>(how.near);
  for (std::size_t body = 0; body < search.bodies(); ++body)
    search.each_near(shape, body, how.near, [&](std::size_t block, const NearestLanes& nearest) {
      for (std::size_t lane = 0; lane < block_size; ++lane)
        weights_[block * block_size + lane] *= smooth_step(nearest.distance[lane] / near);
    });
}

/// Of the normals of a vertex and of its neighbours: those of single vertices are rough.
Vector3f VolumeKeeper::direction_at(std::size_t place) const noexcept {
  Vector3f sum = lane_of(normals_[place / block_size], place % block_size);
  for (std::uint32_t pair = starts_[place]; pair < starts_[place + 1]; ++pair) {
    const std::uint32_t other = pairs_[pair].second;
    sum += lane_of(normals_[other / block_size], other % block_size);
  }
  const float length = sum.norm();
  return length > 0.0F ? Vector3f(sum / length) : Vector3f::Zero();
}

Vector3f VolumeKeeper::mean_round(const BoundedShape& shape, std::size_t place) const noexcept {
  Vector3f sum = Vector3f::Zero();
  for (std::uint32_t pair = starts_[place]; pair < starts_[place + 1]; ++pair)
    sum += vertex_at(shape.shape, pairs_[pair].second);
  return sum / static_cast<float>(std::max(1U, starts_[place + 1] - starts_[place]));
}

/// Calls visit(place) for the vertices that may move.
template <class Visit>
void VolumeKeeper::each_free(const Visit& visit) const {
  for (std::size_t block = 0; block < volumes_.size(); ++block) {
    if (is_free_[block] == 0) continue;
    const std::size_t end = std::min(vertices_, (block + 1) * block_size);
    for (std::size_t place = block * block_size; place < end; ++place)
      if (weights_[place] > 0.0F) visit(place);
  }
}

/// Sets moves_ to the weighted normals, and returns how much volume they add.
double VolumeKeeper::direct() noexcept {
  double rate = 0.0;
  each_free([&](std::size_t place) {
    const std::size_t lane = place % block_size;
    const Vector3f move = weights_[place] * direction_at(place);
    set_lane(moves_[place / block_size], lane, move);
    rate += static_cast<double>(move.dot(lane_of(normals_[place / block_size], lane)));
  });
  return rate;
}

/// Scales the moves, and adds a part of the way to the middle of each vertex' neighbours, which
/// keeps triangles fair where much swells.
void VolumeKeeper::scale_moves(const BoundedShape& shape, float far) noexcept {
  each_free([&](std::size_t place) {
    const Vector3f at = vertex_at(shape.shape, place);
    const bool has_ring = starts_[place + 1] > starts_[place];
    const float edge =
        has_ring ? (vertex_at(shape.shape, pairs_[starts_[place]].second) - at).norm() : 0.0F;
    const float fair = edge > 0.0F ? std::min(most_fairing, fairness * std::abs(far) / edge) : 0.0F;
    const Vector3f way = has_ring ? Vector3f(mean_round(shape, place) - at) : Vector3f::Zero();
    VertexBlock& moves = moves_[place / block_size];
    const std::size_t lane = place % block_size;
    set_lane(moves, lane, far * lane_of(moves, lane) + fair * weights_[place] * way);
  });
}

void VolumeKeeper::apply_moves(BoundedShape& shape) noexcept {
  each_free([&](std::size_t place) {
    VertexBlock& content = shape.shape.data()[place / block_size];
    const std::size_t lane = place % block_size;
    set_lane(content, lane, lane_of(content, lane) + lane_of(moves_[place / block_size], lane));
  });
  const std::uint64_t stamp = BlockShape::new_stamp();
  for (std::size_t block = 0; block < volumes_.size(); ++block) {
    if (is_free_[block] == 0) continue;
    VertexBlock& content = shape.shape.data()[block];
    const std::size_t used = std::min(block_size, vertices_ - block * block_size);
    for (std::size_t lane = used; lane < block_size; ++lane) // the padding repeats the last vertex
      set_lane(content, lane, lane_of(content, used - 1));
    shape.shape.set_stamp(block, stamp);
    shape.bounds[block] = bounds_of(content);
  }
}

double VolumeKeeper::give_back(BoundedShape& shape, ContactSearch& search, double missing,
                               const GiveBack& how) noexcept {
  weigh(shape, search, how);
  const double rate = direct();
  if (!(rate > 0.0)) return 0.0;
  const double far = std::clamp(missing / rate, -how.most, how.most);
  scale_moves(shape, static_cast<float>(far));
  apply_moves(shape);
  shape.extent += how.most;
  return far * rate;
}

} // namespace nendo::deform
