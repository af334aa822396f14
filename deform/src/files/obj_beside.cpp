#include "files/obj_beside.hpp"

#include <algorithm>
#include <system_error>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

#include "files/mtl_file.hpp"
#include "files/texture_files.hpp"

namespace nendo::deform {

namespace {

namespace fs = std::filesystem;

std::optional<std::string> contents_of(const fs::path& path) {
  std::error_code unknown;
  if (!fs::exists(path, unknown)) return std::nullopt;
  auto contents = read_file(path, ModelFolder::max_texture_bytes, "part of a model");
  if (!contents) return std::string();
  return *std::move(contents);
}

bool is_taken(const fs::path& path, std::string_view mark) {
  const auto there = contents_of(path);
  return there && !there->starts_with(mark);
}

/// Where an .mtl may be written.
fs::path material_file(const fs::path& obj, const fs::path& wanted) {
  fs::path file = wanted.empty() ? fs::path(obj).replace_extension(".mtl") : wanted;
  if (is_taken(file, mtl_mark)) file.replace_extension(".nendo.mtl");
  return file;
}

/// Writes the texture, unless it is there, and gives it the name that it has there.
Result<void> write_texture(const fs::path& obj, Texture& texture) {
  if (!texture.contents) return {};
  const fs::path folder = obj.parent_path();
  if (name_in_folder(texture.file) == texture.file &&
      contents_of(folder / texture.file) == *texture.contents)
    return {};
  std::string name = line_name(texture.file);
  std::replace(name.begin(), name.end(), '/', '_');
  std::replace(name.begin(), name.end(), '\\', '_');
  if (name.empty() || name == "." || name == "..") name = "texture";
  auto there = contents_of(folder / name);
  if (there && *there != *texture.contents) {
    name = line_name(obj.stem().string() + "-" + name);
    there = contents_of(folder / name);
  }
  for (int next = 2; there && *there != *texture.contents; ++next) {
    const fs::path plain(name);
    const auto other =
        line_name(plain.stem().string() + "-" + std::to_string(next) + plain.extension().string());
    there = contents_of(folder / other);
    if (!there || *there == *texture.contents) name = other;
  }
  texture.file = name;
  if (there) return {};
  return replace_file(folder / name, *texture.contents);
}

} // namespace

namespace {

/// Reads the files that one mtllib names: one whose name may have blanks, or several. At most
/// `left` files are tried.
void read_library(const ModelFolder& folder, std::string_view library, std::size_t& left,
                  MtlReader& reader, NoteSum& notes) {
  const auto read = [&](std::string_view named) {
    FolderFile file = folder.find(named, ModelFolder::max_material_bytes);
    if (file.contents) reader.read(*file.contents, file.name);
    --left;
    return file;
  };
  const FolderFile whole = read(library);
  if (whole.contents) return;
  std::vector<std::pair<std::string, std::string>> lacking;
  const auto names = fields_of(library, left);
  for (const std::string_view name : names)
    if (const FolderFile file = names.size() == 1 ? whole : read(name); !file.contents)
      lacking.emplace_back(name, file.lack);
  if (lacking.size() == names.size()) lacking = {{std::string(library), whole.lack}};
  for (const auto& [name, lack] : lacking)
    notes.add("file of materials", name, lack);
}

} // namespace

void read_materials(const ModelFolder& folder, const std::vector<std::string>& libraries,
                    Mesh& mesh, ReadNotes& notes) {
  NoteSum sum;
  if (mesh.look.materials.empty()) {
    for (const std::string& library : libraries)
      sum.add("file of materials", library, ": is not used, because no face has one (usemtl)");
    return sum.append_to(notes);
  }
  if (libraries.empty()) {
    for (const Material& material : mesh.look.materials)
      sum.add("material", material.name,
              ": no file of materials is named (mtllib), so it has no colour of its own");
    return sum.append_to(notes);
  }
  MtlReader reader(mesh.look, sum);
  std::size_t left = 64; // a hostile model could name one a line
  for (const std::string& library : libraries)
    if (left > 0) read_library(folder, library, left, reader, sum);
  reader.finish();
  reader.read_textures(folder);
  note_unplaced_textures(mesh, sum);
  sum.append_to(notes);
}

Result<std::string> write_materials(const fs::path& obj, const Appearance& look,
                                    const fs::path& wanted) {
  if (look.materials.empty()) return std::string();
  Appearance written;
  written.materials = look.materials;
  written.textures = look.textures;
  for (Texture& texture : written.textures)
    if (auto done = write_texture(obj, texture); !done) return done.error();
  const fs::path file = material_file(obj, wanted);
  const std::string text = mtl_text(written);
  if (contents_of(file) != text)
    if (auto done = replace_file(file, text); !done) return done.error();
  return line_name(file.filename().string());
}

} // namespace nendo::deform
