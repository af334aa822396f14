// Wavefront OBJ: v with colours, vt, f, usemtl, mtllib, g and o. All else is left out: normals,
// which are computed, and lines, points and curves, which are noted.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include <nendo/base/text.hpp>
#include <nendo/deform/corner_colours.hpp>

#include "files/colour_range.hpp"
#include "files/mesh_formats.hpp"
#include "files/mtl_file.hpp"
#include "files/number_text.hpp"
#include "files/text_scanner.hpp"
#include "geometry/usable.hpp"
#include "mesh/used_entries.hpp"

namespace nendo::deform {
namespace {

/// Reads a comment "#MRGB mmrrggbb...": of each vertex in turn a mask, red, green and blue, two
/// hexadecimal digits each. Appends 0xRRGGBB for each of them to `colours`; any other comment
/// changes nothing.
void read_polypaint(std::string_view comment, std::vector<std::uint32_t>& colours) {
  constexpr std::string_view mark = "#MRGB";
  constexpr std::size_t digits = 8;
  if (!comment.starts_with(mark)) return;
  const std::string_view numbers = trimmed(comment.substr(mark.size()));
  for (std::size_t at = 0; at + digits <= numbers.size(); at += digits) {
    const char* const begin = numbers.data() + at;
    std::uint32_t number = 0;
    const auto read = std::from_chars(begin, begin + digits, number, 16);
    if (read.ec != std::errc() || read.ptr != begin + digits) return;
    colours.push_back(number & 0xFFFFFFU);
  }
}

/// Returns the colours of so many vertices, linear (Appearance). Those of which there is none are
/// white.
Eigen::Matrix4Xf colours_of_polypaint(const std::vector<std::uint32_t>& colours,
                                      Eigen::Index vertices) {
  Eigen::Matrix4Xf linear = Eigen::Matrix4Xf::Ones(4, vertices);
  const Eigen::Index painted = std::min(vertices, static_cast<Eigen::Index>(colours.size()));
  for (Eigen::Index vertex = 0; vertex < painted; ++vertex)
    for (Eigen::Index channel = 0; channel < 3; ++channel) {
      const std::uint32_t byte =
          colours[static_cast<std::size_t>(vertex)] >> (16 - 8 * channel) & 0xFFU;
      linear(channel, vertex) = linear_of(static_cast<float>(byte) / 255.0F);
    }
  return linear;
}

/// Statements of the format (Wavefront's Appendix B1) that leave polygons as they are: normals,
/// smoothing, display and the parts of curves, which curv and surf stand for.
constexpr std::string_view harmless[] = {
    "vn",     "vp",     "s",   "mg",   "lod",  "bevel",  "c_interp",   "d_interp",
    "usemap", "maplib", "deg", "bmat", "step", "cstype", "parm",       "trim",
    "hole",   "scrv",   "sp",  "end",  "con",  "ctech",  "stech",      "call",
    "csh",    "bzp",    "bsp", "cdc",  "cdp",  "res",    "shadow_obj", "trace_obj",
};

class ObjLeftOut {
public:
  /// Counts a statement that is not read. Known ones that change no polygon, such as vn and s, do
  /// not count.
  void statement(std::string_view keyword, std::size_t line) {
    if (keyword == "l")
      ++lines_;
    else if (keyword == "p")
      ++points_;
    else if (keyword == "curv" || keyword == "curv2" || keyword == "surf")
      ++curves_;
    else if (std::find(std::begin(harmless), std::end(harmless), keyword) == std::end(harmless)) {
      if (unknown_.count == 0) first_unknown_ = in_quotes(keyword);
      unknown_.add(line);
    }
  }
  void weight(double w) noexcept { weights_ += w != 1.0 ? 1 : 0; }
  /// One note for each kind.
  void add_to(std::vector<std::string>& notes) const {
    std::string what;
    const auto add = [&](std::size_t count, const char* one, const char* more) {
      if (count > 0) what += (what.empty() ? "" : ", ") + count_words(count, one, more);
    };
    add(lines_, "line of edges (l)", "lines of edges (l)");
    add(points_, "line of points (p)", "lines of points (p)");
    add(curves_, "curve or curved surface (curv, surf)", "curves and curved surfaces (curv, surf)");
    const bool is_one = lines_ + points_ + curves_ == 1;
    if (!what.empty())
      notes.push_back(what + (is_one ? " is" : " are") + " left out; only faces (f) are read");
    if (weights_ > 0)
      notes.push_back("the fourth number of " + count_words(weights_, "vertex", "vertices") +
                      " is left out, because w weights curves and not polygons");
    if (unknown_.count > 0)
      notes.push_back(count_words(unknown_.count, "line of an unknown kind is left out (",
                                  "lines of an unknown kind are left out (first ") +
                      first_unknown_ + " in line " + std::to_string(unknown_.first) + ")");
  }

private:
  std::size_t lines_ = 0, points_ = 0, curves_ = 0, weights_ = 0;
  Tally unknown_; ///< by lines
  std::string first_unknown_;
};

constexpr float no_colour = std::numeric_limits<float>::infinity(); // white, in every range

/// Names in the order in which they were first seen, and which of them holds for the next face.
class CurrentName {
public:
  void set(std::string name) {
    current_ = no_index;
    if (name.empty()) return;
    const auto next = to_index(numbers_.size());
    current_ = numbers_.emplace(std::move(name), next).first->second;
  }
  void ends_face() { names_.of_face.push_back(current_); }
  /// Leaves out names that no face has.
  FaceNames take() && {
    std::vector<const std::string*> by_number(numbers_.size());
    for (const auto& [name, number] : numbers_)
      by_number[number] = &name;
    FirstUses renumbered(by_number.size());
    for (std::uint32_t& number : names_.of_face)
      if (number != no_index) number = renumbered(number);
    for (const std::uint32_t number : renumbered.entries())
      names_.names.push_back(*by_number[number]);
    if (names_.names.empty()) names_.of_face.clear();
    return std::move(names_);
  }

private:
  std::map<std::string, std::uint32_t> numbers_;
  FaceNames names_;
  std::uint32_t current_ = no_index;
};

/// What to do if a program has counted from 0.
std::string if_from_zero(std::string_view field) {
  return to_integer(field.substr(0, field.find('/'))) == 0
             ? ", because an OBJ counts vertices from 1; add 1 to all, if they count from 0"
             : "";
}

class ObjParser {
public:
  ObjParser(std::string_view text, std::string_view name, ReadNotes& notes)
      : scanner_(text, TextScanner::Dialect::obj), name_(name), notes_(notes) {}

