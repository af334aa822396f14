// Wavefront OBJ: v, vt and f. All else (normals, materials, groups, lines, curves) is skipped.

#include <array>
#include <charconv>
#include <limits>
#include <optional>

#include <nendo/base/text.hpp>

#include "mesh_formats.hpp"
#include "text_scanner.hpp"
#include "usable.hpp"

namespace nendo::deform {

namespace {

constexpr std::uint32_t no_texcoord = std::numeric_limits<std::uint32_t>::max();

class ObjParser {
public:
  ObjParser(std::string_view text, std::string_view name)
      : scanner_(text, TextScanner::Dialect::obj), name_(name) {}

  Result<Mesh> parse();

private:
  Result<void> statement();
  Result<void> coordinates(std::vector<double>& list, int needed, int kept);
  Result<void> face();
  Result<void> corner(std::string_view field);
  std::optional<std::uint32_t> index(std::string_view field, std::size_t count,
                                     HighestIndex& highest) const;
  Result<void> check_indices() const;
  void finish_texcoords();

  Error bad(const std::string& what) const { return bad_line(name_, scanner_.line(), what); }

  TextScanner scanner_;
  std::string_view name_;
  std::vector<double> vertices_;  ///< three numbers each
  std::vector<double> texcoords_; ///< two numbers each
  HighestIndex highest_vertex_;
  HighestIndex highest_texcoord_;
  Mesh mesh_;
};

Result<Mesh> ObjParser::parse() {
  do {
    if (const auto done = statement(); !done) return done.error();
  } while (scanner_.next_line());
  if (const auto good = check_indices(); !good) return good.error();
  mesh_.vertices = columns_of<3>(vertices_);
  finish_texcoords();
  return std::move(mesh_);
}

Result<void> ObjParser::statement() {
  const std::string_view keyword = scanner_.field();
  if (keyword == "v") return coordinates(vertices_, 3, 3);
  if (keyword == "vt") return coordinates(texcoords_, 1, 2);
  if (keyword == "f") return face();
  return {};
}

/// Up to `kept` numbers; of these, those beyond `needed` may be missing and are 0. What follows (a
/// weight, a colour) is skipped.
Result<void> ObjParser::coordinates(std::vector<double>& list, int needed, int kept) {
  for (int i = 0; i < kept; ++i) {
    const std::string_view field = scanner_.field();
    if (field.empty() && i < needed)
      return bad("needs " + std::to_string(needed) + " numbers, has " + std::to_string(i));
    const auto number = field.empty() ? 0.0 : to_number(field);
    if (!number || !is_usable(*number))
      return bad(in_quotes(field) + " is not a finite number of at most 1e100");
    list.push_back(*number);
  }
  return {};
}

Result<void> ObjParser::face() {
  const std::size_t before = mesh_.face_corners.size();
  for (auto field = scanner_.field(); !field.empty(); field = scanner_.field())
    if (auto done = corner(field); !done) return done;
  const std::size_t corners = mesh_.face_corners.size() - before;
  if (corners < 3) return bad("a face needs 3 corners, has " + std::to_string(corners));
  mesh_.face_starts.push_back(static_cast<std::uint32_t>(mesh_.face_corners.size()));
  return {};
}

/// v, v/vt, v//vn or v/vt/vn.
Result<void> ObjParser::corner(std::string_view field) {
  const std::size_t slash = field.find('/');
  const auto vertex = index(field.substr(0, slash), vertices_.size() / 3, highest_vertex_);
  if (!vertex) return bad(in_quotes(field) + " names no vertex");
  mesh_.face_corners.push_back(*vertex);
  std::string_view texcoord;
  if (slash != std::string_view::npos) {
    texcoord = field.substr(slash + 1);
    texcoord = texcoord.substr(0, texcoord.find('/'));
  }
  std::uint32_t texcoord_index = no_texcoord;
  if (!texcoord.empty()) {
    const auto found = index(texcoord, texcoords_.size() / 2, highest_texcoord_);
    if (!found) return bad(in_quotes(field) + " names no texture coordinate");
    texcoord_index = *found;
  }
  mesh_.corner_texcoords.push_back(texcoord_index);
  return {};
}

/// Counted from 1, or backwards from the newest.
std::optional<std::uint32_t> ObjParser::index(std::string_view field, std::size_t count,
                                              HighestIndex& highest) const {
  const auto number = to_integer(field);
  if (!number || *number == 0) return std::nullopt;
  const std::int64_t from_zero =
      *number > 0 ? *number - 1 : static_cast<std::int64_t>(count) + *number;
  if (from_zero < 0 || from_zero >= no_texcoord) return std::nullopt;
  const auto found = static_cast<std::uint32_t>(from_zero);
  highest.note(found, scanner_.line());
  return found;
}

Result<void> ObjParser::check_indices() const {
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

/// Corners without a texture coordinate share one more at (0, 0), if others have one.
void ObjParser::finish_texcoords() {
  if (highest_texcoord_.place == 0) {
    mesh_.corner_texcoords.clear();
    return;
  }
  const auto extra = static_cast<std::uint32_t>(texcoords_.size() / 2);
  bool used = false;
  for (auto& index : mesh_.corner_texcoords) {
    if (index != no_texcoord) continue;
    index = extra;
    used = true;
  }
  if (used) texcoords_.insert(texcoords_.end(), {0.0, 0.0});
  mesh_.texcoords = columns_of<2>(texcoords_);
}

template <class Number>
void append(std::string& text, Number number) {
  std::array<char, 32> digits{}; // the shortest form that reads back the same has at most 24
  const auto result = std::to_chars(digits.data(), digits.data() + digits.size(), number);
  text.append(digits.data(), result.ptr);
}

template <class Columns>
void append_columns(std::string& text, const char* keyword, const Columns& columns) {
  for (Eigen::Index column = 0; column < columns.cols(); ++column) {
    text += keyword;
    for (Eigen::Index row = 0; row < columns.rows(); ++row) {
      text += ' ';
      append(text, columns(row, column));
    }
    text += '\n';
  }
}

} // namespace

Result<Mesh> parse_obj(std::string_view text, std::string_view name) {
  return ObjParser(text, name).parse();
}

std::string obj_text(const Mesh& mesh) {
  std::string text = "# nendo\n";
  append_columns(text, "v", mesh.vertices);
  append_columns(text, "vt", mesh.texcoords);
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    text += 'f';
    for (std::size_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at) {
      text += ' ';
      append(text, std::uint64_t{mesh.face_corners[at]} + 1);
      if (mesh.corner_texcoords.empty()) continue;
      text += '/';
      append(text, std::uint64_t{mesh.corner_texcoords[at]} + 1);
    }
    text += '\n';
  }
  return text;
}

} // namespace nendo::deform
