#pragma once
// Items in rows, one row a key: a counting sort.

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace nendo::deform {

/// Row `key` has the items from starts[key] to starts[key + 1], in the order in which they came.
template <class Item>
struct RowsByKey {
  std::vector<std::uint32_t> starts; ///< narrow, because they are read often
  std::vector<Item> items;

  std::span<Item> operator[](std::size_t key) noexcept {
    return {items.data() + starts[key], starts[key + 1] - starts[key]};
  }
  std::span<const Item> operator[](std::size_t key) const noexcept {
    return {items.data() + starts[key], starts[key + 1] - starts[key]};
  }
};

/// `each(visit)` calls visit(key, item) for each item, twice the same. Keys are below `keys`, and
/// there are less than 2^32 items.
template <class Item, class Each>
RowsByKey<Item> rows_by_key(std::size_t keys, const Each& each) {
  RowsByKey<Item> rows;
  rows.starts.assign(keys + 1, 0);
  each([&](std::size_t key, const Item&) { ++rows.starts[key + 1]; });
  std::partial_sum(rows.starts.begin(), rows.starts.end(), rows.starts.begin());
  rows.items.resize(rows.starts.back());
  std::vector<std::uint32_t> next(rows.starts.begin(), rows.starts.end() - 1);
  each([&](std::size_t key, const Item& item) { rows.items[next[key]++] = item; });
  return rows;
}

} // namespace nendo::deform
