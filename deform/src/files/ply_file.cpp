// The reader of PLY: the body after the header.

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <nendo/base/text.hpp>

#include "files/binary_numbers.hpp"
#include "files/colour_range.hpp"
#include "files/mesh_formats.hpp"
#include "files/number_text.hpp"
#include "files/ply_header.hpp"
#include "files/ply_look.hpp"
#include "files/text_scanner.hpp"
#include "geometry/usable.hpp"

namespace nendo::deform {
namespace {

/// The numbers of the body one by one. A double holds every PLY type exactly.
class PlyBody {
public:
  PlyBody(std::string_view text, const PlyHeader& header, std::string_view name)
      : bytes_(text.substr(header.body_offset)), offset_(header.body_offset),
        first_line_(header.body_line), name_(name), format_(header.format),
        words_(bytes_, TextScanner::Dialect::plain) {}

  /// Nothing if there is no such number; then error() says why.
  std::optional<double> number(NumberType type) {
    if (format_ == PlyFormat::ascii) {
      word_ = words_.field_on_any_line();
      return to_number_of_any_program(word_);
    }
    if (bytes_.size() - at_ < size_of(type)) return std::nullopt;
    const bool is_little = format_ == PlyFormat::little_endian;
    const double value =
        number_from(type, bytes_.data() + at_, is_little ? std::endian::little : std::endian::big);
    at_ += size_of(type);
    return value;
  }

  /// How many items of these sizes the rest could hold at the most; one digit and one blank each in
  /// ASCII.
  bool can_hold(std::uint64_t count, std::uint64_t item_bytes) const noexcept {
    if (format_ == PlyFormat::ascii) return count <= (bytes_.size() - words_.offset() + 1) / 2;
    return item_bytes == 0 || count <= (bytes_.size() - at_) / item_bytes;
  }

  /// Line or byte of the number read last; never 0.
  std::size_t place() const noexcept {
    return format_ == PlyFormat::ascii ? first_line_ + words_.line() - 1 : offset_ + at_;
  }
  Error error_at(std::size_t place, const std::string& what) const {
    if (format_ == PlyFormat::ascii) return bad_line(name_, place, what);
    return bad_file(name_, "byte " + std::to_string(place) + ": " + what);
  }
  Error bad(const std::string& what) const { return error_at(place(), what); }
  Error no_number() const {
    return bad(word_.empty() ? "the file is cut off" : in_quotes(word_) + " is not a number");
  }

private:
  std::string_view bytes_;
  std::size_t offset_;
  std::size_t first_line_;
  std::string_view name_;
  PlyFormat format_;
  TextScanner words_;
  std::string_view word_; ///< ASCII: the one read last
  std::size_t at_ = 0;    ///< binary
};

/// A strip of triangles, corner by corner.
class TriangleStrip {
public:
  void reset() noexcept { count_ = 0; }
  /// Returns the triangle that this corner completes, unless it has a corner twice.
  std::optional<std::array<std::uint32_t, 3>> add(std::uint32_t corner) noexcept {
    const std::array<std::uint32_t, 3> triangle{count_ % 2 == 0 ? before_[0] : before_[1],
                                                count_ % 2 == 0 ? before_[1] : before_[0], corner};
    const bool is_one = count_ >= 2 && triangle[0] != triangle[1] && triangle[1] != triangle[2] &&
                        triangle[2] != triangle[0];
    before_ = {before_[1], corner};
    ++count_;
    return is_one ? std::optional(triangle) : std::nullopt;
  }

private:
  std::array<std::uint32_t, 2> before_{};
  std::size_t count_ = 0;
};

/// What a value is used for.
enum class Use {
  skip,
  x,
  y,
  z,
  corners,
  strips,
  red,
  green,
  blue,
  alpha,
  across, ///< texture coordinates
  up,
  texcoords, ///< texture coordinates of a face's corners
  texture    ///< its number
};

bool is_channel(Use use) noexcept {
  return use >= Use::red && use <= Use::alpha;
}

/// Red, green, blue and opacity, by the names that programs give them.
using ColourNames = std::array<std::string_view, 4>;
constexpr std::array<ColourNames, 4> known_colours{
    {{"red", "green", "blue", "alpha"},
     {"diffuse_red", "diffuse_green", "diffuse_blue", "alpha"},
     {"r", "g", "b", "a"},
     {"ambient_red", "ambient_green", "ambient_blue", "alpha"}}};

bool has_property(const PlyElement& element, std::string_view name) noexcept {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [&](const PlyProperty& property) { return property.name == name; });
}

/// The names of the colours that the element has: the first of which all three are there.
ColourNames colours_in(const PlyElement& element) noexcept {
  for (const ColourNames& names : known_colours)
    if (std::all_of(names.begin(), names.begin() + 3,
                    [&](std::string_view name) { return has_property(element, name); }))
      return names;
  return known_colours.front();
}

/// The names of the texture coordinates that the element has; empty if it has none.
std::array<std::string_view, 2> texcoords_in(const PlyElement& element) noexcept {
  for (const auto& names : ply_texcoord_names)
    if (has_property(element, names[0]) && has_property(element, names[1])) return names;
  return {};
}

/// What a property of a vertex is used for.
Use use_in_vertex(std::string_view name, const ColourNames& colours,
                  const std::array<std::string_view, 2>& texcoords) noexcept {
  constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};
  if (const auto* const axis = std::find(axes.begin(), axes.end(), name); axis != axes.end())
    return static_cast<Use>(static_cast<int>(Use::x) + static_cast<int>(axis - axes.begin()));
  if (!name.empty() && name == texcoords[0]) return Use::across;
  if (!name.empty() && name == texcoords[1]) return Use::up;
  const auto* const channel = std::find(colours.begin(), colours.end(), name);
  if (channel == colours.end()) return Use::skip;
  return static_cast<Use>(static_cast<int>(Use::red) + static_cast<int>(channel - colours.begin()));
}

