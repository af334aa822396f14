#pragma once
// STL, text and binary (3D Systems 1988): triangles alone, each with corners of its own.

#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// With this begins what stl_text() writes.
inline constexpr std::string_view stl_mark = "binary STL by nendo";

/// Returns whether the text is an STL: it begins with "solid" and has facets, or with "facet
/// normal", or is binary and has as many bytes as its count says. If `name` ends in .stl, all that
/// is binary is one.
bool is_stl(std::string_view text, std::string_view name) noexcept;

/// Reads an STL. Each facet has vertices of its own. Solids are objects; colours of facets, in the
/// forms of VisCAM and of Magics, are materials. Notes say what is left out.
Result<Mesh> parse_stl(std::string_view text, std::string_view name,
                       std::vector<std::string>& notes);

/// Returns the mesh as binary STL. Error: failed (more triangles than an STL can count, or a
/// coordinate beyond its floats), in words for after the file's name.
Result<std::string> stl_text(const Mesh& mesh);

/// Returns how far a float's rounding moves a vertex at the most, in parts of the model's size.
double rounding_in_floats(const Mesh& mesh) noexcept;

} // namespace nendo::deform
