// Chooses the pieces of two surfaces that make their union or intersection.

#include "join/overlay.hpp"

#include <algorithm>
#include <map>

#include "mesh/used_entries.hpp"

namespace nendo::deform {
namespace {

/// Interpolates texture points in pieces of faces. The two faces at an edge share a new texture
/// point where they shared both old ones.
class PieceTexture {
public:
  PieceTexture(const TriangleSurface& from, std::uint32_t part, const CrossedPart& places,
               const Crossings& crossings, std::vector<TexturePoint>& points, std::uint32_t offset)
      : from_(from), part_(part), places_(places), crossings_(crossings), points_(points),
        offset_(offset) {}

  /// Of a corner of a piece of `face`.
  std::uint32_t at(std::uint32_t face, std::uint32_t number) {
    const Corners& corners = from_.faces[face];
    const Corners& texture = from_.face_texture[face];
    for (std::size_t k = 0; k < 3; ++k)
      if (corners[k] == number) return texture[k] + offset_;
    const auto crossing = number - to_index(places_.points.size());
    const Crossing& point = crossings_.points[crossing];
    const auto [found, is_new] =
        made_.try_emplace(name_of(face, crossing), to_index(points_.size()));
    if (is_new) points_.push_back(point.part == part_ ? on_edge(face, point) : within(face, point));
    return found->second;
  }

private:
  /// The crossing, and the two old texture points of its edge, or the face that it lies in.
  std::array<std::uint32_t, 3> name_of(std::uint32_t face, std::uint32_t crossing) const {
    const Crossing& point = crossings_.points[crossing];
    if (point.part != part_) return {crossing, face, no_index};
    return {crossing, texture_at(face, point.from), texture_at(face, point.to)};
  }
  std::uint32_t texture_at(std::uint32_t face, std::uint32_t corner) const {
    const Corners& corners = from_.faces[face];
    const auto k = std::find(corners.begin(), corners.end(), corner) - corners.begin();
    return from_.face_texture[face][static_cast<std::size_t>(k)];
  }
  TexturePoint on_edge(std::uint32_t face, const Crossing& point) const {
    const TexturePoint& a = from_.texture_points[texture_at(face, point.from)];
    const TexturePoint& b = from_.texture_points[texture_at(face, point.to)];
    TexturePoint mixed = a;
    for (std::size_t k = 0; k < mixed.size(); ++k)
      mixed[k] += point.along * (b[k] - a[k]);
    return mixed;
  }
  TexturePoint within(std::uint32_t face, const Crossing& point) const {
    const Corners& corner = from_.faces[face];
    const SpacePoint& a = places_.points[corner[0]];
    const SpacePoint& b = places_.points[corner[1]];
    const SpacePoint& c = places_.points[corner[2]];
    const SpacePoint area = area_vector(a, b, c);
    const double whole = dot(area, area);
    const double of_b = std::clamp(dot(area, area_vector(a, point.place, c)) / whole, 0.0, 1.0);
    const double of_c = std::clamp(dot(area, area_vector(a, b, point.place)) / whole, 0.0, 1.0);
    const Corners& texture = from_.face_texture[face];
    TexturePoint mixed = from_.texture_points[texture[0]];
    for (std::size_t k = 0; k < mixed.size(); ++k) {
      const double first = mixed[k];
      mixed[k] = first + of_b * (from_.texture_points[texture[1]][k] - first) +
                 of_c * (from_.texture_points[texture[2]][k] - first);
    }
    return mixed;
  }

  const TriangleSurface& from_;
  std::uint32_t part_;
  CrossedPart places_;
  const Crossings& crossings_;
  std::vector<TexturePoint>& points_;
  std::uint32_t offset_;
  std::map<std::array<std::uint32_t, 3>, std::uint32_t> made_;
};

class Chooser {
public:
  Chooser(const TriangleSurface& first, const TriangleSurface& second, const Overlay& overlay)
      : parts_{&first, &second}, overlay_(overlay) {}

