#pragma once
// The files beside an OBJ: its materials (base colour, texture, opacity) and their textures.

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/read_notes.hpp>

#include "files/colour_range.hpp"
#include "files/model_folder.hpp"
#include "files/text_scanner.hpp"

namespace nendo::deform {

/// Fills in a look's materials from the strings of material files: Kd (taken as linear, as Blender
/// writes it), d or Tr, and map_Kd. It never fails: a model can do without its materials, so lines
/// that make no sense are skipped.
class MtlReader {
public:
  /// The look has the materials' names. Both must outlive the reader.
  MtlReader(Appearance& look, NoteSum& notes);

  /// Reads one file's text. `file` is its name in the model's folder: textures are named from
  /// there.
  void read(std::string_view text, std::string_view file = {});
  /// Decides what needs all files: the range of colours, and what is opaque. Textures have names
  /// then, but no contents.
  void finish();
  /// Reads the textures' contents, after finish(). Blocks.
  void read_textures(const ModelFolder& folder);

private:
  struct Stated { ///< what the files say about one material
    bool described = false;
    std::optional<std::array<double, 3>> kd;
    std::optional<float> d, tr;
  };
  struct Named { ///< a texture of the files
    std::string name, file;
    auto operator<=>(const Named&) const = default;
  };

  void begin_material(const std::string& name);
  void statement(TextScanner& line);
  void add_texture(TextScanner& line);
  void settle_colour(std::size_t material);
  void settle_opacity(std::size_t material);

  Appearance& look_;
  NoteSum& notes_;
  std::map<std::string, std::size_t, std::less<>> by_name_;
  std::vector<Stated> stated_; ///< one per material
  std::map<Named, std::uint32_t> textures_;
  std::vector<Named> named_; ///< one per texture
  bool has_read_ = false;
  std::string file_;              ///< the name of the file that is read
  std::size_t first_texture_ = 0; ///< those before are not from these files
  std::size_t material_ = 0;      ///< beyond the materials: lines are of none of them
  ColourRange colours_{ColourNumbers::factors};
};

/// Makes all materials opaque if each face has one that cannot be seen, because that is no
/// modeller's intention, and notes that and materials whose faces are left out of pictures because
/// one sees through them.
void settle_hidden(Appearance& look, NoteSum& notes);

/// Returns the materials' names as an OBJ can hold them: none is empty, spans lines or has blanks
/// at its ends, and no two are alike.
std::vector<std::string> unique_names(const std::vector<Material>& materials);

/// Returns a name as a line of an OBJ can hold it; it may be empty.
std::string line_name(std::string_view name);

/// Reads what `libraries` name, as each mtllib has it, into the mesh's materials, and then their
/// textures. What is missing stays unknown, and is noted. Blocks.
void read_materials(const ModelFolder& folder, const std::vector<std::string>& libraries,
                    Mesh& mesh, ReadNotes& notes);

/// Writes the materials of the OBJ in the file `obj`, and their textures, and returns the name for
/// its mtllib; empty, and nothing is written, if there are none. `wanted` is the materials' file;
/// `obj` with another ending if it is empty. Where another program's file has that name, the name
/// gets an addition. Blocks. Error: failed.
Result<std::string> write_materials(const std::filesystem::path& obj, const Appearance& look,
                                    const std::filesystem::path& wanted);

} // namespace nendo::deform
