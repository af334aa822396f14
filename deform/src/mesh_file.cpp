#include <nendo/deform/mesh_file.hpp>

#include <new>
#include <string>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>
#include <nendo/deform/offset.hpp>

#include "gltf_document.hpp"
#include "mesh_formats.hpp"
#include "model_folder.hpp"
#include "mtl_file.hpp"
#include "obj_beside.hpp"
#include "text_scanner.hpp"
#include "usable.hpp"

namespace nendo::deform {

namespace {

Error bad_file(std::string_view name, const std::string& what) {
  return {Errc::bad_input, std::string(name) + ": " + what};
}

bool is_ply(std::string_view text) noexcept {
  return text.starts_with("ply\n") || text.starts_with("ply\r");
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
  if (source.folder != nullptr && !model->mesh.look.materials.empty())
    read_materials(*source.folder, model->libraries, model->mesh.look, notes);
  return std::move(model->mesh);
}

Result<Mesh> parse(const Source& source, ReadNotes& notes) {
  if (is_gltf(source.text)) return parse_gltf(source.text, source.name, source.folder, notes);
  if (is_ply(source.text)) return parse_ply(source.text, source.name, notes);
  return parse_obj_of(source, notes);
}

Result<ReadModel> parse_text(Source source, const ReadOptions&) {
  if (source.text.empty()) return bad_file(source.name, "is empty");
  if (source.text.size() > most_file_bytes) return bad_file(source.name, "is larger than 4 GiB");
  source.text = without_mark(source.text);
  ReadModel model;
  auto mesh = parse(source, model.notes);
  if (!mesh) return mesh.error();
  if (mesh->vertices.cols() == 0)
    return bad_file(source.name, "has no vertices, so it is no OBJ, PLY or glTF mesh");
  model.mesh = *std::move(mesh);
  return model;
}

Result<Mesh> mesh_of(Result<ReadModel> model) {
  if (!model) return model.error();
  return std::move(model->mesh);
}

Eigen::Index first_unusable_vertex(const Points& vertices) noexcept {
  Eigen::Index at = 0;
  while (at < vertices.cols() && all_usable(vertices.col(at)))
    ++at;
  return at;
}

} // namespace

Result<ReadModel> parse_model(std::span<const std::byte> bytes, std::string_view name,
                              const ReadOptions& options) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return parse_text({text, name, nullptr}, options);
}

Result<Mesh> parse_mesh(std::span<const std::byte> bytes, std::string_view name) {
  return mesh_of(parse_model(bytes, name));
}

Result<ReadModel> read_model(const std::filesystem::path& path, const ReadOptions& options) {
  try {
    const auto text = read_file(path, most_file_bytes, "mesh");
    if (!text) return text.error();
    const ModelFolder folder(target_of(path));
    const std::string name = path.string();
    return parse_text({*text, name, &folder}, options);
  } catch (const std::bad_alloc&) {
    return bad_file(path.string(), "is too large for the memory of this machine");
  }
}

Result<Mesh> read_mesh(const std::filesystem::path& path) {
  return mesh_of(read_model(path));
}

Result<void> write_mesh(const std::filesystem::path& path, const Mesh& mesh,
                        const std::filesystem::path& materials) {
  if (!mesh.offset.isZero(0.0)) {
    Mesh from_zero = mesh;
    count_from(Eigen::Vector3d::Zero(), from_zero);
    return write_mesh(path, from_zero, materials);
  }
  const std::string ending = path.extension().string();
  if (ending != ".obj" && ending != ".ply")
    return Error{Errc::usage, path.string() + ": the name must end in .obj or .ply"};
  const Eigen::Index bad = first_unusable_vertex(mesh.vertices);
  if (bad < mesh.vertices.cols())
    return Error{Errc::failed, path.string() + ": not written, vertex " + std::to_string(bad) +
                                   " is not finite or beyond 1e100"};
  if (ending == ".ply") return replace_file(path, ply_text(mesh));
  // Before the OBJ, so that it never names what is not there.
  auto library = write_materials(path, mesh.look, materials);
  if (!library) return library.error();
  return replace_file(path, obj_text(mesh, *library));
}

} // namespace nendo::deform
