#pragma once
// Makes a recording from the entries of another one.

#include <utility>
#include <vector>

#include <nendo/recording/recorded_shape.hpp>
#include <nendo/recording/take_tools.hpp>

#include "take_file.hpp"

namespace nendo::recording {

/// The new file exists only if end() succeeded.
class TakeCopy {
public:
  /// Creates the file. Error: failed (the file exists already, or cannot be created).
  static Result<TakeCopy> create(const std::filesystem::path& path, const Setup& setup);

  /// Appends an entry. Error of this and all other functions: failed.
  Result<void> put(const Entry& entry);
  /// Appends a shape after all entries so far.
  Result<void> put(const RecordedShape& shape);
  /// Writes the ending. All of it except the counts is taken from `of_original`, if given. `host`
  /// is its time.
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
