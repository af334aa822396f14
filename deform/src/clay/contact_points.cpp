#include "clay/contact_points.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace nendo::deform {

namespace {

constexpr std::size_t slots_a_point = 16;
constexpr std::size_t cells_a_point = 8;

// Cells that are 2^18 apart share their keys, but no body is that large.
constexpr int cells_a_side = 1 << 18;

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
  for (auto* numbers : {&chosen_.x, &chosen_.y, &chosen_.z, &chosen_.normal_x, &chosen_.normal_y,
                        &chosen_.normal_z})
    numbers->resize(most);
}

void ContactPoints::clear(double cell) noexcept {
  constexpr auto half = static_cast<float>(cells_a_side / 2);
  cells_ = {static_cast<float>(1.0 / cell), half, 2.0F * half - 1.0F};
  points_.clear();
  if (++round_ != 0) return;
  std::fill(slots_.begin(), slots_.end(), Slot{});
  round_ = 1;
}

ContactPoint* ContactPoints::offer(const Eigen::Vector3f& at, std::uint32_t part,
                                   double depth) noexcept {
  std::uint64_t key = part;
  for (const float coordinate : at) {
    const float cell = coordinate * cells_.a_length + cells_.shift;
    key = key << 18 | static_cast<std::uint64_t>(std::clamp(cell, 0.0F, cells_.most));
  }
  const std::size_t mask = slots_.size() - 1; // a power of two
  std::size_t slot = hash_of(key) & mask;
  while (slots_[slot].round == round_ && slots_[slot].key != key)
    slot = (slot + 1) & mask;
  if (slots_[slot].round != round_) {
    if (points_.size() == points_.capacity()) return nullptr;
    slots_[slot] = {key, round_, static_cast<std::uint32_t>(points_.size())};
    points_.emplace_back().depth = -std::numeric_limits<double>::infinity();
  }
  ContactPoint& kept = points_[slots_[slot].point];
  return depth > kept.depth ? &kept : nullptr;
}

/// All are looked at, because vectors do that faster than a search that ends early.
bool ContactPoints::is_crowded(const ContactPoint& point, std::size_t chosen,
                               float squared) const noexcept {
  const Eigen::Vector3f at = point.at.cast<float>();
  const Eigen::Vector3f normal = point.normal.cast<float>();
  std::uint32_t crowding = 0;
  for (std::size_t other = 0; other < chosen; ++other) {
    const float x = chosen_.x[other] - at.x();
    const float y = chosen_.y[other] - at.y();
    const float z = chosen_.z[other] - at.z();
    const float along = chosen_.normal_x[other] * normal.x() +
                        chosen_.normal_y[other] * normal.y() + chosen_.normal_z[other] * normal.z();
    crowding |= static_cast<std::uint32_t>(x * x + y * y + z * z < squared) &
                static_cast<std::uint32_t>(along > 0.5F);
  }
  return crowding != 0;
}

void ContactPoints::note_chosen(const ContactPoint& point, std::size_t at) noexcept {
  chosen_.x[at] = static_cast<float>(point.at.x());
  chosen_.y[at] = static_cast<float>(point.at.y());
  chosen_.z[at] = static_cast<float>(point.at.z());
  chosen_.normal_x[at] = static_cast<float>(point.normal.x());
  chosen_.normal_y[at] = static_cast<float>(point.normal.y());
  chosen_.normal_z[at] = static_cast<float>(point.normal.z());
}

std::span<const ContactPoint> ContactPoints::choose(double apart) noexcept {
  std::sort(points_.begin(), points_.end(), is_deeper);
  for (ContactPoint& point : points_) {
    const double length = point.normal.norm();
    point.normal = length > 0.0 ? Eigen::Vector3d(point.normal / length) : Eigen::Vector3d::UnitZ();
  }
  std::size_t chosen = 0;
  for (std::size_t at = 0; at < points_.size() && chosen < most_; ++at)
    if (!is_crowded(points_[at], chosen, static_cast<float>(apart * apart))) {
      note_chosen(points_[at], chosen);
      points_[chosen++] = points_[at];
    }
  return {points_.data(), chosen};
}

} // namespace nendo::deform
