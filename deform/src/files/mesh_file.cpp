#include <nendo/deform/mesh_file.hpp>

#include <algorithm>
#include <new>

#include <nendo/base/endings.hpp>
#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>
#include <nendo/deform/corner_colours.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/offset.hpp>

#include "files/gltf_document.hpp"
#include "files/mesh_formats.hpp"
#include "files/model_folder.hpp"
#include "files/mtl_file.hpp"
#include "files/number_text.hpp"
#include "files/text_scanner.hpp"
#include "geometry/usable.hpp"
#include "mesh/columns.hpp"
#include "repair/weld.hpp"

namespace nendo::deform {
namespace {

/// Takes a corner that a face names twice in a row once only, and leaves out faces with fewer than
/// three different corners. Adds a note for each of both, if there are any. Other faces, and all
/// vertices, stay as they are.
void tidy_faces(Mesh& mesh, ReadNotes& notes) {
  Tally left_out, fixed;
  std::vector<std::uint8_t> keeps(mesh.face_corners.size(), 1);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const auto corners = mesh.corners_of(face);
    const auto own = std::span(keeps).subspan(mesh.face_starts[face], corners.size());
    if (!has_three(corners)) {
      left_out.add(face + 1);
      std::ranges::fill(own, std::uint8_t{0});
    } else if (repeats_corner(corners)) {
      fixed.add(face + 1);
      for (std::size_t at = 1; at < corners.size(); ++at)
        if (corners[at] == corners[at - 1]) own[at] = 0;
      for (std::size_t at = corners.size(); corners[--at] == corners[0];)
        own[at] = 0;
    }
  }
  if (left_out.count + fixed.count > 0) keep_corners(mesh, keeps);
  if (left_out.count > 0) notes.push_back(left_out.without_three_corners("face"));
  if (fixed.count > 0)
    notes.push_back(fixed.words("face", "names", "name") +
                    " a corner twice in a row, which is taken once");
}

bool is_ply(std::string_view text) noexcept {
  if (!text.starts_with("ply")) return false;
  const std::size_t end = text.find_first_not_of(" \t", 3);
  return end != std::string_view::npos && (text[end] == '\n' || text[end] == '\r');
}

/// What all readers are given.
struct Source {
  std::string_view text;
  std::string_view name;
  const ModelFolder* folder; ///< has the other files that the model names; null: none is read
};

Result<Mesh> parse_obj_of(const Source& source, ReadNotes& notes) {
  auto model = parse_obj(source.text, source.name, notes);
  if (!model) return model.error();
  if (source.folder != nullptr)
    read_materials(*source.folder, model->libraries, model->mesh, notes);
  return std::move(model->mesh);
}

/// Programs that write both show the texture alone, and its colours are those of the vertices.
void prefer_texture(Mesh& mesh, ReadNotes& notes) {
  Appearance& look = mesh.look;
  const bool is_textured =
      std::all_of(look.textures.begin(), look.textures.end(),
                  [](const Texture& texture) { return texture.contents != nullptr; });
  if (look.textures.empty() || !is_textured || mesh.corner_texcoords.empty() ||
      look.vertex_colours.cols() == 0)
    return;
  look.vertex_colours.resize(4, 0);
  notes.emplace_back("the colours of vertices are left out, because its texture has them");
}

Result<Mesh> parse_ply_of(const Source& source, ReadNotes& notes) {
  auto model = parse_ply(source.text, source.name, notes);
  if (!model) return model.error();
  if (source.folder != nullptr) {
    read_textures(*source.folder, model->textures, model->mesh, notes);
    prefer_texture(model->mesh, notes);
  }
  return std::move(model->mesh);
}

enum class Format { gltf, ply, stl, obj };

Format format_of(const Source& source) noexcept {
  if (is_gltf(source.text)) return Format::gltf;
  if (is_ply(source.text)) return Format::ply;
  return is_stl(source.text, source.name) ? Format::stl : Format::obj;
}

Result<Mesh> parse(const Source& source, Format format, const ReadOptions& options,
                   ReadNotes& notes) {
  switch (format) {
  case Format::gltf:
    return parse_gltf(source.text, source.name, source.folder, options, notes);
  case Format::ply:
    return parse_ply_of(source, notes);
  case Format::stl:
    return parse_stl(source.text, source.name, notes);
  case Format::obj:
    break;
  }
  return parse_obj_of(source, notes);
}

/// The first bytes of an OBJ are text. What a program left after its end may be anything.
bool is_binary(std::string_view text) noexcept {
  const std::string_view head = text.substr(0, 4096);
  const std::size_t zero = head.find('\0');
  return zero != std::string_view::npos &&
         head.find_first_not_of('\0', zero) != std::string_view::npos;
}

/// Programs write z up into STL and PLY as often as y, and no file says it. Nendo writes y up.
bool may_have_other_axis_up(Format format, std::string_view text) noexcept {
  if (format == Format::stl) return !text.starts_with(stl_mark);
  return format == Format::ply && text.substr(0, 400).find("nendo") == std::string_view::npos;
}

void lay(const Source& source, Format format, std::optional<UpAxis> up, ReadModel& model) {
  if (!up && may_have_other_axis_up(format, source.text))
    model.notes.push_back("y is taken to point up, because the file does not say which axis does; "
                          "if the model lies on its side, add --up z");
  if (up != UpAxis::z) return;
  if (format == Format::gltf)
    model.notes.push_back("--up z does not turn it, because y points up in each glTF");
  else
    lay_from_z_up(model.mesh.vertices);
}

/// A file whose faces share no vertex at all was written face by face, as each STL is. In any
/// other, what it says of vertices holds.
void weld_soup(Mesh& mesh, Format format, ReadNotes& notes) {
  if (format != Format::stl && !is_soup(mesh)) return;
  const std::size_t joined = weld_places(mesh);
  if (joined > 0 && format != Format::stl)
    notes.push_back("no two faces share a vertex, so " + std::to_string(joined) +
                    " vertices became one with another one in the same place");
}

void note_strays(const Mesh& mesh, ReadNotes& notes) {
  const std::size_t strays = stray_vertices(mesh).size();
  if (strays > 0)
    notes.push_back(count_words(strays, "vertex belongs to no face; it is kept, and does",
                                "vertices belong to no face; they are kept, and do") +
                    " not count for the model's size");
}

Result<ReadModel> parse_text(Source source, const ReadOptions& options) {
  if (source.text.empty()) return bad_file(source.name, "is empty; give the file of a model");
  if (source.text.size() > max_file_bytes) return bad_file(source.name, "is larger than 4 GiB");
  if (const auto foreign = foreign_format(source.text)) return bad_file(source.name, *foreign);
  source.text = without_mark(source.text);
  // Some programs end a text with zeros.
  if (format_of(source) == Format::obj)
    source.text = source.text.substr(0, source.text.find_last_not_of('\0') + 1);
  const Format format = format_of(source);
  if (format == Format::obj && is_binary(source.text))
    return bad_file(source.name, why_no_model(source.text));
  ReadModel model;
  auto mesh = parse(source, format, options, model.notes);
  if (!mesh) return mesh.error();
  if (mesh->vertices.cols() == 0)
    return bad_file(source.name, format == Format::obj ? why_no_model(source.text)
                                                       : "has no vertices, so there is no model");
  model.mesh = *std::move(mesh);
  if (options.weld && format != Format::gltf) weld_soup(model.mesh, format, model.notes);
  tidy_faces(model.mesh, model.notes);
  note_strays(model.mesh, model.notes);
  lay(source, format, options.up, model);
  bound_notes(model.notes);
  return model;
}

Eigen::Index first_unusable_vertex(const Points& vertices) noexcept {
  Eigen::Index at = 0;
  while (at < vertices.cols() && all_usable(vertices.col(at)))
    ++at;
  return at;
}

/// Only what has y up says that Nendo wrote it, so that a reader asks of the other.
std::string with_mark_of(UpAxis up, std::string text, std::string_view mark,
                         std::string_view mark_of_z) {
  if (up == UpAxis::z) text.replace(text.find(mark), mark.size(), mark_of_z);
  return text;
}

Result<void> write_laid(const std::filesystem::path& path, const Mesh& mesh,
                        const std::filesystem::path& materials, UpAxis up) {
  const std::string_view ending = ending_of(path.string(), mesh_endings);
  if (ending == ".ply")
    return replace_file(path, with_mark_of(up, ply_text(mesh), "comment nendo", "comment z up"));
  if (ending == ".stl") {
    auto text = stl_text(mesh);
    if (!text) return Error{text.error().code, path.string() + ": " + text.error().message};
    return replace_file(path, with_mark_of(up, *std::move(text), stl_mark, "binary STL, z is up"));
  }
  // Before the OBJ, so that it never names what is not there.
  auto library = write_materials(path, mesh.look, materials);
  if (!library) return library.error();
  return replace_file(path, obj_text(mesh, *library));
}

} // namespace

