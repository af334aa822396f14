#include "files/ply_header.hpp"

#include <array>
#include <limits>

#include <nendo/base/text.hpp>

#include "files/text_scanner.hpp"

namespace nendo::deform {
namespace {

/// Both names of each type, in the order of NumberType.
constexpr std::array<std::array<std::string_view, 2>, 8> type_names{{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};

std::optional<NumberType> type_named(std::string_view name) noexcept {
  for (std::size_t type = 0; type < type_names.size(); ++type)
    if (name == type_names[type][0] || name == type_names[type][1])
      return static_cast<NumberType>(type);
  return std::nullopt;
}

class HeaderParser {
public:
  HeaderParser(std::string_view text, std::string_view name)
      : text_(text), scanner_(text, TextScanner::Dialect::plain), name_(name) {}

  Result<PlyHeader> parse() {
    while (scanner_.next_line()) {
      const std::string_view keyword = scanner_.field();
      if (keyword == "end_header") {
        if (!has_format_) return bad("the header ends without a format");
        if (!scanner_.next_line()) return bad("the file ends with its header");
        header_.body_offset = scanner_.offset() - bytes_of_body_taken();
        header_.body_line = scanner_.line();
        return std::move(header_);
      }
      if (const auto done = statement(keyword); !done) return done.error();
    }
    return bad("the file ends within its header");
  }

private:
  Result<void> statement(std::string_view keyword) {
    if (keyword == "format") return format();
    if (keyword == "element") return element();
    if (keyword == "property") return property();
    if (keyword == "comment") comment();
    if (keyword.empty() || keyword == "comment" || keyword == "obj_info") return {};
    return bad(in_quotes(keyword) + " is not known in a PLY header");
  }
  Result<void> format() {
    const std::string_view format = scanner_.field();
    const std::string_view version = scanner_.field();
    if (version != "1.0")
      return bad("PLY version " + in_quotes(version) + " is not known, only 1.0");
    constexpr std::array<std::string_view, 3> known{"ascii", "binary_little_endian",
                                                    "binary_big_endian"};
    const auto found = enumerator_named<PlyFormat>(known, format);
    if (!found) return bad("PLY format " + in_quotes(format) + " is not known");
    header_.format = *found;
    has_format_ = true;
    return {};
  }
  Result<void> element() {
    const std::string_view element = scanner_.field();
    const std::string_view count_field = scanner_.field();
    const auto count = to_integer(count_field);
    if (!count || *count < 0 || *count > std::numeric_limits<std::uint32_t>::max())
      return bad(in_quotes(count_field) + " is not a number of elements");
    for (const auto& earlier : header_.elements)
      if (earlier.name == element) return bad("element " + in_quotes(element) + " comes twice");
    header_.elements.push_back({.name = element, .count = static_cast<std::uint64_t>(*count)});
    return {};
  }
  Result<void> property() {
    if (header_.elements.empty()) return bad("a property before the first element");
    PlyProperty property;
    std::string_view type = scanner_.field();
    if (type == "list") {
      const std::string_view count_type = scanner_.field();
      property.count_type = type_named(count_type);
      if (!property.count_type) return bad("type " + in_quotes(count_type) + " is not known");
      type = scanner_.field();
    }
    const auto known = type_named(type);
    if (!known) return bad("type " + in_quotes(type) + " is not known");
    property.type = *known;
    property.name = scanner_.field();
    if (property.name.empty()) return bad("a property without a name");
    header_.elements.back().properties.push_back(property);
    return {};
  }
  /// Names may have blanks. Only the first ones are read: a hostile header could name one a line.
  void comment() {
    constexpr std::size_t max_textures = 64;
    if (scanner_.field() != "TextureFile") return;
    const std::string_view named = trimmed(scanner_.rest_of_line());
    if (!named.empty() && header_.textures.size() < max_textures)
      header_.textures.emplace_back(named);
  }

  /// Where a header's lines end with \r, a body that begins with \n seems to be a part of the last
  /// line end.
  std::size_t bytes_of_body_taken() const noexcept {
    const bool ends_lines_with_cr = text_.starts_with("ply\r") && !text_.starts_with("ply\r\n");
    const bool took_more = text_.substr(0, scanner_.offset()).ends_with("\r\n");
    return ends_lines_with_cr && took_more ? 1 : 0;
  }

  Error bad(const std::string& what) const { return bad_line(name_, scanner_.line(), what); }

  std::string_view text_;
  TextScanner scanner_;
  std::string_view name_;
  bool has_format_ = false;
  PlyHeader header_;
};

} // namespace

Result<PlyHeader> parse_ply_header(std::string_view text, std::string_view name) {
  return HeaderParser(text, name).parse();
}

} // namespace nendo::deform
