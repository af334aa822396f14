#include "clay/contact_load.hpp"

#include <algorithm>

namespace nendo::deform {

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
