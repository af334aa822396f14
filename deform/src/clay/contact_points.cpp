#include "clay/contact_points.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace nendo::deform {

namespace {

constexpr std::size_t slots_a_point = 16;
constexpr std::size_t cells_a_point = 8;

/// Of a cell and a part. Cells that are 2^18 apart share their keys, but no body is that large.
std::uint64_t key_of(const ContactPoint& point, double per_cell) noexcept {
  std::uint64_t key = point.part;
  for (const double coordinate : point.at) {
    const double cell = std::clamp(std::floor(coordinate * per_cell), -1e15, 1e15);
    key = key << 18 | (static_cast<std::uint64_t>(static_cast<std::int64_t>(cell)) & 0x3ffff);
  }
  return key;
}

std::size_t hash_of(std::uint64_t key) noexcept { // the finaliser of MurmurHash3
  key ^= key >> 33;
  key *= 0xff51afd7ed558ccd;
  key ^= key >> 33;
  key *= 0xc4ceb9fe1a85ec53;
  return key ^ key >> 33;
}

bool is_deeper(const ContactPoint& a, const ContactPoint& b) noexcept {
  if (a.depth != b.depth) return a.depth > b.depth;
  return a.place != b.place ? a.place < b.place : a.part < b.part;
}

} // namespace

ContactPoints::ContactPoints(std::size_t most)
    : slots_(std::bit_ceil(slots_a_point * most)), most_(most) {
  points_.reserve(cells_a_point * most);
}

void ContactPoints::clear(double cell) noexcept {
  per_cell_ = 1.0 / cell;
  points_.clear();
  if (++round_ != 0) return;
  std::fill(slots_.begin(), slots_.end(), Slot{});
  round_ = 1;
}

void ContactPoints::offer(const ContactPoint& point) noexcept {
  const std::uint64_t key = key_of(point, per_cell_);
  std::size_t at = hash_of(key) % slots_.size();
  for (; slots_[at].round == round_; at = (at + 1) % slots_.size()) {
    if (slots_[at].key != key) continue;
    ContactPoint& kept = points_[slots_[at].point];
    if (point.depth > kept.depth) kept = point;
    return;
  }
  if (points_.size() == points_.capacity()) return;
  slots_[at] = {key, round_, static_cast<std::uint32_t>(points_.size())};
  points_.push_back(point);
}

bool ContactPoints::is_crowded(const ContactPoint& point, std::size_t chosen,
                               double apart) const noexcept {
  for (std::size_t other = 0; other < chosen; ++other)
    if ((points_[other].at - point.at).squaredNorm() < apart * apart &&
        points_[other].normal.dot(point.normal) > 0.5)
      return true;
  return false;
}

std::span<const ContactPoint> ContactPoints::choose(double apart) noexcept {
  std::sort(points_.begin(), points_.end(), is_deeper);
  std::size_t chosen = 0;
  for (std::size_t at = 0; at < points_.size() && chosen < most_; ++at)
    if (!is_crowded(points_[at], chosen, apart)) points_[chosen++] = points_[at];
  return {points_.data(), chosen};
}

} // namespace nendo::deform
