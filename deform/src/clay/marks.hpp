#pragma once
// A set of numbers below a bound that is emptied in the time that its members take.

#include <cstdint>
#include <span>
#include <vector>

namespace nendo::deform {

/// After the constructor nothing allocates.
class Marks {
public:
  explicit Marks(std::size_t bound) : is_in_(bound, 0) { members_.reserve(bound); }

  bool has(std::uint32_t number) const noexcept { return is_in_[number] != 0; }
  /// Returns whether it is new.
  bool add(std::uint32_t number) noexcept {
    if (has(number)) return false;
    is_in_[number] = 1;
    members_.push_back(number);
    return true;
  }
  void clear() noexcept {
    for (const std::uint32_t number : members_)
      is_in_[number] = 0;
    members_.clear();
  }
  /// In the order in which they came.
  std::span<const std::uint32_t> members() const noexcept { return members_; }

private:
  std::vector<std::uint8_t> is_in_;
  std::vector<std::uint32_t> members_;
};

} // namespace nendo::deform
