#include "clay/contact_points.hpp"

#include <algorithm>
#include <bit>

namespace nendo::deform {

namespace {

constexpr float no_place = 1e18F; // its square is finite

constexpr std::size_t slots_per_point = 16;
constexpr std::size_t cells_per_point = 8;

// Cells that are 2^18 apart share their keys, but no body is that large.
constexpr int cells_per_side = 1 << 18;

std::size_t hash_of(std::uint64_t key) noexcept { // the finaliser of MurmurHash3
  key ^= key >> 33;
  key *= 0xff51afd7ed558ccd;
  key ^= key >> 33;
  key *= 0xc4ceb9fe1a85ec53;
  return key ^ key >> 33;
}

bool is_deeper(const NearVertex& a, const NearVertex& b) noexcept {
  if (a.depth != b.depth) return a.depth > b.depth;
  return a.place != b.place ? a.place < b.place : a.part < b.part;
}

} // namespace

ContactPoints::ContactPoints(std::size_t most) : slots_(std::bit_ceil(slots_per_point * most)) {
  vertices_.reserve(cells_per_point * most);
  chosen_.reserve(most);
  for (auto& row : rows_)
    row.assign((most + place_lanes - 1) / place_lanes * place_lanes, no_place);
}

void ContactPoints::clear(double cell) noexcept {
  constexpr float half = 0.5F * static_cast<float>(cells_per_side);
  cells_ = {static_cast<float>(1.0 / cell), half, 2.0F * half - 1.0F};
  vertices_.clear();
  is_chosen_ = false;
  if (++round_ != 0) return;
  std::fill(slots_.begin(), slots_.end(), Slot{});
  round_ = 1;
}

void ContactPoints::offer(const NearVertex& vertex) noexcept {
  std::uint64_t key = vertex.part;
  for (const float coordinate : vertex.at) {
    const float cell = coordinate * cells_.per_length + cells_.shift;
    key = key << 18 | static_cast<std::uint64_t>(std::clamp(cell, 0.0F, cells_.most));
  }
  const std::size_t mask = slots_.size() - 1; // a power of two
  std::size_t slot = hash_of(key) & mask;
  while (slots_[slot].round == round_ && slots_[slot].key != key)
    slot = (slot + 1) & mask;
  if (slots_[slot].round != round_) {
    if (vertices_.size() == vertices_.capacity()) return;
    slots_[slot] = {key, round_, static_cast<std::uint32_t>(vertices_.size())};
    vertices_.push_back(vertex);
    return;
  }
  NearVertex& kept = vertices_[slots_[slot].vertex];
  if (vertex.depth > kept.depth) kept = vertex;
}

bool ContactPoints::add_place(const Eigen::Vector3f& at, const Eigen::Vector3f& normal,
                              float squared) noexcept {
  const std::array<float, 6> place{at.x(), at.y(), at.z(), normal.x(), normal.y(), normal.z()};
  const PlaceRows rows{rows_[0].data(), rows_[1].data(), rows_[2].data(),
                       rows_[3].data(), rows_[4].data(), rows_[5].data()};
  if (is_crowded(rows, chosen_.size(), place, squared)) return false;
  for (std::size_t row = 0; row < place.size(); ++row)
    rows_[row][chosen_.size()] = place[row];
  return true;
}

std::span<const ContactPoint> ContactPoints::choose(double apart) noexcept {
  if (is_chosen_) return chosen_;
  is_chosen_ = true;
  std::sort(vertices_.begin(), vertices_.end(), is_deeper);
  for (auto& row : rows_)
    std::fill_n(row.begin(), chosen_.size(), no_place);
  chosen_.clear();
  for (const NearVertex& vertex : vertices_) {
    if (chosen_.size() == chosen_.capacity()) break;
    const Eigen::Vector3d at = vertex.at.cast<double>();
    const Eigen::Vector3d normal = normal_from(vertex.centre, at);
    if (!add_place(vertex.at, normal.cast<float>(), static_cast<float>(apart * apart))) continue;
    chosen_.push_back(
        {vertex.place, vertex.body, vertex.part, static_cast<double>(vertex.depth), at, normal});
  }
  return chosen_;
}

ContactLoad::ContactLoad(std::size_t blocks, double most)
    : max_(static_cast<float>(most)), rounds_(blocks, 0), pressed_(blocks * block_size, 0.0F),
      slips_(blocks * block_size, 0) {}

void ContactLoad::press(std::size_t block, const NearestLanes& nearest) noexcept {
  if (!add_loads(nearest, max_, pressed_.data() + block * block_size)) return;
  rounds_[block] = round_;
  is_any_ = true;
}

void ContactLoad::clear(std::size_t block) noexcept {
  std::fill_n(pressed_.begin() + static_cast<std::ptrdiff_t>(block * block_size), block_size, 0.0F);
  std::fill_n(slips_.begin() + static_cast<std::ptrdiff_t>(block * block_size), block_size,
              std::uint8_t{0});
  rounds_[block] = 0;
}

void ContactLoad::end_round() noexcept {
  if (is_any_ || was_any_)
    for (std::size_t block = 0; block < rounds_.size(); ++block)
      if (rounds_[block] != 0 && rounds_[block] != round_) clear(block);
  ++round_;
  was_any_ = is_any_;
  is_any_ = false;
}

void ContactLoad::clear() noexcept {
  for (std::size_t block = 0; block < rounds_.size(); ++block)
    if (rounds_[block] != 0) clear(block);
  is_any_ = was_any_ = false;
}

double ContactLoad::at(std::uint32_t place, double distance) const noexcept {
  return std::max(0.0, static_cast<double>(pressed_[place]) - std::max(distance, 0.0));
}

} // namespace nendo::deform
