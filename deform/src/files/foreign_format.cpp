// Recognises files of formats that are not read, and says what to do with them.

#include "files/mesh_formats.hpp"

#include <algorithm>

#include <nendo/base/endings.hpp>
#include <nendo/base/text.hpp>

#include "files/binary_numbers.hpp"

namespace nendo::deform {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view by_blender =
    "; open it in Blender, or where it was made, and export it as glTF (.glb), OBJ, PLY or STL";
constexpr std::string_view by_cad =
    ", which has curved surfaces and no triangles; export it as STL from the program that made it, "
    "or from FreeCAD";
constexpr std::string_view by_unpacking = "; unpack it, and give the model that is in it";
constexpr std::string_view by_cloud_program =
    ", which has no surface; make one in MeshLab or CloudCompare (Poisson surface "
    "reconstruction), and save that as PLY";
constexpr std::string_view by_iconv =
    "; make it UTF-8: save it so in an editor, or iconv -f UTF-16 -t UTF-8 FILE >NEW-FILE";
constexpr std::string_view by_iconv_32 =
    "; make it UTF-8: save it so in an editor, or iconv -f UTF-32 -t UTF-8 FILE >NEW-FILE";
constexpr std::string_view no_model = "; give the file of a model (.obj, .ply, .stl, .glb, .gltf)";

struct Mark {
  std::size_t offset;
  std::string_view bytes;
  std::string_view what;
  std::string_view remedy;
};

// A longer mark precedes a shorter one that it begins with.
constexpr Mark marks[] = {
    {0, "Kaydara FBX Binary"sv, "is an FBX file", by_blender},
    {0, "PXR-USDC"sv, "is a USD file (binary)", by_blender},
    {0, "#usda"sv, "is a USD file (text)", by_blender},
    {0, "Ogawa"sv, "is an Alembic file", by_blender},
    {0, "\x89HDF\r\n\x1A\n"sv, "is an HDF5 file, perhaps an Alembic file", by_blender},
    {0, "BLENDER"sv, "is a file of Blender", "; open it in Blender and export it as glTF or OBJ"},
    {0, "FORM????LWO"sv, "is a file of LightWave", by_blender},
    {0, "FOR4"sv, "is a file of Maya (binary)", by_blender},
    {0, "FOR8"sv, "is a file of Maya (binary)", by_blender},
    {0, "//Maya ASCII"sv, "is a file of Maya (text)", by_blender},
    {0, "#VRML"sv, "is a VRML file", by_blender},
    {0, "#X3D"sv, "is an X3D file", by_blender},
    {0, "DRACO"sv, "is a Draco file", "; decode it with draco_decoder -i FILE -o NEW-FILE.ply"},
    {0, "3D Geometry File Format"sv, "is a 3DMF file", by_blender},
    {0, "3D Geometry"sv, "is a file of Rhinoceros (3DM)", by_cad},
    {0, "U3D\0"sv, "is a U3D file", by_blender},
    {0, "# .PCD"sv, "is a point cloud (PCD)", by_cloud_program},
    {0, "LASF"sv, "is a point cloud (LAS or LAZ)", by_cloud_program},
    {0, "ASTM-E57"sv, "is a point cloud (E57)", by_cloud_program},
    {0, "# vtk DataFile"sv, "is a VTK file", "; open it in ParaView and save it as PLY or STL"},
    {0, "DBRep_DrawableShape"sv, "is a BREP file", by_cad},
    {0, "CASCADE Topology"sv, "is a BREP file", by_cad},
    {0, "**ABCDEFGHIJKLMNOPQRSTUVWXYZ"sv, "is a Parasolid file", by_cad},
    {0, "AC10"sv, "is a DWG file of AutoCAD", by_cad},
    {0, "\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"sv,
     "is a file of SolidWorks, 3ds Max or an office program", "; export it as STL or OBJ there"},
    {0, "version https://git-lfs"sv, "is a pointer of Git LFS and not the file itself",
     "; fetch the file with git lfs pull"},
    {0, "\x1F\x8B"sv, "is packed with gzip", by_unpacking},
    {0, "BZh"sv, "is packed with bzip2", by_unpacking},
    {0,
     "\xFD"
     "7zXZ\0"sv,
     "is packed with xz", by_unpacking},
    {0, "\x28\xB5\x2F\xFD"sv, "is packed with zstd", by_unpacking},
    {0, "7z\xBC\xAF\x27\x1C"sv, "is a 7z archive", by_unpacking},
    {0, "Rar!\x1A\x07"sv, "is a RAR archive", by_unpacking},
    {0, "\x1F\x9D"sv, "is packed with compress", by_unpacking},
    {257, "ustar"sv, "is a tar archive", by_unpacking},
    {0, "%PDF"sv, "is a PDF document", no_model},
    {0, "\x89PNG\r\n"sv, "is a picture (PNG)", no_model},
    {0, "\xFF\xD8\xFF"sv, "is a picture (JPEG)", no_model},
    {0, "GIF8"sv, "is a picture (GIF)", no_model},
    {0, "RIFF????WEBP"sv, "is a picture (WebP)", no_model},
    {0, "II*\0"sv, "is a picture (TIFF)", no_model},
    {0, "MM\0*"sv, "is a picture (TIFF)", no_model},
    {0, "DDS "sv, "is a picture (DDS)", no_model},
    {0,
     "\x7F"
     "ELF"sv,
     "is a program", no_model},
    {0, "\x89NENDO\r\n"sv, "is a recording of Nendo", "; nendo replay and nendo export read it"},
    {0, "\xFF\xFE\0\0"sv, "is text in UTF-32", by_iconv_32},
    {0, "\0\0\xFE\xFF"sv, "is text in UTF-32", by_iconv_32},
    {0, "\xFF\xFE"sv, "is text in UTF-16", by_iconv},
    {0, "\xFE\xFF"sv, "is text in UTF-16", by_iconv},
};

/// A ? of the mark stands for any byte.
bool has_mark(std::string_view bytes, const Mark& mark) noexcept {
  if (bytes.size() < mark.offset + mark.bytes.size()) return false;
  return std::equal(mark.bytes.begin(), mark.bytes.end(), bytes.begin() + mark.offset,
                    [](char wanted, char found) { return wanted == '?' || wanted == found; });
}

bool begins_with_word(std::string_view text, std::string_view word) noexcept {
  return ends_in(text.substr(0, word.size()), word);
}

bool has(std::string_view text, std::string_view part) noexcept {
  return text.find(part) != std::string_view::npos;
}

/// The format of an archive, by its first file.
std::string zip_kind(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, 1024);
  if (has(head, "3D/") || has(head, "[Content_Types].xml"))
    return "is a 3MF file, or another zip archive" + std::string(by_blender);
  if (has(head, ".usdc") || has(head, ".usda"))
    return "is a USD file (usdz)" + std::string(by_blender);
  if (has(head, "Document.xml")) return "is a file of FreeCAD" + std::string(by_cad);
  return "is a zip archive" + std::string(by_unpacking);
}

