#include "obj_beside.hpp"

#include <algorithm>
#include <system_error>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

#include "mtl_file.hpp"

namespace nendo::deform {

namespace {

namespace fs = std::filesystem;

std::optional<std::string> contents_of(const fs::path& path) {
  std::error_code unknown;
  if (!fs::exists(path, unknown)) return std::nullopt;
  auto contents = read_file(path, ModelFolder::most_texture_bytes, "part of a model");
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

void read_materials(const ModelFolder& folder, const std::vector<std::string>& libraries,
                    Appearance& look, std::vector<std::string>&) {
  const auto apply = [&](std::string_view named) {
    const auto name = name_in_folder(named);
    const auto text = name ? folder.read(*name, ModelFolder::most_material_bytes) : std::nullopt;
    if (text) apply_mtl(*text, look);
    return text.has_value();
  };
  constexpr std::size_t most_libraries = 64; // a hostile model could name one a line
  std::size_t left = most_libraries;
  for (const std::string& library : libraries) {
    if (left == 0) break;
    --left;
    // A name with blanks, or several names.
    if (apply(library)) continue;
    for (const std::string_view name : fields_of(library, left)) {
      apply(name);
      --left;
    }
  }
  read_textures(folder, look);
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
