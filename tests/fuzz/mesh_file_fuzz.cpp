// Whatever the bytes are, parse_mesh gives an error or a mesh that can be used without another
// check.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include <nendo/deform/mesh_file.hpp>

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

bool are_below(std::span<const std::uint32_t> indices, Eigen::Index count) {
  return std::all_of(indices.begin(), indices.end(),
                     [&](std::uint32_t index) { return index < count; });
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto mesh = nendo::deform::parse_mesh(std::as_bytes(std::span(data, size)), "fuzz");
  if (!mesh) {
    const auto& message = mesh.error().message;
    require(!message.empty() && message.find('\n') == std::string::npos);
    return 0;
  }
  require(mesh->vertices.cols() > 0 && mesh->vertices.allFinite() && mesh->texcoords.allFinite());
  // Nothing takes more than a small multiple of the file.
  require(static_cast<std::size_t>(mesh->vertices.cols()) <= size);
  require(mesh->face_corners.size() <= size);
  require(are_below(mesh->face_corners, mesh->vertices.cols()));
  require(are_below(mesh->corner_texcoords, mesh->texcoords.cols()));
  require(mesh->corner_texcoords.empty() ||
          mesh->corner_texcoords.size() == mesh->face_corners.size());
  require(mesh->face_starts.front() == 0 && mesh->face_starts.back() == mesh->face_corners.size());
  for (std::size_t face = 0; face < mesh->face_count(); ++face)
    require(mesh->face_starts[face + 1] >= mesh->face_starts[face] + 3);
  require(nendo::deform::vertex_normals(*mesh).allFinite());
  return 0;
}
