#pragma once
// Files that a model's file names: materials and textures. A model is not trusted, so only files in
// its own folder, and in folders below that, are read.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace nendo::deform {

/// Returns the name that a file named so by a model can have relative to the model's folder: with
/// slashes, and without `.`. Of an absolute name, and of one with `..`, it is the last part alone,
/// because exporters write the places of the machine that they ran on. Nothing if no name is left,
/// or if the name cannot be a file's.
std::optional<std::string> name_in_folder(std::string_view named);

class ModelFolder {
public:
  /// The largest material file, and the largest texture, that is read.
  static constexpr std::uint64_t most_material_bytes = std::uint64_t{16} << 20;
  static constexpr std::uint64_t most_texture_bytes = std::uint64_t{256} << 20;

  /// The folder of the model in the file `model`.
  explicit ModelFolder(const std::filesystem::path& model);

  /// Returns the contents of the file with that name_in_folder(). Nothing if there is none, if it
  /// is too large or no regular file, or if a link leads out of the folder. Blocks.
  std::optional<std::string> read(std::string_view name, std::uint64_t most_bytes) const;

private:
  std::filesystem::path folder_; ///< without links; empty if it is not known
};

} // namespace nendo::deform
