// Reads STL, text and binary, and writes it.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <Eigen/Geometry>
#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>
#include <nendo/deform/triangles.hpp>

#include "files/binary_numbers.hpp"
#include "files/colour_range.hpp"
#include "files/mesh_formats.hpp"
#include "files/number_text.hpp"
#include "files/text_scanner.hpp"
#include "geometry/usable.hpp"
#include "mesh/columns.hpp"

namespace nendo::deform {
namespace {

constexpr std::size_t stl_header_bytes = 80;
constexpr std::size_t facets_offset = stl_header_bytes + 4;
constexpr std::size_t facet_bytes = 50;

bool is_word(std::string_view field, std::string_view word) noexcept {
  return field.size() == word.size() && ends_in(field, word);
}

bool is_text_stl(std::string_view text) noexcept {
  constexpr std::size_t looked_at = 4096;
  const std::string_view head = text.substr(0, looked_at);
  if (head.find('\0') != std::string_view::npos) return false;
  TextScanner words(head, TextScanner::Dialect::plain);
  const std::string_view first = words.field_on_any_line();
  if (is_word(first, "facet")) return is_word(words.field_on_any_line(), "normal");
  if (!is_word(first, "solid")) return false;
  if (text.size() > looked_at && head.find('\n') == std::string_view::npos &&
      head.find('\r') == std::string_view::npos)
    return true; // a very long name
  // The name may be anything, also several words.
  for (auto word = words.field_on_any_line(); !word.empty(); word = words.field_on_any_line())
    if (is_word(word, "facet") || is_word(word, "endsolid")) return true;
  return false;
}

std::uint32_t facet_count(std::string_view text) noexcept {
  return number_from<std::uint32_t>(text.data() + stl_header_bytes);
}

bool has_size_of_binary(std::string_view text) noexcept {
  if (text.size() < facets_offset) return false;
  return text.size() == facets_offset + facet_bytes * std::uint64_t{facet_count(text)};
}

bool looks_binary(std::string_view text) noexcept {
  return text.substr(0, facets_offset + facet_bytes).find('\0') != std::string_view::npos;
}

/// Faces that become a mesh.
struct StlFaces {
  std::vector<SpacePoint> vertices;
  Mesh mesh;
  std::size_t facets = 0;
  Tally left_out;

  void add_vertex(const SpacePoint& place) {
    mesh.face_corners.push_back(to_index(vertices.size()));
    vertices.push_back(place);
  }
  /// Returns false, and forgets the facet with its vertices, if it has fewer than three different
  /// places.
  bool end_face() {
    ++facets;
    const std::size_t begin = mesh.face_starts.back();
    if (has_three(std::span(vertices).subspan(begin))) {
      mesh.face_starts.push_back(to_index(mesh.face_corners.size()));
      return true;
    }
    left_out.add(facets);
    mesh.face_corners.resize(begin);
    vertices.resize(begin); // each corner has a vertex of its own
    return false;
  }
  void note_left_out(ReadNotes& notes) const {
    if (left_out.count > 0) notes.push_back(left_out.without_three_corners("facet"));
  }
  Mesh take() && {
    mesh.vertices = points_of(vertices);
    return std::move(mesh);
  }
};

class TextStl {
public:
  TextStl(std::string_view text, std::string_view name)
      : words_(text, TextScanner::Dialect::plain), name_(name) {}

  Result<Mesh> parse(ReadNotes& notes) {
    for (auto word = words_.field_on_any_line(); !word.empty(); word = words_.field_on_any_line())
      if (const auto done = statement(word); !done) return done.error();
    if (in_loop_) return bad("the file is cut off within a facet");
    if (faces_.mesh.face_count() == 0)
      return bad_file(name_, "is an STL without a facet; export it once more");
    note_all(notes);
    Mesh mesh = std::move(faces_).take();
    if (!objects_.names.empty()) mesh.look.objects = std::move(objects_);
    return mesh;
  }

private:
  Result<void> statement(std::string_view word) {
    if (is_word(word, "vertex")) return vertex();
    if (is_word(word, "endloop")) return facet_ends();
    if (is_word(word, "solid")) {
      solid_begins();
    } else if (is_word(word, "endsolid")) {
      joined_fields(words_);
      in_solid_ = false;
      object_ = no_index;
    } else if (is_word(word, "normal")) {
      // It is computed, because it changes.
      for (int number = 0; number < 3; ++number)
        words_.field_on_any_line();
    } else if (is_word(word, "loop")) {
      if (in_loop_) return bad("a loop begins within a loop");
      in_loop_ = true;
    } else if (!is_word(word, "facet") && !is_word(word, "outer") && !is_word(word, "endfacet")) {
      unknown_.add(words_.line());
      joined_fields(words_);
    }
    return {};
  }
  Result<void> vertex() {
    if (!in_loop_) return bad("a vertex is outside of a loop");
    SpacePoint place{};
    for (double& coordinate : place) {
      const std::string_view field = words_.field_on_any_line();
      if (field.empty()) return bad("the file is cut off within a vertex");
      const auto number = to_number_of_any_program(field);
      if (!number || !is_usable(*number))
        return bad(in_quotes(field) + std::string(not_usable(field)));
      coordinate = *number;
    }
    faces_.add_vertex(place);
    return {};
  }
  Result<void> facet_ends() {
    if (!in_loop_) return bad("endloop is outside of a loop");
    in_loop_ = false;
    if (faces_.end_face()) objects_.of_face.push_back(object_);
    return {};
  }
  void solid_begins() {
    std::string name = joined_fields(words_);
    in_solid_ = true;
    ++solids_;
    if (name.empty() && solids_ > 1) name = "solid " + std::to_string(solids_);
    object_ = no_index;
    if (name.empty()) return;
    object_ = to_index(objects_.names.size());
    objects_.names.push_back(std::move(name));
  }
  void note_all(ReadNotes& notes) const {
    faces_.note_left_out(notes);
    if (in_solid_) notes.push_back("ends without endsolid; it may be cut off");
    if (unknown_.count > 0)
      notes.push_back(
          count_words(unknown_.count, "line that no STL has is", "lines that no STL has are") +
          " left out (the first is line " + std::to_string(unknown_.first) + ")");
  }

