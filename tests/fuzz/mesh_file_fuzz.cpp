// Whatever the bytes are, parse_model gives an error or a mesh that can be used without another
// check.

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/repair.hpp>

#include "files/mtl_file.hpp"
#include "laws.hpp"

namespace {

bool are_below(std::span<const std::uint32_t> indices, Eigen::Index count) {
  return std::all_of(indices.begin(), indices.end(),
                     [&](std::uint32_t index) { return index < count; });
}

bool are_below_or_none(std::span<const std::uint32_t> indices, std::size_t count) {
  return std::all_of(indices.begin(), indices.end(), [&](std::uint32_t index) {
    return index < count || index == nendo::deform::no_index;
  });
}

void require_usable(const nendo::deform::Appearance& look, std::size_t faces,
                    Eigen::Index vertices) {
  for (const auto* of_face : {&look.face_materials, &look.groups.of_face, &look.objects.of_face})
    require(of_face->empty() || of_face->size() == faces);
  require(are_below_or_none(look.face_materials, look.materials.size()));
  require(are_below_or_none(look.groups.of_face, look.groups.names.size()));
  require(are_below_or_none(look.objects.of_face, look.objects.names.size()));
  require(look.vertex_colours.cols() == 0 || look.vertex_colours.cols() == vertices);
  require(look.vertex_colours.allFinite());
  require(look.texcoord_colours.allFinite());
  require(look.texcoord_colours.cols() == 0 || look.vertex_colours.cols() == 0);
  for (const auto& material : look.materials) {
    require(!material.colour || material.colour->allFinite());
    require(material.texture == nendo::deform::no_index || material.texture < look.textures.size());
  }
}

/// A file of materials is never refused, so all of them must be usable.
void read_as_materials(std::string_view text) {
  nendo::deform::Appearance look;
  look.materials = {{"skin", {}, nendo::deform::no_index, true},
                    {"a", {}, nendo::deform::no_index, true}};
  nendo::deform::NoteSum notes;
  nendo::deform::MtlReader reader(look, notes);
  reader.read(text, "maps/skin.mtl");
  reader.finish();
  require_usable(look, 0, 0);
  for (const auto& texture : look.textures)
    require(nendo::deform::name_in_folder(texture.file) == texture.file);
}

void read_as_model(std::span<const std::byte> bytes, std::string_view name) {
  const nendo::deform::ReadOptions options{nendo::deform::UpAxis::z, true};
  const auto model = nendo::deform::parse_model(bytes, name, options);
  if (!model) {
    require_one_line(model.error(), "");
    return;
  }
  for (const std::string& note : model->notes)
    require(!note.empty() && note.find('\n') == std::string::npos);
  const nendo::deform::Mesh& mesh = model->mesh;
  require(mesh.vertices.cols() > 0 && mesh.vertices.allFinite() && mesh.texcoords.allFinite());
  // Nothing takes more than a small multiple of the file, but where a glTF shows a mesh in many
  // places. A corner of a strip makes a triangle.
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const bool repeats = text.find("\"nodes\"") != std::string_view::npos;
  require(repeats || static_cast<std::size_t>(mesh.vertices.cols()) <= bytes.size());
  require(repeats || mesh.face_corners.size() <= 3 * bytes.size());
  require(are_below(mesh.face_corners, mesh.vertices.cols()));
  require(are_below(mesh.corner_texcoords, mesh.texcoords.cols()));
  require(mesh.corner_texcoords.empty() ||
          mesh.corner_texcoords.size() == mesh.face_corners.size());
  require(mesh.face_starts.front() == 0 && mesh.face_starts.back() == mesh.face_corners.size());
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    require(mesh.face_starts[face + 1] >= mesh.face_starts[face] + 3);
  require_usable(mesh.look, mesh.face_count(), mesh.vertices.cols());
  const Eigen::Index colours = mesh.look.texcoord_colours.cols();
  require(colours == 0 || colours == mesh.texcoords.cols());
  require(nendo::deform::vertex_normals(mesh).allFinite());
  if (mesh.face_corners.size() > 3000) return;
  if (const auto repaired = nendo::deform::repair(mesh))
    require(bool(nendo::deform::check_closed_manifold(repaired->mesh)));
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read_as_materials({reinterpret_cast<const char*>(data), size});
  // What is binary and ends in .stl is taken as an STL, whatever its size.
  for (const std::string_view name : {"fuzz", "fuzz.stl"})
    read_as_model(std::as_bytes(std::span(data, size)), name);
  return 0;
}