std::string xml_kind(std::string_view head) {
  if (has(head, "<COLLADA")) return "is a Collada file" + std::string(by_blender);
  if (has(head, "<X3D")) return "is an X3D file" + std::string(by_blender);
  if (has(head, "<amf")) return "is an AMF file" + std::string(by_blender);
  if (has(head, "<svg")) return "is a drawing (SVG)" + std::string(no_model);
  if (has(head, "<VTKFile")) return "is a VTK file; open it in ParaView and save it as PLY or STL";
  return "is an XML file" + std::string(no_model);
}

/// UTF-16 without a byte-order mark: every other byte of the first letters is 0.
bool is_utf16_without_mark(std::string_view bytes) noexcept {
  constexpr std::size_t looked_at = 16;
  if (bytes.size() < looked_at) return false;
  for (const std::size_t zero : {std::size_t{0}, std::size_t{1}}) {
    bool is_text = true;
    for (std::size_t at = 0; at < looked_at; ++at) {
      const auto byte = static_cast<unsigned char>(bytes[at]);
      const bool is_letter = (byte >= ' ' && byte < 0x7F) || (byte >= '\t' && byte <= '\r');
      is_text = is_text && (at % 2 == zero ? byte == 0 : is_letter);
    }
    if (is_text) return true;
  }
  return false;
}

