#pragma once
// Material files of OBJ: the base colour, its texture, and the opacity.

#include <string>
#include <string_view>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "model_folder.hpp"

namespace nendo::deform {

/// How material files of this program begin. Others are never replaced.
inline constexpr std::string_view mtl_mark = "# nendo\n";

/// Fills in those of the look's materials that the text describes: Kd (taken as linear, as Blender
/// writes it), d or Tr, and map_Kd. It never fails: a model can do without its materials, so lines
/// that make no sense are skipped. Textures get names, but no contents.
void apply_mtl(std::string_view text, Appearance& look);

/// Reads the textures' contents. Files that cannot be read are left out.
void read_textures(const ModelFolder& folder, Appearance& look);

/// Returns the materials as a text, under the names that unique_names() gives them.
std::string mtl_text(const Appearance& look);

/// Returns the materials' names as an OBJ can hold them: none is empty, spans lines or has blanks
/// at its ends, and no two are alike.
std::vector<std::string> unique_names(const std::vector<Material>& materials);

/// Returns a name as a line of an OBJ can hold it; it may be empty.
std::string line_name(std::string_view name);

} // namespace nendo::deform
