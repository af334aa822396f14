#pragma once
// Names by which the programs of a machine find what one of them shares: a segment of memory, or a
// socket. A lock decides who has a name, so that what a killed program left can be replaced.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/base/api.hpp>
#include <nendo/base/unique_fd.hpp>

namespace nendo {

/// The rule that is_shared_name() checks, for messages.
inline constexpr std::string_view shared_name_rule =
    "use letters, digits, '-', '_' and '.' for the name, at most 64";
constexpr bool is_shared_name(std::string_view name) noexcept {
  constexpr std::size_t max_characters = 64;
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  };
  return !name.empty() && name.size() <= max_characters &&
         std::all_of(name.begin(), name.end(), is_allowed);
}

/// Returns the id of a group that the system knows by this name or number, or nullopt. May block,
/// as on a network.
NENDO_API std::optional<unsigned> group_named(const std::string& name);

/// Returns whether both descriptors are of the same file.
NENDO_API bool is_same_file(int one, int other) noexcept;

/// The right to a name: a locked file that only this user can open. The lock ends with the process,
/// however that ends. Does not block.
class NENDO_API NameLock {
public:
  enum class Outcome : std::uint8_t {
    taken,
    held,   ///< another program has the lock
    failed, ///< the file cannot be made; errno has the reason
  };

  /// `path` is the file's, which nothing else may use.
  explicit NameLock(std::string path) : path_(std::move(path)) {}
  ~NameLock() { release(); }
  NameLock(NameLock&& other) noexcept = default;
  NameLock& operator=(NameLock&&) = delete;

  Outcome take() noexcept;
  /// Removes the file, if the lock was taken.
  void release() noexcept;
  const std::string& path() const noexcept { return path_; }

private:
  std::string path_;
  UniqueFd file_;
};

} // namespace nendo