  Result<ObjModel> parse() {
    do {
      if (const auto done = statement(); !done) return done.error();
    } while (scanner_.next_line());
    if (const auto good = check_indices(); !good) return good.error();
    mesh_.vertices = columns_of<3>(vertices_);
    if (highest_texcoord_.place == 0)
      mesh_.corner_texcoords.clear();
    else
      set_texcoords(texcoords_, mesh_);
    finish_look();
    if (!vertices_.empty()) left_out_.add_to(notes_);
    return ObjModel{std::move(mesh_), std::move(libraries_)};
  }

private:
  Result<void> statement() {
    const std::string_view keyword = scanner_.field();
    if (keyword == "v") return vertex();
    if (keyword == "vt") return coordinates(texcoords_, 1, 2);
    if (keyword == "f" || keyword == "fo") return face();
    if (keyword == "usemtl")
      material_.set(joined_fields(scanner_));
    else if (keyword == "g")
      group_.set(joined_fields(scanner_));
    else if (keyword == "o")
      object_.set(joined_fields(scanner_));
    else if (keyword == "mtllib")
      libraries_.push_back(joined_fields(scanner_));
    else if (keyword.empty())
      read_polypaint(scanner_.rest_of_line(), painted_);
    else
      left_out_.statement(keyword, scanner_.line());
    return {};
  }
  /// Three coordinates, and after them w, three parts of a colour, or w and those. Vertices without
  /// a colour are white, if others have one.
  Result<void> vertex() {
    if (auto done = coordinates(vertices_, 3, 3); !done) return done;
    Eigen::Vector4f colour = Eigen::Vector4f::Constant(no_colour);
    std::array<double, 4> more{};
    std::size_t count = 0;
    for (; count < more.size(); ++count) {
      const auto number = to_number_of_any_program(scanner_.field());
      if (!number || !std::isfinite(*number)) break;
      more[count] = *number;
    }
    const bool has_weight = count == 1 || count == 4;
    if (has_weight) left_out_.weight(more[0]);
    if (count < 3) return {};
    for (std::size_t channel = 0; channel < 3; ++channel)
      colour[static_cast<Eigen::Index>(channel)] =
          static_cast<float>(std::clamp(more[has_weight ? channel + 1 : channel], -1e30, 1e30));
    colours_.resize(4 * (vertices_.size() / 3 - 1), no_colour);
    colours_.insert(colours_.end(), colour.begin(), colour.end());
    for (Eigen::Index channel = 0; channel < 3; ++channel)
      colour_range_.see(static_cast<double>(colour[channel]));
    return {};
  }
  /// Up to `kept` numbers; of these, those beyond `needed` may be missing and are 0.
  Result<void> coordinates(std::vector<double>& list, int needed, int kept) {
    for (int i = 0; i < kept; ++i) {
      const std::string_view field = scanner_.field();
      if (field.empty() && i < needed)
        return bad("needs " + std::to_string(needed) + " numbers, has " + std::to_string(i));
      const auto number = field.empty() ? 0.0 : to_number_of_any_program(field);
      if (!number || !is_usable(*number))
        return bad(in_quotes(field) + std::string(not_usable(field)));
      list.push_back(*number);
    }
    return {};
  }
  Result<void> face() {
    for (auto field = scanner_.field(); !field.empty(); field = scanner_.field())
      if (auto done = corner(field); !done) return done;
    mesh_.face_starts.push_back(to_index(mesh_.face_corners.size()));
    for (CurrentName* name : {&material_, &group_, &object_})
      name->ends_face();
    return {};
  }
  /// v, v/vt, v//vn or v/vt/vn.
  Result<void> corner(std::string_view field) {
    const std::size_t slash = field.find('/');
    const auto vertex = index(field.substr(0, slash), vertices_.size() / 3, highest_vertex_);
    if (!vertex) return bad(in_quotes(field) + " names no vertex" + if_from_zero(field));
    mesh_.face_corners.push_back(*vertex);
    std::string_view texcoord;
    if (slash != std::string_view::npos) {
      texcoord = field.substr(slash + 1);
      texcoord = texcoord.substr(0, texcoord.find('/'));
    }
    std::uint32_t texcoord_index = no_index;
    if (!texcoord.empty()) {
      const auto found = index(texcoord, texcoords_.size() / 2, highest_texcoord_);
      if (!found) return bad(in_quotes(field) + " names no texture coordinate");
      texcoord_index = *found;
    }
    mesh_.corner_texcoords.push_back(texcoord_index);
    return {};
  }
  /// Counted from 1, or backwards from the newest.
  std::optional<std::uint32_t> index(std::string_view field, std::size_t count,
                                     HighestIndex& highest) const {
    const auto number = to_integer(field);
    if (!number || *number == 0) return std::nullopt;
    const std::int64_t from_zero =
        *number > 0 ? *number - 1 : static_cast<std::int64_t>(count) + *number;
    if (from_zero < 0 || from_zero >= no_index) return std::nullopt;
    const auto found = static_cast<std::uint32_t>(from_zero);
    highest.note(found, scanner_.line());
    return found;
  }
  Result<void> check_indices() const {
    const auto beyond = [&](const HighestIndex& highest, std::size_t count, const char* what) {
      return bad_line(name_, highest.place,
                      std::string(what) + " " + std::to_string(highest.index + std::uint64_t{1}) +
                          " of " + std::to_string(count));
    };
    const std::size_t vertices = vertices_.size() / 3;
    const std::size_t texcoords = texcoords_.size() / 2;
    if (highest_vertex_.is_beyond(vertices))
      return beyond(highest_vertex_, vertices, "a face names vertex");
    if (highest_texcoord_.is_beyond(texcoords))
      return beyond(highest_texcoord_, texcoords, "a face names texture coordinate");
    return {};
  }
  void finish_look() {
    Appearance& look = mesh_.look;
    auto materials = std::move(material_).take();
    look.face_materials = std::move(materials.of_face);
    for (std::string& name : materials.names)
      look.materials.push_back({std::move(name), std::nullopt, no_index, true});
    look.groups = std::move(group_).take();
    look.objects = std::move(object_).take();
    if (colours_.empty() && !painted_.empty())
      look.vertex_colours = colours_of_polypaint(painted_, mesh_.vertices.cols());
    if (colours_.empty()) return;
    colours_.resize(4 * mesh_.vertex_count(), no_colour);
    for (float& channel : colours_)
      channel = linear_of(colour_range_.part_of(static_cast<double>(channel)));
    if (auto note = colour_range_.note(); !note.empty()) notes_.push_back(std::move(note));
    look.vertex_colours = columns_of<4>(colours_);
  }

