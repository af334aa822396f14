#pragma once
// The pictures that a model's file names as its textures.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/read_notes.hpp>

#include "files/model_folder.hpp"

namespace nendo::deform {

/// Reads textures' contents, of all together at most ModelFolder::max_texture_bytes.
class TextureFiles {
public:
  /// Both must outlive this.
  TextureFiles(const ModelFolder& folder, NoteSum& notes) : folder_(folder), notes_(notes) {}

  /// Gives a texture, which a file in the folder `beside` names so, the name that it has there and
  /// its contents, or notes what is missing. Blocks.
  void read(Texture& texture, std::string_view named, std::string_view beside = {});

private:
  const ModelFolder& folder_;
  NoteSum& notes_;
  std::uint64_t left_ = ModelFolder::max_texture_bytes;
};

/// Notes textures that are there, and not shown because no corner says where.
void note_unplaced_textures(const Mesh& mesh, NoteSum& notes);

/// Reads the mesh's textures, which the file names so, one after another. Blocks.
void read_textures(const ModelFolder& folder, const std::vector<std::string>& named, Mesh& mesh,
                   ReadNotes& notes);

} // namespace nendo::deform
