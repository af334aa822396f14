#include "cut/cut_assembly.hpp"

#include <algorithm>

#include "geometry/rows_by_key.hpp"
#include "geometry/union_find.hpp"
#include "mesh/columns.hpp"

namespace nendo::deform {
namespace {

/// Appends faces with all that belongs to them.
class FaceWriter {
public:
  FaceWriter(const Mesh& from, Mesh& to) : from_(from), to_(to) {
    const std::size_t faces = from.face_count() + from.face_count() / 4;
    to.face_starts.reserve(faces + 1);
    to.face_corners.reserve(3 * faces);
    // The cut faces have a material even if no other face has one.
    to.look.face_materials.reserve(faces);
  }
  bool has_texcoords() const noexcept { return !from_.corner_texcoords.empty(); }
  void corner(std::uint32_t vertex, std::uint32_t texcoord) {
    to_.face_corners.push_back(vertex);
    if (has_texcoords()) to_.corner_texcoords.push_back(texcoord);
  }
  /// Ends a face that is a part of this one.
  void end_part_of(std::size_t face) {
    end_face(from_, face, to_);
    if (from_.look.face_materials.empty()) to_.look.face_materials.push_back(no_index);
  }
  /// Ends a face of the cut.
  void end(std::uint32_t material, std::uint32_t object) {
    to_.face_starts.push_back(to_index(to_.face_corners.size()));
    to_.look.face_materials.push_back(material);
    if (!from_.look.groups.of_face.empty()) to_.look.groups.of_face.push_back(no_index);
    if (!from_.look.objects.of_face.empty()) to_.look.objects.of_face.push_back(object);
  }
  void copy(std::size_t face) {
    for (std::uint32_t at = from_.face_starts[face]; at < from_.face_starts[face + 1]; ++at)
      append_corner(from_, at, to_);
    end_part_of(face);
  }

private:
  const Mesh& from_;
  Mesh& to_;
};

class Assembler {
public:
  Assembler(const ChosenCut& cut, CutSurface& surface)
      : cut_(cut), surface_(surface), faces_(cut.mesh, result_.mesh),
        first_added_(to_index(cut.mesh.vertex_count())) {}