  Error bad(const std::string& what) const { return bad_line(name_, scanner_.line(), what); }

  TextScanner scanner_;
  std::string_view name_;
  ReadNotes& notes_;
  ObjLeftOut left_out_;
  std::vector<double> vertices_;  ///< three numbers each
  std::vector<double> texcoords_; ///< two numbers each
  std::vector<float> colours_;    ///< the first vertices', four numbers each, as they are written
  ColourRange colour_range_;
  CurrentName material_, group_, object_;
  std::vector<std::uint32_t> painted_; ///< the first vertices' colours that ZBrush wrote
  HighestIndex highest_vertex_;
  HighestIndex highest_texcoord_;
  Mesh mesh_;
  std::vector<std::string> libraries_;
};

void append_vertices(std::string& text, const Mesh& mesh) {
  const Eigen::Matrix4Xf colours = mean_vertex_colours(mesh);
  for (Eigen::Index vertex = 0; vertex < mesh.vertices.cols(); ++vertex) {
    text += 'v';
    append_numbers(text, mesh.vertices.col(vertex));
    if (vertex < colours.cols())
      append_numbers(text, colours.col(vertex).head<3>().unaryExpr(&encoded_of).eval());
    text += '\n';
  }
}

/// Writes a line where the name of the faces changes.
class ChangingName {
public:
  ChangingName(const char* keyword, std::vector<std::string> names,
               const std::vector<std::uint32_t>& of_face)
      : keyword_(keyword), names_(std::move(names)), of_face_(of_face) {}

