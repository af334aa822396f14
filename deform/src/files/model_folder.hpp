#pragma once
// Files that a model's file names: materials and textures. A model is not trusted, so only files in
// its own folder, and in folders below that, are read.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/read_notes.hpp>

namespace nendo::deform {

/// Returns the name that a file named so by a model can have relative to the model's folder: with
/// slashes, and without `.`. Of an absolute name, and of one with `..`, it is the last part alone,
/// because exporters write the places of the machine that they ran on. Nothing if no name is left,
/// or if the name cannot be a file's.
std::optional<std::string> name_in_folder(std::string_view named);

/// What a model named, as it was found.
struct FolderFile {
  std::string name; ///< relative to the model's folder, as it is spelled there
  std::optional<std::string> contents;
  /// If there are no contents: why, and the remedy, as the end of a note that begins with the name.
  std::string lack;
};

class ModelFolder {
public:
  /// The largest material file, and the largest texture, that is read.
  static constexpr std::uint64_t max_material_bytes = std::uint64_t{16} << 20;
  static constexpr std::uint64_t max_texture_bytes = std::uint64_t{256} << 20;

  /// The folder of the model in the file `model`.
  explicit ModelFolder(const std::filesystem::path& model);

  /// Reads the file that a model names so, in any spelling of capitals and blanks. If `beside` is
  /// the name of another file of the model, names are relative to that file's folder. A name
  /// that leads out of the model's folder means the file of the same name within it. Nothing is
  /// read that is too large or no regular file, or if a link leads out of the folder. One thread at
  /// a time may call it. Blocks.
  FolderFile find(std::string_view named, std::uint64_t max_bytes,
                  std::string_view beside = {}) const;

private:
  std::optional<std::string> spelled(const std::string& name) const;
  const std::map<std::string, std::string, std::less<>>& listing(const std::string& folder) const;
  FolderFile read(const std::string& name, std::uint64_t max_bytes) const;

  std::filesystem::path folder_; ///< without links; empty if it is not known
  /// Of folders in which a name was looked for: how each file is spelled, by its folded name.
  mutable std::map<std::string, std::map<std::string, std::string, std::less<>>> listings_;
};

/// Reads textures' contents, of all together at most ModelFolder::max_texture_bytes.
class TextureFiles {
public:
  /// `notes` must outlive this.
  explicit TextureFiles(NoteSum& notes) : notes_(notes) {}

  /// Gives a texture, which a file in the folder `beside` names so, the name that it has there and
  /// its contents, or notes what is missing. Blocks.
  void read(const ModelFolder& folder, Texture& texture, std::string_view named,
            std::string_view beside = {});
  /// Gives a texture the contents of a file, or notes what is missing.
  void take(FolderFile file, std::string_view named, Texture& texture);

private:
  NoteSum& notes_;
  std::uint64_t left_ = ModelFolder::max_texture_bytes;
};

/// Notes textures that are there, and not shown because no corner says where.
void note_unplaced_textures(const Mesh& mesh, NoteSum& notes);

/// Reads the mesh's textures, which the file names so, one after another. Blocks.
void read_textures(const ModelFolder& folder, const std::vector<std::string>& named, Mesh& mesh,
                   ReadNotes& notes);

} // namespace nendo::deform