  CutAssembly run() {
    number_vertices();
    write_vertices();
    write_colours();
    write_surface();
    write_cap();
    write_texcoords();
    write_look();
    return std::move(result_);
  }

private:
  void number_vertices() {
    std::uint32_t vertex = surface_.vertex_count();
    result_.added = surface_.added();
    result_.crossing_vertices.assign(surface_.crossings().size(), no_index);
    for (std::size_t at = 0; at < surface_.crossings().size(); ++at) {
      if (cut_.keeps[surface_.loop_of()[at]] == 0) continue;
      result_.crossing_vertices[at] = vertex;
      vertex += 2;
      result_.added.insert(result_.added.end(), 2, surface_.crossings()[at]);
    }
    first_inner_ = vertex;
    result_.added.insert(result_.added.end(), 2 * cut_.cap.inner.size(), {no_index, no_index, 0.0});
  }
  void write_vertices() {
    const std::size_t count = first_added_ + result_.added.size();
    Points& vertices = result_.mesh.vertices;
    vertices.resize(3, static_cast<Eigen::Index>(count));
    std::copy_n(cut_.mesh.vertices.data(), 3 * std::size_t{first_added_}, vertices.data());
    result_.mesh.offset = cut_.mesh.offset;
    double* to = vertices.data() + 3 * std::size_t{first_added_};
    const auto put = [&](const SpacePoint& point) {
      to = std::copy(point.begin(), point.end(), to);
    };
    for (std::uint32_t vertex = first_added_; vertex < surface_.vertex_count(); ++vertex)
      put(surface_.point(vertex));
    for (std::size_t at = 0; at < surface_.crossings().size(); ++at)
      if (result_.crossing_vertices[at] != no_index)
        for (int side = 0; side < 2; ++side)
          put(surface_.crossing_points()[at]);
    for (const PlanePoint& place : cut_.cap.inner) {
      const SpacePoint point = cut_.blade.lift(place, cut_.blade_offset);
      put(point);
      put(point);
    }
  }
  void write_colours() {
    const Eigen::Matrix4Xf& before = cut_.mesh.look.vertex_colours;
    if (before.cols() == 0) return;
    Eigen::Matrix4Xf& colours = result_.mesh.look.vertex_colours;
    colours.resize(4, result_.mesh.vertices.cols());
    colours.leftCols(before.cols()) = before;
    Eigen::Index at = before.cols();
    for (const CutVertex& vertex : result_.added) {
      if (vertex.from == no_index) { // white, so that the material shows
        colours.col(at++).setOnes();
        continue;
      }
      const auto part = static_cast<float>(vertex.part);
      colours.col(at) = (1.0F - part) * colours.col(vertex.from) + part * colours.col(vertex.to);
      ++at;
    }
  }
  /// Writes faces in the order of the model's, each one's pieces in its place.
  void write_surface() {
    const std::vector<Piece>& pieces = surface_.pieces();
    crossed_of_piece_.assign(pieces.size(), no_index);
    const auto of_face = rows_by_key<std::uint32_t>(cut_.mesh.face_count(), [&](const auto& visit) {
      for (std::uint32_t piece = 0; piece < pieces.size(); ++piece)
        visit(pieces[piece].face, piece);
    });
    const auto& crossed = surface_.crossed();
    for (std::uint32_t at = 0; at < crossed.size(); ++at)
      if (is_cut(crossed[at])) crossed_of_piece_[crossed[at].piece] = at;
    for (std::size_t face = 0; face < cut_.mesh.face_count(); ++face) {
      if (surface_.is_active(face))
        write_pieces(face, of_face[face]);
      else
        faces_.copy(face);
    }
    result_.first_cut_face = result_.mesh.face_count();
  }
  void write_pieces(std::size_t face, std::span<const std::uint32_t> pieces) {
    const auto is_piece_cut = [&](std::uint32_t piece) {
      return crossed_of_piece_[piece] != no_index;
    };
    if (!surface_.is_split(face) && std::ranges::none_of(pieces, is_piece_cut))
      return faces_.copy(face);
    for (const std::uint32_t number : pieces) {
      if (crossed_of_piece_[number] != no_index) {
        write_crossed(surface_.crossed()[crossed_of_piece_[number]]);
        continue;
      }
      const Piece& piece = surface_.pieces()[number];
      for (std::size_t k = 0; k < 3; ++k)
        faces_.corner(piece.vertices[k], piece.texcoords[k]);
      faces_.end_part_of(face);
    }
  }
  /// One triangle at the lone corner, two on the other side, by the shorter diagonal.
  void write_crossed(const CrossedPiece& crossed) {
    struct Corner {
      std::uint32_t vertex, texcoord;
    };
    const Piece piece = surface_.pieces()[crossed.piece];
    const std::size_t lone = crossed.lone, after = (lone + 1) % 3, before = (lone + 2) % 3;
    const bool lone_up = surface_.is_up(piece.vertices[lone]);
    const auto old = [&](std::size_t k) { return Corner{piece.vertices[k], piece.texcoords[k]}; };
    const auto made = [&](std::uint32_t crossing, std::size_t other, bool up) {
      std::uint32_t texcoord = 0;
      if (faces_.has_texcoords()) {
        const CutVertex& point = surface_.crossings()[crossing];
        const bool forward = point.from == piece.vertices[lone];
        // Vertices' numbers are of 32 bits, so these keys are not those of vertices.
        const std::uint64_t key = std::uint64_t{1} << 32 | crossing;
        texcoord = surface_.texcoord_between(key, piece.texcoords[lone], piece.texcoords[other],
                                             forward ? point.part : 1.0 - point.part);
      }
      return Corner{vertex_of(crossing, up), texcoord};
    };
    const auto write = [&](const Corner& a, const Corner& b, const Corner& c) {
      result_.cut_pieces.push_back(to_index(result_.mesh.face_count()));
      for (const Corner& corner : {a, b, c})
        faces_.corner(corner.vertex, corner.texcoord);
      faces_.end_part_of(piece.face);
    };
    write(old(lone), made(crossed.after, after, lone_up), made(crossed.before, before, lone_up));
    const Corner one = made(crossed.after, after, !lone_up);
    const Corner other = made(crossed.before, before, !lone_up);
    const auto distance = [&](std::uint32_t crossing, std::size_t corner) {
      return length_of(surface_.crossing_points()[crossing] -
                       surface_.point(piece.vertices[corner]));
    };
    if (distance(crossed.after, before) < distance(crossed.before, after)) {
      write(one, old(after), old(before));
      write(one, old(before), other);
    } else {
      write(one, old(after), other);
      write(old(after), old(before), other);
    }
    if (cap_object_ == no_index && !cut_.mesh.look.objects.of_face.empty())
      cap_object_ = cut_.mesh.look.objects.of_face[piece.face];
  }
  /// The upper side's cut faces, which face down, and then the same for the lower side.
  void write_cap() {
    const auto material = to_index(cut_.mesh.look.materials.size());
    const auto first_texcoord = static_cast<std::uint32_t>(
        static_cast<std::size_t>(cut_.mesh.texcoords.cols()) + surface_.new_texcoords().size());
    for (const bool up : {true, false})
      for (const Corners& triangle : cut_.cap.triangles) {
        const bool turned = up != cut_.faces_inwards;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t corner = triangle[turned ? 2 - k : k];
          faces_.corner(cap_vertex(corner, up), first_texcoord + corner);
        }
        faces_.end(material, cap_object_);
      }
  }
  /// The cut faces are white, so that their material shows.
  void write_texcoords() {
    if (!faces_.has_texcoords()) return;
    const auto old = static_cast<std::size_t>(cut_.mesh.texcoords.cols());
    std::vector<TexturePoint> points;
    points.reserve(old + surface_.new_texcoords().size() + surface_.crossings().size() +
                   cut_.cap.inner.size());
    for (std::size_t at = 0; at < old; ++at)
      points.push_back(texture_point_of(cut_.mesh, at));
    points.insert(points.end(), surface_.new_texcoords().begin(), surface_.new_texcoords().end());
    const auto put = [&](const PlanePoint& place) {
      TexturePoint point = white_texture_point;
      point[0] = place[0] / cut_.diagonal;
      point[1] = place[1] / cut_.diagonal;
      points.push_back(point);
    };
    for (const SpacePoint& point : surface_.crossing_points())
      put(cut_.blade.chart(point));
    for (const PlanePoint& place : cut_.cap.inner)
      put(place);
    set_texture_points(points, result_.mesh);
  }
  void write_look() {
    Appearance& look = result_.mesh.look;
    look.materials = cut_.mesh.look.materials;
    look.textures = cut_.mesh.look.textures;
    look.groups.names = cut_.mesh.look.groups.names;
    look.objects.names = cut_.mesh.look.objects.names;
    Material material;
    material.name = cut_.options.material;
    material.colour = cut_.options.colour;
    look.materials.push_back(material);
  }
  bool is_cut(const CrossedPiece& crossed) const noexcept {
    return cut_.keeps[surface_.loop_of()[crossed.after]] != 0;
  }
  std::uint32_t vertex_of(std::uint32_t crossing, bool up) const noexcept {
    return result_.crossing_vertices[crossing] + (up ? 0 : 1);
  }
  std::uint32_t cap_vertex(std::uint32_t corner, bool up) const noexcept {
    const auto crossings = to_index(surface_.crossings().size());
    return corner < crossings ? vertex_of(corner, up)
                              : first_inner_ + 2 * (corner - crossings) + (up ? 0 : 1);
  }

