#pragma once
// A recording that is made of another one's entries.

#include <utility>
#include <vector>

#include <nendo/recording/recorded_shape.hpp>
#include <nendo/recording/take_tools.hpp>

#include "take_file.hpp"

namespace nendo::recording {

/// There is no new file unless end() went well.
class TakeCopy {
public:
  /// Error: failed (the new file is there already, or cannot be made).
  static Result<TakeCopy> create(const std::filesystem::path& path, const Setup& setup);

  /// Errors of all: failed.
  Result<void> put(const Entry& entry);
  /// Behind all entries so far.
  Result<void> put(const RecordedShape& shape);
  /// `of_original`: what its ending says beside counts.
  Result<NewTake> end(HostTime host, const std::optional<Ending>& of_original = {});

private:
  explicit TakeCopy(TakeFile file) : file_(std::move(file)) {}
  Result<void> flush();

  TakeFile file_;
  std::vector<std::byte> payload_;
  std::uint64_t entries_ = 0;
  std::uint64_t shapes_ = 0;
  Ending ending_;
};

} // namespace nendo::recording
