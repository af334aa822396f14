#include <nendo/deform/mesh_file.hpp>

#include <new>
#include <string>

#include <nendo/base/files.hpp>
#include <nendo/base/text.hpp>

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

Result<Mesh> parse_obj_in(std::string_view text, std::string_view name, const ModelFolder* folder) {
  auto model = parse_obj(text, name);
  if (!model) return model.error();
  if (folder != nullptr && !model->mesh.look.materials.empty())
    read_materials(*folder, model->libraries, model->mesh.look);
  return std::move(model->mesh);
}

/// `folder` has the other files that the model names; null: they are not read.
Result<Mesh> parse_text(std::string_view text, std::string_view name, const ModelFolder* folder) {
  if (text.empty()) return bad_file(name, "is empty");
  if (text.size() > most_file_bytes) return bad_file(name, "is larger than 4 GiB");
  text = without_mark(text);
  auto mesh = is_gltf(text)  ? parse_gltf(text, name, folder)
              : is_ply(text) ? parse_ply(text, name)
                             : parse_obj_in(text, name, folder);
  if (mesh && mesh->vertices.cols() == 0)
    return bad_file(name, "has no vertices, so it is no OBJ, PLY or glTF mesh");
  return mesh;
}

Eigen::Index first_unusable_vertex(const Points& vertices) noexcept {
  Eigen::Index at = 0;
  while (at < vertices.cols() && all_usable(vertices.col(at)))
    ++at;
  return at;
}

} // namespace

Result<Mesh> parse_mesh(std::span<const std::byte> bytes, std::string_view name) {
  return parse_text({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name, nullptr);
}

Result<Mesh> read_mesh(const std::filesystem::path& path) {
  try {
    const auto text = read_file(path, most_file_bytes, "mesh");
    if (!text) return text.error();
    const ModelFolder folder(target_of(path));
    return parse_text(*text, path.string(), &folder);
  } catch (const std::bad_alloc&) {
    return bad_file(path.string(), "is too large for the memory of this machine");
  }
}

Result<void> write_mesh(const std::filesystem::path& path, const Mesh& mesh,
                        const std::filesystem::path& materials) {
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
