#include "files/face_tidying.hpp"

#include <algorithm>
#include <span>

#include "mesh/columns.hpp"

namespace nendo::deform {

namespace {

using CornerSpan = std::span<const std::uint32_t>;

CornerSpan span_of(const Mesh& mesh, std::size_t face) noexcept {
  return CornerSpan(mesh.face_corners)
      .subspan(mesh.face_starts[face], mesh.face_starts[face + 1] - mesh.face_starts[face]);
}

/// Whether a corner stands beside itself; the last stands beside the first.
bool repeats_corner(CornerSpan corners) noexcept {
  return (corners.size() > 1 && corners.front() == corners.back()) ||
         std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

bool has_three_corners(CornerSpan corners) noexcept {
  if (corners.size() < 3) return false;
  const std::uint32_t one = corners.front();
  const auto other = std::find_if(corners.begin(), corners.end(),
                                  [&](std::uint32_t corner) { return corner != one; });
  return std::any_of(other, corners.end(),
                     [&](std::uint32_t corner) { return corner != one && corner != *other; });
}

/// What happened to faces, and to which one first, counted from 1.
struct Tally {
  std::size_t count = 0;
  std::size_t first = 0;

  void note(std::size_t face) noexcept {
    if (count++ == 0) first = face + 1;
  }
  std::string faces(const char* one_does, const char* more_do) const {
    const std::string face = "face " + std::to_string(first);
    return std::to_string(count) + (count == 1 ? " face (" + face + ") " + one_does
                                               : " faces (the first is " + face + ") " + more_do);
  }
};

/// Copies what is kept of a mesh's faces to the front of their lists.
class FaceTidier {
public:
  explicit FaceTidier(Mesh& mesh) noexcept : mesh_(mesh) {}

  void tidy(std::vector<std::string>& notes);

private:
  void keep_corners(std::uint32_t begin, std::uint32_t end);
  void keep_names(std::size_t face);
  void shrink();

  Mesh& mesh_;
  std::uint32_t corners_kept_ = 0;
  std::size_t faces_kept_ = 0;
  Tally left_out_, mended_;
};

void FaceTidier::tidy(std::vector<std::string>& notes) {
  const std::size_t faces = mesh_.face_count();
  std::uint32_t begin = 0;
  for (std::size_t face = 0; face < faces; ++face) {
    const std::uint32_t end = mesh_.face_starts[face + 1];
    const CornerSpan corners = CornerSpan(mesh_.face_corners).subspan(begin, end - begin);
    if (!has_three_corners(corners)) {
      left_out_.note(face);
    } else {
      if (repeats_corner(corners)) mended_.note(face);
      keep_corners(begin, end);
      keep_names(face);
      mesh_.face_starts[++faces_kept_] = corners_kept_;
    }
    begin = end;
  }
  shrink();
  if (left_out_.count > 0)
    notes.push_back(left_out_.faces("has", "have") + " fewer than three different corners and " +
                    (left_out_.count == 1 ? "is" : "are") + " left out");
  if (mended_.count > 0)
    notes.push_back(mended_.faces("names", "name") +
                    " a corner twice in a row, which is taken once");
}

void FaceTidier::keep_corners(std::uint32_t begin, std::uint32_t end) {
  const std::uint32_t first = corners_kept_;
  const auto is_last_kept = [&](std::uint32_t vertex) {
    return corners_kept_ > first && mesh_.face_corners[corners_kept_ - 1] == vertex;
  };
  for (std::uint32_t at = begin; at < end; ++at) {
    const std::uint32_t vertex = mesh_.face_corners[at];
    if (is_last_kept(vertex)) continue;
    mesh_.face_corners[corners_kept_] = vertex;
    if (!mesh_.corner_texcoords.empty())
      mesh_.corner_texcoords[corners_kept_] = mesh_.corner_texcoords[at];
    ++corners_kept_;
  }
  while (is_last_kept(mesh_.face_corners[first]) && corners_kept_ > first + 1)
    --corners_kept_;
}

void FaceTidier::keep_names(std::size_t face) {
  for (auto* of_face : face_columns(mesh_.look))
    if (!of_face->empty()) (*of_face)[faces_kept_] = (*of_face)[face];
}

void FaceTidier::shrink() {
  mesh_.face_starts.resize(faces_kept_ + 1);
  mesh_.face_corners.resize(corners_kept_);
  if (!mesh_.corner_texcoords.empty()) mesh_.corner_texcoords.resize(corners_kept_);
  for (auto* of_face : face_columns(mesh_.look))
    if (!of_face->empty()) of_face->resize(faces_kept_);
}

} // namespace

void tidy_faces(Mesh& mesh, std::vector<std::string>& notes) {
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const CornerSpan corners = span_of(mesh, face);
    if (!repeats_corner(corners) && has_three_corners(corners)) continue;
    FaceTidier(mesh).tidy(notes);
    return;
  }
}

} // namespace nendo::deform
