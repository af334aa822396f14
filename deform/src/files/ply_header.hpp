#pragma once
// The header of a PLY file (Turk 1994): which elements follow, in which order, with which
// properties.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

#include "files/binary_numbers.hpp"

namespace nendo::deform {

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyProperty {
  std::string_view name;
  NumberType type = NumberType::float32; ///< the type of the value, or of a list's items
  std::optional<NumberType>
      count_type{}; ///< the type of a list's length; nothing for a single value
};

struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0; ///< as the file says: not yet checked against its bytes
  std::vector<PlyProperty> properties{};
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures; ///< what each `comment TextureFile` names
  std::size_t body_offset = 0;
  std::size_t body_line = 1;
};

/// Parses the header. The names in the result point into `text`. Error: bad_input with the line.
Result<PlyHeader> parse_ply_header(std::string_view text, std::string_view name);

} // namespace nendo::deform