Result<ReadModel> parse_model(std::span<const std::byte> bytes, std::string_view name,
                              const ReadOptions& options) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return parse_text({text, name, nullptr}, options);
}

Result<ReadModel> read_model(const std::filesystem::path& path, const ReadOptions& options) {
  try {
    const auto text = read_file(path, max_file_bytes, "mesh");
    if (!text) return text.error();
    const ModelFolder folder(target_of(path));
    const std::string name = path.string();
    return parse_text({*text, name, &folder}, options);
  } catch (const std::bad_alloc&) {
    return bad_file(path.string(), "is too large for the memory of this machine");
  }
}

Result<Mesh> read_mesh(const std::filesystem::path& path) {
  auto model = read_model(path);
  if (!model) return model.error();
  return std::move(model->mesh);
}

std::vector<std::string> lost_in_file(const std::filesystem::path& path, const Mesh& mesh) {
  constexpr double visible = 1e-6; // of the model's size
  const bool is_stl = ends_in(path.string(), ".stl");
  std::vector<std::string> notes;
  const std::size_t seams = is_stl ? 0 : count_colour_seams(mesh);
  if (seams > 0)
    notes.push_back("OBJ and PLY have one colour for each vertex, so " +
                    count_words(seams, "vertex gets", "vertices get") +
                    " the mean of the faces' colours there");
  if (!is_stl && !ends_in(path.string(), ".ply")) return notes;
  const Appearance& look = mesh.look;
  std::string lost;
  const auto add = [&](bool has, const char* what) {
    if (has) lost += (lost.empty() ? "" : ", ") + std::string(what);
  };
  add(is_stl && max_corners(mesh) > 3,
      "faces of more than three corners (they are cut into triangles)");
  add(is_stl && look.has_colours(), "colours");
  add(!look.materials.empty(), "materials");
  add(has_texture_places(mesh), "texture coordinates");
  add(!look.groups.names.empty(), "groups");
  add(!look.objects.names.empty(), "objects");
  if (!lost.empty())
    notes.push_back(std::string(is_stl ? "an STL" : "a PLY") + " cannot keep " + lost +
                    "; an OBJ can");
  if (is_stl && rounding_in_floats(mesh) > visible)
    notes.push_back("the floats of an STL round this model, which is far from the origin for its "
                    "size; an OBJ or PLY keeps it exactly");
  return notes;
}

Result<void> write_mesh(const std::filesystem::path& path, const Mesh& mesh,
                        const std::filesystem::path& materials, UpAxis up) {
  if (!mesh.offset.isZero(0.0)) {
    Mesh from_zero = mesh;
    count_from(Eigen::Vector3d::Zero(), from_zero);
    return write_mesh(path, from_zero, materials, up);
  }
  const std::string_view ending = ending_of(path.string(), mesh_endings);
  if (ending.empty())
    return Error{Errc::usage, path.string() + ": the name must end in " + mesh_endings_text};
  const Eigen::Index bad = first_unusable_vertex(mesh.vertices);
  if (bad < mesh.vertices.cols())
    return Error{Errc::failed, path.string() + ": not written, vertex " + std::to_string(bad) +
                                   " is not finite or beyond 1e100"};
  if (up == UpAxis::z) {
    Mesh laid = mesh;
    lay_z_up(laid.vertices);
    return write_laid(path, laid, materials, up);
  }
  return write_laid(path, mesh, materials, up);
}

} // namespace nendo::deform