bool has_once(const std::vector<Use>& uses, Use use) noexcept {
  return std::count(uses.begin(), uses.end(), use) == 1;
}

/// Whether the colours are whole, and nothing is said twice.
bool has_colours(const std::vector<Use>& uses) noexcept {
  return has_once(uses, Use::red) && has_once(uses, Use::green) && has_once(uses, Use::blue) &&
         std::count(uses.begin(), uses.end(), Use::alpha) <= 1;
}

/// What a property of a face, or of strips, is used for.
Use use_in_face(const PlyProperty& property, bool is_strips) noexcept {
  const std::string_view name = property.name;
  if (!property.count_type) return !is_strips && name == "texnumber" ? Use::texture : Use::skip;
  if (name == "vertex_indices" || name == "vertex_index")
    return is_strips ? Use::strips : Use::corners;
  return !is_strips && name == "texcoord" ? Use::texcoords : Use::skip;
}

ColourNumbers colour_numbers_of(NumberType type) noexcept {
  if (type >= NumberType::float32) return ColourNumbers::floats;
  if (size_of(type) == 4) return ColourNumbers::int32;
  return size_of(type) == 2 ? ColourNumbers::int16 : ColourNumbers::int8;
}

std::size_t channel_of(Use use) noexcept {
  return static_cast<std::size_t>(use) - static_cast<std::size_t>(Use::red);
}

/// Normals are computed, because they change.
bool is_computed(const PlyProperty& property) noexcept {
  return property.name == "nx" || property.name == "ny" || property.name == "nz";
}

class PlyParser {
public:
  PlyParser(std::string_view text, const PlyHeader& header, std::string_view name, ReadNotes& notes)
      : header_(header), name_(name), notes_(notes), body_(text, header, name) {}

