#include <nendo/deform/corner_colours.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace nendo::deform {

void move_colours_to_corners(Mesh& mesh) {
  Eigen::Matrix4Xf& colours = mesh.look.vertex_colours;
  if (colours.cols() == 0) return;
  using Pair = std::pair<std::uint32_t, std::array<float, 4>>; // texture coordinate and colour
  std::map<Pair, std::uint32_t> known;
  std::vector<Pair> pairs;
  std::vector<std::uint32_t> of_corner;
  of_corner.reserve(mesh.face_corners.size());
  const bool textured = !mesh.corner_texcoords.empty();
  for (std::size_t at = 0; at < mesh.face_corners.size(); ++at) {
    Pair pair{textured ? mesh.corner_texcoords[at] : 0, {}};
    std::copy_n(colours.col(mesh.face_corners[at]).data(), 4, pair.second.begin());
    const auto [found, is_new] = known.emplace(pair, to_index(pairs.size()));
    if (is_new) pairs.push_back(pair);
    of_corner.push_back(found->second);
  }
  const auto count = static_cast<Eigen::Index>(pairs.size());
  Eigen::Matrix2Xd texcoords = Eigen::Matrix2Xd::Zero(2, count);
  mesh.look.texcoord_colours.resize(4, count);
  for (Eigen::Index at = 0; at < count; ++at) {
    const Pair& pair = pairs[static_cast<std::size_t>(at)];
    if (textured) texcoords.col(at) = mesh.texcoords.col(pair.first);
    mesh.look.texcoord_colours.col(at) = Eigen::Map<const Eigen::Vector4f>(pair.second.data());
  }
  mesh.texcoords = std::move(texcoords);
  mesh.corner_texcoords = std::move(of_corner);
  colours.resize(4, 0);
}

Eigen::Matrix4Xf mean_vertex_colours(const Mesh& mesh) {
  if (mesh.look.texcoord_colours.cols() == 0) return mesh.look.vertex_colours;
  const Eigen::Index count = mesh.vertices.cols();
  Eigen::Matrix4Xd sums = Eigen::Matrix4Xd::Zero(4, count);
  std::vector<std::uint32_t> corners(static_cast<std::size_t>(count), 0);
  for (std::size_t at = 0; at < mesh.face_corners.size(); ++at) {
    const std::uint32_t vertex = mesh.face_corners[at];
    sums.col(vertex) += mesh.look.texcoord_colours.col(mesh.corner_texcoords[at]).cast<double>();
    ++corners[vertex];
  }
  Eigen::Matrix4Xf means = Eigen::Matrix4Xf::Ones(4, count);
  for (Eigen::Index vertex = 0; vertex < count; ++vertex)
    if (const std::uint32_t of = corners[static_cast<std::size_t>(vertex)]; of > 0)
      means.col(vertex) = (sums.col(vertex) / of).cast<float>();
  return means;
}

std::size_t count_colour_seams(const Mesh& mesh) {
  if (mesh.look.texcoord_colours.cols() == 0) return 0;
  const auto count = mesh.vertex_count();
  std::vector<std::uint32_t> first(count, no_index);
  std::vector<bool> differs(count, false);
  for (std::size_t at = 0; at < mesh.face_corners.size(); ++at) {
    const std::uint32_t vertex = mesh.face_corners[at], colour = mesh.corner_texcoords[at];
    if (first[vertex] == no_index) first[vertex] = colour;
    if (mesh.look.texcoord_colours.col(first[vertex]) != mesh.look.texcoord_colours.col(colour))
      differs[vertex] = true;
  }
  return static_cast<std::size_t>(std::count(differs.begin(), differs.end(), true));
}

bool has_texture_places(const Mesh& mesh) noexcept {
  return mesh.texcoords.cols() > 0 &&
         (mesh.look.texcoord_colours.cols() == 0 || !mesh.texcoords.isZero(0.0));
}

} // namespace nendo::deform