  const ChosenCut& cut_;
  CutSurface& surface_;
  CutAssembly result_;
  FaceWriter faces_;
  std::uint32_t first_added_;
  std::uint32_t first_inner_ = 0;
  std::vector<std::uint32_t> crossed_of_piece_; ///< no_index: the piece is not cut
  std::uint32_t cap_object_ = no_index;
};

} // namespace

CutAssembly assemble(const ChosenCut& cut, CutSurface& surface) {
  return Assembler(cut, surface).run();
}

std::uint32_t number_parts(const Mesh& mesh, std::vector<std::uint32_t>& part_of_vertex) {
  const auto count = mesh.vertex_count();
  UnionFind sets(count);
  const std::vector<std::uint8_t> used = vertices_of_faces(mesh);
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (const std::uint32_t vertex : mesh.corners_of(face))
      sets.join(mesh.corners_of(face)[0], vertex);
  part_of_vertex.assign(count, no_index);
  std::uint32_t parts = 0;
  for (std::uint32_t vertex = 0; vertex < count; ++vertex) {
    if (used[vertex] == 0) continue;
    const std::uint32_t least = sets.find(vertex);
    part_of_vertex[vertex] = least == vertex ? parts++ : part_of_vertex[least];
  }
  return parts;
}

} // namespace nendo::deform
