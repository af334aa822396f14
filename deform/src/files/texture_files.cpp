#include "files/texture_files.hpp"

#include <memory>
#include <utility>

namespace nendo::deform {

void TextureFiles::read(Texture& texture, std::string_view named, std::string_view beside) {
  FolderFile file = folder_.find(named, left_, beside);
  if (!file.name.empty()) texture.file = std::move(file.name);
  if (!file.contents) {
    notes_.add("texture", named, file.lack);
    return;
  }
  left_ -= file.contents->size();
  texture.contents = std::make_shared<const std::string>(*std::move(file.contents));
}

void note_unplaced_textures(const Mesh& mesh, NoteSum& notes) {
  if (!mesh.corner_texcoords.empty()) return;
  for (const Texture& texture : mesh.look.textures)
    if (texture.contents)
      notes.add("texture", texture.file,
                ": the model has no texture coordinates, so it is not shown");
}

void read_textures(const ModelFolder& folder, const std::vector<std::string>& named, Mesh& mesh,
                   ReadNotes& notes) {
  NoteSum sum;
  TextureFiles files(folder, sum);
  for (std::size_t at = 0; at < named.size(); ++at)
    files.read(mesh.look.textures[at], named[at]);
  note_unplaced_textures(mesh, sum);
  sum.append_to(notes);
}

} // namespace nendo::deform