  void before_face(std::size_t face, std::string& text) {
    if (of_face_.empty() || of_face_[face] == current_) return;
    current_ = of_face_[face];
    text += keyword_;
    if (current_ != no_index) text += " " + names_[current_];
    text += '\n';
  }

private:
  const char* keyword_;
  std::vector<std::string> names_;
  const std::vector<std::uint32_t>& of_face_;
  std::uint32_t current_ = no_index;
};

std::vector<std::string> line_names(const FaceNames& names) {
  std::vector<std::string> lines;
  for (const std::string& name : names.names)
    lines.push_back(line_name(name));
  return lines;
}

void append_face_lines(std::string& text, const Mesh& mesh) {
  const Appearance& look = mesh.look;
  ChangingName object("o", line_names(look.objects), look.objects.of_face);
  ChangingName group("g", line_names(look.groups), look.groups.of_face);
  const bool textured = has_texture_places(mesh);
  ChangingName material("usemtl", unique_names(look.materials), look.face_materials);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    for (ChangingName* name : {&object, &group, &material})
      name->before_face(face, text);
    text += 'f';
    for (std::size_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at) {
      text += ' ';
      append_number(text, std::uint64_t{mesh.face_corners[at]} + 1);
      if (!textured) continue;
      text += '/';
      append_number(text, std::uint64_t{mesh.corner_texcoords[at]} + 1);
    }
    text += '\n';
  }
}

} // namespace

Result<ObjModel> parse_obj(std::string_view text, std::string_view name, ReadNotes& notes) {
  return ObjParser(text, name, notes).parse();
}

std::string obj_text(const Mesh& mesh, std::string_view library) {
  std::string text = "# nendo\n";
  if (!library.empty()) text += "mtllib " + std::string(library) + "\n";
  append_vertices(text, mesh);
  const Eigen::Index texcoords = has_texture_places(mesh) ? mesh.texcoords.cols() : 0;
  for (Eigen::Index texcoord = 0; texcoord < texcoords; ++texcoord) {
    text += "vt";
    append_numbers(text, mesh.texcoords.col(texcoord));
    text += '\n';
  }
  append_face_lines(text, mesh);
  return text;
}

} // namespace nendo::deform
