#pragma once
// Numbers the entries of a list that are used, and leaves out the others.

#include <cstdint>
#include <vector>

#include <nendo/deform/index.hpp>

namespace nendo::deform {

/// Keeps the values whose entry in `keeps` is not `dropped`. A column without values stays empty.
template <class Values, class Keeps>
void keep_values(Values& values, const Keeps& keeps, typename Keeps::value_type dropped = 0) {
  if (values.empty()) return;
  std::size_t kept = 0;
  for (std::size_t at = 0; at < keeps.size(); ++at)
    if (keeps[at] != dropped) values[kept++] = values[at];
  values.resize(kept);
}

/// Numbers entries that are used, in the order of their first use.
class FirstUses {
public:
  explicit FirstUses(std::size_t count) : numbers_(count, no_index) {}
  /// Returns the entry's number, which is a new one if it is its first use.
  std::uint32_t operator()(std::uint32_t entry) {
    if (numbers_[entry] == no_index) {
      numbers_[entry] = to_index(entries_.size());
      entries_.push_back(entry);
    }
    return numbers_[entry];
  }
  bool has(std::uint32_t entry) const noexcept { return numbers_[entry] != no_index; }
  /// Returns the entries that were used, by their numbers.
  const std::vector<std::uint32_t>& entries() const noexcept { return entries_; }
  void clear() noexcept {
    for (const std::uint32_t entry : entries_)
      numbers_[entry] = no_index;
    entries_.clear();
  }

private:
  std::vector<std::uint32_t> numbers_, entries_;
};

/// Numbers entries that are used, in their order.
class UsedEntries {
public:
  explicit UsedEntries(std::size_t count) : numbers_(count, no_index) {}
  void use(std::uint32_t entry) {
    if (entry != no_index) numbers_[entry] = 0;
  }
  /// Calls keep(entry) for each that is used.
  template <class Keep>
  void number(const Keep& keep) {
    std::uint32_t next = 0;
    for (std::uint32_t entry = 0; entry < numbers_.size(); ++entry) {
      if (numbers_[entry] == no_index) continue;
      numbers_[entry] = next++;
      keep(entry);
    }
  }
  std::uint32_t operator[](std::uint32_t entry) const {
    return entry == no_index ? no_index : numbers_[entry];
  }

private:
  std::vector<std::uint32_t> numbers_;
};

} // namespace nendo::deform
