#pragma once
// Writes a binary glTF 2.0 file (Khronos specification, sections 3.6 "Binary data storage" and 4
// "GLB"). Numbers are put into one buffer, with accessors that describe them. The caller fills the
// rest of the document, which is JSON.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <nendo/base/result.hpp>

namespace nendo::exporting {

class GlbFile {
public:
  using Json = nlohmann::ordered_json;
  using Index = std::size_t; ///< index of an accessor, a node, and so on

  enum class Use { vertices, indices, animation }; ///< what the numbers in a view are

  /// `max_bytes` limits the size of the file and of its numbers. A GLB file counts them in 32
  /// bits.
  explicit GlbFile(std::string_view generator,
                   std::uint64_t max_bytes = std::numeric_limits<std::uint32_t>::max());

  /// Returns a part of the JSON document. This class itself adds buffers, views and accessors.
  Json& operator[](std::string_view part) { return json_[std::string(part)]; }
  /// Appends an item to a list of the document, such as "nodes", and returns its index.
  Index add(std::string_view list, Json item);

  // Each of these adds an accessor and returns its index. There must be at least one number, and
  // all must be finite.
  /// `vectors` is 3 by #vectors. `bounded` adds their minimum and maximum, which POSITION requires.
  Index add_vectors(const Eigen::Matrix3Xf& vectors, Use use, bool bounded);
  /// Adds vectors of which most are zero, with their minimum and maximum. Uses a sparse accessor if
  /// that is smaller.
  Index add_sparse_vectors(const Eigen::Matrix3Xf& vectors);
  /// Adds items of `width` numbers: 1; vectors of 2 or 4; or matrices of 16, column by column.
  Index add_numbers(std::span<const float> numbers, std::size_t width, std::optional<Use> use);
  Index add_scalars(std::span<const float> numbers, bool bounded);
  /// Adds `count` zeros, with ones at `places`, which must increase.
  Index add_ones(std::size_t count, std::span<const std::uint32_t> places);
  /// Uses 16 bits for each index if all of them fit.
  Index add_indices(std::span<const std::uint32_t> indices, Use use);
  Index add_joints(std::span<const std::uint8_t> fours);

  /// Adds bytes that are no numbers, such as an image, and returns the index of their bufferView.
  Index add_bytes(std::string_view bytes);

  /// Writes the file atomically, replaces an existing one, and returns its size in bytes. Blocks.
  /// Errors: failed (larger than `max_bytes`, or it cannot be written).
  Result<std::uint64_t> write(const std::filesystem::path& path) const;

private:
  Index add_view(std::span<const std::byte> bytes, std::optional<Use> use);
  std::pair<Index, int> add_index_view(std::span<const std::uint32_t> indices,
                                       std::optional<Use> use);
  Index add_accessor(Index view, int component, std::size_t count, const char* type);
  Json sparse(std::span<const std::uint32_t> places, std::span<const float> values);

  std::uint64_t max_bytes_;
  Json json_;
  Json views_ = Json::array();
  Json accessors_ = Json::array();
  std::vector<std::vector<std::byte>> parts_; ///< one for each view, padded to fours
  std::uint64_t bytes_ = 0;                   ///< sum over all parts
};

} // namespace nendo::exporting