  Chosen choose(char inside) {
    const bool has_texture = !parts_[0]->face_texture.empty();
    if (has_texture) {
      chosen_.surface.texture_points = parts_[0]->texture_points;
      chosen_.surface.texture_points.insert(chosen_.surface.texture_points.end(),
                                            parts_[1]->texture_points.begin(),
                                            parts_[1]->texture_points.end());
    }
    for (std::uint32_t part = 0; part < 2; ++part)
      add_faces(part, inside, has_texture);
    number_points();
    return std::move(chosen_);
  }

private:
  std::uint32_t first_count() const { return static_cast<std::uint32_t>(parts_[0]->points.size()); }
  std::uint32_t second_count() const {
    return static_cast<std::uint32_t>(parts_[1]->points.size());
  }
  std::uint32_t origin_of(std::uint32_t part, std::uint32_t number) const {
    if (part == 1) return number + first_count();
    return number < first_count() ? number : number + second_count();
  }
  void add_faces(std::uint32_t part, char inside, bool has_texture) {
    const PartPieces& pieces = overlay_.pieces[part];
    const CrossedPart places{part == 0 ? parts_[0]->points : overlay_.second_points,
                             parts_[part]->faces, nullptr};
    PieceTexture texture(
        *parts_[part], part, places, overlay_.crossings, chosen_.surface.texture_points,
        part == 0 ? 0 : static_cast<std::uint32_t>(parts_[0]->texture_points.size()));
    for (std::uint32_t at = 0; at < pieces.faces.size(); ++at) {
      if (overlay_.inside[part][at] != inside) continue;
      const Corners& own = pieces.faces[at];
      const std::uint32_t from = pieces.from[at];
      if (at >= pieces.whole) chosen_.made.push_back(to_index(chosen_.surface.faces.size()));
      chosen_.surface.faces.push_back(
          {origin_of(part, own[0]), origin_of(part, own[1]), origin_of(part, own[2])});
      chosen_.surface.looks.push_back(parts_[part]->looks[from]);
      chosen_.face_parts.push_back(part);
      if (has_texture)
        chosen_.surface.face_texture.push_back(
            {texture.at(from, own[0]), texture.at(from, own[1]), texture.at(from, own[2])});
    }
  }
  void number_points() {
    UsedEntries numbers(first_count() + second_count() + overlay_.crossings.points.size());
    for (const Corners& corners : chosen_.surface.faces)
      for (const std::uint32_t at : corners)
        numbers.use(at);
    numbers.number([&](std::uint32_t at) {
      chosen_.origins.push_back(at);
      add_point(at);
    });
    for (Corners& corners : chosen_.surface.faces)
      for (std::uint32_t& at : corners)
        at = numbers[at];
  }
  void add_point(std::uint32_t origin) {
    const bool has_colours = !parts_[0]->colours.empty();
    const auto add = [&](const SpacePoint& place, auto colour) {
      chosen_.surface.points.push_back(place);
      if (has_colours) chosen_.surface.colours.push_back(colour());
    };
    if (origin < first_count())
      return add(parts_[0]->points[origin], [&] { return parts_[0]->colours[origin]; });
    origin -= first_count();
    if (origin < second_count())
      return add(overlay_.second_points[origin], [&] { return parts_[1]->colours[origin]; });
    const Crossing& point = overlay_.crossings.points[origin - second_count()];
    add(point.place, [&] {
      const auto& colours = parts_[point.part]->colours;
      Colour mixed = colours[point.from];
      for (std::size_t k = 0; k < mixed.size(); ++k)
        mixed[k] += static_cast<float>(point.along) * (colours[point.to][k] - mixed[k]);
      return mixed;
    });
  }

  std::array<const TriangleSurface*, 2> parts_;
  const Overlay& overlay_;
  Chosen chosen_;
};

} // namespace

Chosen choose(const TriangleSurface& first, const TriangleSurface& second, const Overlay& overlay,
              Choice choice) {
  return Chooser(first, second, overlay).choose(choice == Choice::intersection ? 1 : 0);
}

} // namespace nendo::deform