  Result<PlyModel> parse() {
    for (const auto& element : header_.elements)
      if (const auto done = read_element(element); !done) return done.error();
    mesh_.vertices = columns_of<3>(coordinates_);
    const auto vertices = mesh_.vertex_count();
    if (highest_.is_beyond(vertices))
      return body_.error_at(highest_.place, "a face names vertex " +
                                                std::to_string(highest_.index) +
                                                ", counted from 0, of " + std::to_string(vertices));
    finish_colours();
    mesh_.look.vertex_colours = columns_of<4>(colours_);
    look_.finish(header_.textures, mesh_, notes_);
    return PlyModel{std::move(mesh_), header_.textures};
  }

private:
  Result<std::vector<Use>> uses_of(const PlyElement& element) const {
    std::vector<Use> uses;
    int wanted = 0;
    const bool is_strips = element.name == "tristrips";
    const ColourNames colours = colours_in(element);
    const auto texcoords = texcoords_in(element);
    for (const auto& property : element.properties) {
      Use use = Use::skip;
      if (element.name == "vertex" && !property.count_type)
        use = use_in_vertex(property.name, colours, texcoords);
      else if (element.name == "face" || is_strips)
        use = use_in_face(property, is_strips);
      wanted += use != Use::skip && use < Use::red ? 1 : 0;
      uses.push_back(use);
    }
    if (element.name == "vertex" && wanted != 3)
      return bad_file(name_, "a PLY vertex needs one x, one y and one z");
    const bool is_list = element.name == "face" || is_strips;
    if (is_list && element.count > 0 && wanted != 1)
      return bad_file(name_, std::string("a PLY ") + (is_strips ? "tristrips" : "face") +
                                 " needs one list vertex_indices");
    return uses;
  }
  Result<void> read_element(const PlyElement& element) {
    const auto uses = uses_of(element);
    if (!uses) return uses.error();
    if (element.properties.empty()) return {};
    note_left_out(element, *uses);
    std::uint64_t min_bytes = 0;
    for (const auto& property : element.properties)
      min_bytes += size_of(property.count_type.value_or(property.type));
    if (!body_.can_hold(element.count, min_bytes))
      return body_.bad("the header promises " + std::to_string(element.count) + " of " +
                       in_quotes(element.name) + ", the file is too short for them");
    if (element.name == "vertex") {
      coordinates_.reserve(3 * element.count);
      has_colours_ = has_colours(*uses);
      look_.has_vertices = has_once(*uses, Use::across) && has_once(*uses, Use::up);
      for (std::size_t channel = 0; channel < 4; ++channel)
        row_[red + channel] = std::numeric_limits<double>::infinity(); // full, in every range
      for (std::size_t at = 0; at < uses->size(); ++at)
        if (is_channel((*uses)[at]))
          colour_numbers_[channel_of((*uses)[at])] = colour_numbers_of(element.properties[at].type);
    }
    if (element.name == "face") {
      look_.has_faces = has_once(*uses, Use::texcoords);
      look_.has_numbers = has_once(*uses, Use::texture);
    }
    for (std::uint64_t row = 0; row < element.count; ++row) {
      for (std::size_t i = 0; i < uses->size(); ++i) {
        const auto& property = element.properties[i];
        auto done = property.count_type ? read_list(property, (*uses)[i])
                                        : read_value(property, (*uses)[i]);
        if (!done) return done;
      }
      end_row(element);
    }
    return {};
  }
  Result<void> read_list(const PlyProperty& property, Use use) {
    const auto count = body_.number(*property.count_type);
    if (!count) return body_.no_number();
    if (!(*count >= 0.0) || *count != std::floor(*count) ||
        *count > std::numeric_limits<std::uint32_t>::max())
      return body_.bad("the length of a list is not a whole number from 0 on");
    const auto length = static_cast<std::uint64_t>(*count);
    if (!body_.can_hold(length, size_of(property.type)))
      return body_.bad("a list of " + std::to_string(length) +
                       " reaches beyond the end of the file");
    const bool is_corners = use == Use::corners || use == Use::strips;
    for (std::uint64_t i = 0; i < length; ++i) {
      if (!is_corners) {
        if (auto done = read_value(property, use); !done) return done;
        continue;
      }
      const auto index = read_index(property.type, use);
      if (!index) return index.error();
      add_corner(*index, use);
    }
    strip_.reset();
    if (use == Use::corners) mesh_.face_starts.push_back(to_index(mesh_.face_corners.size()));
    return {};
  }
  /// Nothing where a strip ends: at a negative number, which unsigned types show as their greatest.
  Result<std::optional<std::uint32_t>> read_index(NumberType type, Use use) {
    constexpr std::uint32_t greatest = std::numeric_limits<std::uint32_t>::max();
    const auto value = body_.number(type);
    if (!value) return body_.no_number();
    if (use == Use::strips && (*value < 0.0 || *value == greatest))
      return std::optional<std::uint32_t>();
    if (!(*value >= 0.0) || *value != std::floor(*value) || *value > greatest)
      return body_.bad("a vertex index is not a whole number from 0 on");
    const auto index = static_cast<std::uint32_t>(*value);
    highest_.note(index, body_.place());
    return std::optional(index);
  }
  /// Of a strip, each corner makes a triangle with the two before it. Every other one is turned
  /// over. A corner that comes twice only leads the strip elsewhere.
  void add_corner(std::optional<std::uint32_t> index, Use use) {
    if (use == Use::corners) {
      mesh_.face_corners.push_back(*index);
      return;
    }
    if (!index) {
      strip_.reset();
      return;
    }
    const auto triangle = strip_.add(*index);
    if (!triangle) return;
    mesh_.face_corners.insert(mesh_.face_corners.end(), triangle->begin(), triangle->end());
    mesh_.face_starts.push_back(to_index(mesh_.face_corners.size()));
  }
  void note_left_out(const PlyElement& element, const std::vector<Use>& uses) {
    if (element.count == 0) return;
    const std::string name = in_quotes(element.name);
    if (element.name != "vertex" && element.name != "face" && element.name != "tristrips") {
      notes_.push_back(std::to_string(element.count) + " of the element " + name + " are left out");
      return;
    }
    constexpr std::size_t max_named = 12;
    std::string names;
    std::size_t count = 0;
    for (std::size_t i = 0; i < uses.size(); ++i) {
      if (uses[i] != Use::skip || is_computed(element.properties[i])) continue;
      if (++count <= max_named)
        names += (names.empty() ? "" : ", ") + printable(element.properties[i].name.substr(0, 40));
    }
    if (count > max_named) names += ", and " + std::to_string(count - max_named) + " more";
    if (count > 0)
      notes_.push_back((count == 1 ? "the property " : "the properties ") + names + " of each " +
                       name + (count == 1 ? " is" : " are") + " left out");
  }
  Result<void> read_value(const PlyProperty& property, Use use) {
    const auto value = body_.number(property.type);
    if (!value) return body_.no_number();
    if (use == Use::texcoords) look_.add_number(*value);
    if (use >= Use::x && use <= Use::z && !is_usable(*value))
      return body_.bad("a coordinate is not finite or beyond 1e100");
    row_[static_cast<std::size_t>(use)] =
        is_channel(use) ? std::clamp(*value, -1e30, 1e30) : *value;
    return {};
  }
  double value(Use use) const noexcept { return row_[static_cast<std::size_t>(use)]; }
  void keep_vertex() {
    coordinates_.insert(coordinates_.end(), {value(Use::x), value(Use::y), value(Use::z)});
    for (std::size_t channel = 0; has_colours_ && channel < 4; ++channel)
      colours_.push_back(static_cast<float>(row_[red + channel]));
    if (look_.has_vertices) look_.add_vertex(value(Use::across), value(Use::up));
  }
  void end_row(const PlyElement& element) {
    if (element.name == "vertex") keep_vertex();
    if (element.name != "face") return;
    const std::size_t faces = mesh_.face_count();
    look_.end_face(mesh_.face_starts[faces] - mesh_.face_starts[faces - 1], value(Use::texture));
  }
  /// Makes parts of 1 of them, linear. Colours are encoded as on screens, opacity is not. Red,
  /// green and blue have one range, unless they are of different types.
  void finish_colours() {
    std::array<ColourRange, 4> ranges;
    for (std::size_t channel = 0; channel < 4; ++channel) {
      ColourRange& range = ranges[channel];
      range = ColourRange(colour_numbers_[channel]);
      for (std::size_t at = 0; at < colours_.size(); ++at) {
        const bool is_opacity = at % 4 == 3;
        if (is_opacity == (channel == 3) && colour_numbers_[at % 4] == colour_numbers_[channel])
          range.see(static_cast<double>(colours_[at]));
      }
    }
    for (std::size_t at = 0; at < colours_.size(); ++at) {
      const float part = ranges[at % 4].part_of(static_cast<double>(colours_[at]));
      colours_[at] = at % 4 == 3 ? part : linear_of(part);
    }
    if (auto note = ranges[0].note(); !note.empty()) notes_.push_back(std::move(note));
  }

  static constexpr auto red = static_cast<std::size_t>(Use::red);

  const PlyHeader& header_;
  std::string_view name_;
  ReadNotes& notes_;
  PlyBody body_;
  std::vector<double> coordinates_;
  std::array<double, static_cast<std::size_t>(Use::texture) + 1> row_{}; ///< numbers by their uses
  std::vector<float> colours_; ///< four numbers each, as they are in the file
  bool has_colours_ = false;
  std::array<ColourNumbers, 4> colour_numbers_{};
  HighestIndex highest_;
  PlyLook look_;
  TriangleStrip strip_;
  Mesh mesh_;
};

} // namespace

Result<PlyModel> parse_ply(std::string_view text, std::string_view name, ReadNotes& notes) {
  const auto header = parse_ply_header(text, name);
  if (!header) return header.error();
  return PlyParser(text, *header, name, notes).parse();
}

} // namespace nendo::deform