/// The file of Autodesk's 3D Studio: its first chunk, 0x4D4D, is as long as the file.
bool is_3ds(std::string_view bytes) noexcept {
  return bytes.size() >= 16 && bytes.starts_with("MM") &&
         number_from<std::uint32_t>(bytes.data() + 2) == bytes.size();
}

std::optional<std::string> text_format(std::string_view bytes) {
  const std::string_view whole = without_mark(bytes.substr(0, 4096));
  const std::string_view text =
      whole.substr(std::min(whole.find_first_not_of(" \t\r\n"), whole.size()));
  if (begins_with_word(text, "<!doctype html") || begins_with_word(text, "<html"))
    return "is a page of the web and not the file itself; download it by the page's own button or "
           "its raw link";
  if (text.starts_with("<")) return xml_kind(text);
  if (text.starts_with("; FBX")) return "is an FBX file (text)" + std::string(by_blender);
  if (text.starts_with("ISO-10303-21")) return "is a STEP file" + std::string(by_cad);
  if (text.starts_with("AutoCAD Binary DXF") || text.starts_with("0\nSECTION") ||
      text.starts_with("0\r\nSECTION") || text.starts_with("999\n"))
    return "is a DXF file" + std::string(by_cad);
  // IGES: lines of 80 letters, and in column 73 the S of the start section.
  if (whole.size() > 80 && whole.substr(72, 8).starts_with("S      1"))
    return "is an IGES file" + std::string(by_cad);
  const std::string_view first = text.substr(0, text.find_first_of("\r\n"));
  for (const std::string_view off : {"OFF"sv, "COFF"sv, "NOFF"sv, "STOFF"sv})
    if (trimmed(first) == off || first.starts_with("OFF "))
      return "is an OFF file; open it in MeshLab and save it as PLY or OBJ";
  if (has(text, "\nversion = ") && has(text, "\ntake = ") && has(text, "\nunits_per_metre = "))
    return "is a timeline of Nendo; nendo edit and nendo export read it";
  if (has(text, "version = ") && has(text, "\nmodel = ") && has(text, "\n[points]"))
    return "is a puppet of Nendo and no model; `nendo run --puppet FILE` plays it";
  return std::nullopt;
}

} // namespace

std::optional<std::string> foreign_format(std::string_view bytes) {
  for (const Mark& mark : marks)
    if (has_mark(bytes, mark)) return std::string(mark.what) + std::string(mark.remedy);
  if (bytes.starts_with("PK\3\4") || bytes.starts_with("PK\5\6")) return zip_kind(bytes);
  if (is_3ds(bytes)) return "is a 3DS file" + std::string(by_blender);
  if (is_utf16_without_mark(bytes)) return "is text in UTF-16" + std::string(by_iconv);
  return text_format(bytes);
}

std::string why_no_model(std::string_view text) {
  if (text.substr(0, 4096).find('\0') != std::string_view::npos)
    return "has no vertices, and is binary data of an unknown format" + std::string(no_model);
  LineReader lines(text.substr(0, 4096));
  const auto first = lines.next();
  if (!first) return "has no vertices, only blanks" + std::string(no_model);
  if (trimmed(*first).starts_with("["))
    return "is JSON or a list, and no model" + std::string(no_model);
  const std::vector<std::string_view> fields = fields_of(*first, 8);
  const auto is_number = [](std::string_view field) {
    return to_finite_number(field.substr(0, field.find_last_not_of(",;") + 1)).has_value();
  };
  if (fields.size() >= 3 && std::all_of(fields.begin(), fields.begin() + 3, is_number))
    return "has no vertices; it is a table of numbers, perhaps a point cloud (XYZ)" +
           std::string(by_cloud_program);
  return "has no vertices, so it is no OBJ, PLY, STL or glTF model; its first line is " +
         in_quotes(*first) + std::string(no_model);
}

} // namespace nendo::deform