  Error bad(const std::string& what) const { return bad_line(name_, words_.line(), what); }

  TextScanner words_;
  std::string_view name_;
  bool in_loop_ = false, in_solid_ = false;
  std::size_t solids_ = 0;
  Tally unknown_; ///< by lines
  FaceNames objects_;
  std::uint32_t object_ = no_index;
  StlFaces faces_;
};

/// The colours of facets in their last two bytes, of which each program has its own form.
class FacetColours {
public:
  /// Magics writes the colour of the whole into the header, and then red in the lowest bits.
  explicit FacetColours(std::string_view header) {
    const std::size_t at = header.find("COLOR=");
    if (at == std::string_view::npos || at + 10 > stl_header_bytes) return;
    of_all_ = Eigen::Vector4f::Ones();
    for (std::size_t channel = 0; channel < 4; ++channel) {
      const float part =
          static_cast<float>(static_cast<unsigned char>(header[at + 6 + channel])) / 255.0F;
      (*of_all_)[static_cast<Eigen::Index>(channel)] = channel < 3 ? linear_of(part) : part;
    }
  }

  void add_facet(std::uint32_t attribute, Appearance& look) {
    const bool has_own = ((attribute & 0x8000U) == 0) == of_all_.has_value();
    if (!has_own && !of_all_) left_out_ += attribute != 0 ? 1 : 0;
    const std::uint32_t key = has_own ? attribute & 0x7FFFU : whole;
    if (key == whole && !of_all_) {
      look.face_materials.push_back(no_index);
      return;
    }
    const auto next = to_index(look.materials.size());
    const auto [entry, is_new] = materials_.emplace(key, next);
    if (is_new) look.materials.push_back(material(key));
    look.face_materials.push_back(entry->second);
  }
  std::size_t left_out() const noexcept { return left_out_; }

private:
  static constexpr std::uint32_t whole = 0x8000U;

  Material material(std::uint32_t key) const {
    if (key == whole) return {"colour of all", *of_all_, no_index, true};
    Eigen::Vector4f colour = Eigen::Vector4f::Ones();
    std::string name = "colour";
    for (int channel = 0; channel < 3; ++channel) {
      const int lowest_bit = of_all_ ? 5 * channel : 10 - 5 * channel;
      const std::uint32_t part = key >> lowest_bit & 0x1FU;
      colour[channel] = linear_of(static_cast<float>(part) / 31.0F);
      name += " " + std::to_string(part);
    }
    return {std::move(name), colour, no_index, true};
  }

  std::optional<Eigen::Vector4f> of_all_;
  std::map<std::uint32_t, std::uint32_t> materials_;
  std::size_t left_out_ = 0;
};

class BinaryStl {
public:
  BinaryStl(std::string_view text, std::string_view name) : text_(text), name_(name) {}

