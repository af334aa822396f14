#pragma once
// Sets of numbers that become one set where two of their members are joined.

#include <algorithm>
#include <cstdint>
#include <vector>

#include <nendo/deform/index.hpp>

namespace nendo::deform {

class UnionFind {
public:
  explicit UnionFind(std::size_t count) : root_(all_indices(count)) {}
  /// Makes the number a set of its own. Other members of its set must be reset before they are
  /// used.
  void reset(std::uint32_t number) noexcept { root_[number] = number; }
  /// Returns the least number of the set.
  std::uint32_t find(std::uint32_t number) noexcept {
    while (root_[number] != number) {
      root_[number] = root_[root_[number]];
      number = root_[number];
    }
    return number;
  }
  void join(std::uint32_t one, std::uint32_t other) noexcept {
    one = find(one);
    other = find(other);
    root_[std::max(one, other)] = std::min(one, other);
  }
  /// Returns of each member the number of its set, in the order of their least members.
  std::vector<std::uint32_t> numbers() {
    std::vector<std::uint32_t> numbers;
    std::uint32_t count = 0;
    for (std::uint32_t at = 0; at < root_.size(); ++at)
      numbers.push_back(find(at) == at ? count++ : numbers[find(at)]);
    return numbers;
  }

private:
  std::vector<std::uint32_t> root_;
};

} // namespace nendo::deform