  Result<Mesh> parse(ReadNotes& notes) {
    const auto count = count_facets(notes);
    if (!count) return count.error();
    faces_.vertices.reserve(3 * *count);
    faces_.mesh.face_corners.reserve(3 * *count);
    FacetColours colours(text_.substr(0, stl_header_bytes));
    Appearance& look = faces_.mesh.look;
    for (std::size_t number = 0; number < *count; ++number) {
      const auto kept = facet(number);
      if (!kept) return kept.error();
      if (!*kept) continue;
      const std::size_t attribute = facets_offset + facet_bytes * (number + 1) - 2;
      colours.add_facet(number_from<std::uint16_t>(text_.data() + attribute), look);
    }
    if (look.materials.empty()) look.face_materials.clear();
    faces_.note_left_out(notes);
    if (colours.left_out() > 0)
      notes.push_back("attributes of " + std::to_string(colours.left_out()) +
                      " triangles, which are no colours, are left out");
    return std::move(faces_).take();
  }

private:
  Result<std::size_t> count_facets(ReadNotes& notes) const {
    if (text_.size() < facets_offset)
      return bad("is an STL that is cut off within its header; get the whole file");
    const std::size_t promised = facet_count(text_);
    const std::size_t available = (text_.size() - facets_offset) / facet_bytes;
    const bool is_unknown = promised == 0 || promised == std::numeric_limits<std::uint32_t>::max();
    if (is_unknown && available > 0) {
      notes.push_back("does not say how many triangles it has; all " + std::to_string(available) +
                      " that are there are read");
      return available;
    }
    if (promised > available)
      return bad("says that it has " + std::to_string(promised) + " triangles, and has bytes for " +
                 std::to_string(available) + "; it is cut off, or no STL: get the whole file");
    if (promised == 0) return bad("is an STL without a triangle");
    const std::size_t more = text_.size() - facets_offset - facet_bytes * promised;
    if (more > 0)
      notes.push_back(std::to_string(more) + " bytes after the last triangle are left out");
    return promised;
  }
  /// Returns false if the facet is left out.
  Result<bool> facet(std::size_t number) {
    const std::size_t begin = facets_offset + facet_bytes * number;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      SpacePoint place{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t at = begin + 12 + 12 * corner + 4 * axis; // after the normal
        place[axis] = static_cast<double>(number_from<float>(text_.data() + at));
        if (!is_usable(place[axis]))
          return bad("byte " + std::to_string(at + 1) + ": a coordinate of triangle " +
                     std::to_string(number + 1) + " is not finite");
      }
      faces_.add_vertex(place);
    }
    return faces_.end_face();
  }

  Error bad(const std::string& what) const { return bad_file(name_, what); }

  std::string_view text_;
  std::string_view name_;
  StlFaces faces_;
};

void append_floats(std::string& text, const Eigen::Vector3d& numbers) {
  for (const double number : numbers)
    append_little_endian(text, static_cast<float>(number));
}

/// Of unit length; 0 if the triangle has no area.
Eigen::Vector3d unit_normal(const Eigen::Vector3d& along, const Eigen::Vector3d& across) {
  const double size = std::max(along.stableNorm(), across.stableNorm());
  if (!(size > 0.0)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d normal = (along / size).cross(across / size);
  const double length = normal.stableNorm();
  if (!(length > 0.0)) return Eigen::Vector3d::Zero();
  return normal / length;
}

} // namespace

bool is_stl(std::string_view text, std::string_view name) noexcept {
  return has_size_of_binary(text) || is_text_stl(text) ||
         (ends_in(name, ".stl") && looks_binary(text));
}

Result<Mesh> parse_stl(std::string_view text, std::string_view name, ReadNotes& notes) {
  if (!has_size_of_binary(text) && is_text_stl(text)) return TextStl(text, name).parse(notes);
  return BinaryStl(text, name).parse(notes);
}

Result<std::string> stl_text(const Mesh& mesh) {
  std::string text(stl_mark);
  text.resize(facets_offset);
  std::uint64_t count = 0;
  for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& triangle) {
    const auto corner = [&](int which) -> Eigen::Vector3d {
      // As they are written, so that what is read again has the same normals.
      return mesh.vertices.col(triangle[static_cast<std::size_t>(which)])
          .cast<float>()
          .cast<double>();
    };
    append_floats(text, unit_normal(corner(1) - corner(0), corner(2) - corner(0)));
    for (int which = 0; which < 3; ++which)
      append_floats(text, corner(which));
    append_little_endian(text, std::uint16_t{0});
    ++count;
  });
  if (!std::isfinite(rounding_in_floats(mesh)))
    return Error{Errc::failed, "is too large for the floats of an STL; scale it down"};
  if (count > std::numeric_limits<std::uint32_t>::max())
    return Error{Errc::failed, "has more triangles than an STL can count"};
  std::string counted;
  append_little_endian(counted, static_cast<std::uint32_t>(count));
  std::copy(counted.begin(), counted.end(), text.begin() + stl_header_bytes);
  return text;
}

double rounding_in_floats(const Mesh& mesh) noexcept {
  const double size = diagonal_of(mesh.vertices);
  if (!(size > 0.0)) return 0.0;
  double farthest = 0.0;
  for (Eigen::Index vertex = 0; vertex < mesh.vertices.cols(); ++vertex)
    for (const double coordinate : Eigen::Vector3d(mesh.vertices.col(vertex) + mesh.offset))
      farthest = std::max(
          farthest, std::abs(static_cast<double>(static_cast<float>(coordinate)) - coordinate));
  return farthest / size;
}

} // namespace nendo::deform
