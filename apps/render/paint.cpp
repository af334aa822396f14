#include "render/paint.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <turbojpeg.h>

#include <nendo/deform/drawn_faces.hpp>
#include <nendo/deform/triangles.hpp>

namespace nendo::render {

using Eigen::Index;
using Eigen::Vector2f;
using Eigen::Vector3f;

namespace {

using namespace std::string_view_literals;

struct Signature {
  std::size_t at;
  std::string_view bytes;
  std::string_view format;
};

constexpr std::array signatures{
    Signature{8, "WEBP"sv, "a WebP picture"},
    Signature{0, "\xABKTX 20\xBB"sv, "a KTX2 texture"},
    Signature{0, "\xABKTX 11\xBB"sv, "a KTX texture"},
    Signature{0, "sB\x13\x00"sv, "a Basis texture"},
    Signature{0, "DDS "sv, "a DDS texture"},
    Signature{0, "II*\0"sv, "a TIFF picture"},
    Signature{0, "MM\0*"sv, "a TIFF picture"},
    Signature{0, "II+\0"sv, "a TIFF picture"},
    Signature{0, "8BPS"sv, "a Photoshop picture"},
    Signature{0, "v/1\x01"sv, "an OpenEXR picture"},
    Signature{0, "#?RADIANCE"sv, "a Radiance picture"},
    Signature{0, "#?RGBE"sv, "a Radiance picture"},
    Signature{0, "GIF8"sv, "a GIF picture"},
    Signature{4, "ftypavif"sv, "an AVIF picture"},
    Signature{4, "ftyphei"sv, "a HEIC picture"},
    Signature{4, "ftypmif1"sv, "a HEIC picture"},
    Signature{0, "\0\0\0\x0CjP  "sv, "a JPEG 2000 picture"},
    Signature{0, "\xFFO\xFFQ"sv, "a JPEG 2000 picture"},
    Signature{0, "\xFF\x0A"sv, "a JPEG XL picture"},
    Signature{0, "\0\0\0\x0CJXL "sv, "a JPEG XL picture"},
    Signature{0, "gimp xcf"sv, "a GIMP picture"},
    Signature{0, "%PDF"sv, "a PDF document"},
    Signature{0, "<svg"sv, "an SVG drawing"},
    Signature{0, "version https://git-lfs"sv, "a pointer of Git LFS"},
    Signature{0, "<!DOCTYPE"sv, "an HTML page"},
    Signature{0, "<!doctype"sv, "an HTML page"},
    Signature{0, "<html"sv, "an HTML page"},
};

struct DecodedJpeg {
  Image image;
  bool is_whole = true; ///< false: some of it is damaged, or, where the file is cut off, grey
};

using Decoder = std::unique_ptr<void, int (*)(tjhandle)>;

Error damaged_jpeg() {
  return {Errc::bad_input, "is a damaged JPEG picture; export it once more"};
}

const unsigned char* bytes_of(std::string_view contents) noexcept {
  return reinterpret_cast<const unsigned char*>(contents.data());
}

/// Errors end a sentence that begins with the file's name.
Result<Size> read_header(const Decoder& decoder, std::string_view contents) {
  if (!decoder) return Error{Errc::bad_input, "cannot be decoded, for want of memory"};
  Size size;
  int sampling = 0;
  int space = 0;
  if (tjDecompressHeader3(decoder.get(), bytes_of(contents), contents.size(), &size.width,
                          &size.height, &sampling, &space) != 0 ||
      size.width < 1 || size.height < 1)
    return damaged_jpeg();
  if (space == TJCS_CMYK || space == TJCS_YCCK)
    return Error{Errc::bad_input, "is a JPEG in CMYK, which is not read; save it in RGB"};
  if (size.width > Size::most || size.height > Size::most) return too_many_pixels();
  return size;
}

Result<DecodedJpeg> decode_jpeg(std::string_view contents) {
  const Decoder decoder(tjInitDecompress(), &tjDestroy);
  const auto size = read_header(decoder, contents);
  if (!size) return size.error();
  std::vector<Pixel> pixels(static_cast<std::size_t>(size->width) *
                            static_cast<std::size_t>(size->height));
  // A hostile file may have scans without end.
  const int flags = TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS;
  const int done =
      tjDecompress2(decoder.get(), bytes_of(contents), contents.size(), pixels.front().data(),
                    size->width, 0, size->height, TJPF_RGB, flags);
  if (done != 0 && tjGetErrorCode(decoder.get()) != TJERR_WARNING) return damaged_jpeg();
  return DecodedJpeg{Image(*size, std::move(pixels)), done == 0};
}

// The linear value of each byte (IEC 61966-2-1). In double, so that every machine rounds alike.
const std::array<float, 256>& linear_bytes() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t byte = 0; byte < values.size(); ++byte) {
      const double part = static_cast<double>(byte) / 255.0;
      values[byte] = static_cast<float>(part <= 0.04045 ? part / 12.92
                                                        : std::pow((part + 0.055) / 1.055, 2.4));
    }
    return values;
  }();
  return table;
}

Image halved(const Image& image) {
  const Size size{std::max(1, image.size().width / 2), std::max(1, image.size().height / 2)};
  Image half(size);
  const int right = image.size().width > 1 ? 1 : 0;
  const int below = image.size().height > 1 ? 1 : 0;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const auto of = [&](int dx, int dy) {
          return static_cast<int>(image.at(x + (x + dx), y + (y + dy))[channel]);
        };
        half.at(x, y)[channel] = static_cast<std::uint8_t>(
            (of(0, 0) + of(right, 0) + of(0, below) + of(right, below) + 2) / 4);
      }
  return half;
}

/// A coordinate's pixel and the next one, and how much of the next one there is.
struct Between {
  int first, second;
  float share;
};

Between between(float part, int count) noexcept {
  const float wrapped = part - std::floor(part); // 0 to 1; NaN and infinity are caught below
  const float at = wrapped * static_cast<float>(count) - 0.5F;
  if (!(at > -1.0F && at < static_cast<float>(count))) return {0, 0, 0.0F};
  const float whole = std::floor(at);
  const int first = static_cast<int>(whole);
  return {(first + count) % count, (first + 1) % count, at - whole};
}

/// The longer side that a PNG's header says, in pixels; 0 if there is none.
std::uint32_t longer_side_of_png(std::string_view contents) noexcept {
  constexpr std::size_t width_at = 16, height_at = 20;
  if (contents.size() < height_at + 4) return 0;
  const auto number_at = [&](std::size_t at) {
    std::uint32_t number = 0; // the most significant byte first
    for (std::size_t k = 0; k < 4; ++k)
      number = number << 8 | static_cast<unsigned char>(contents[at + k]);
    return number;
  };
  const std::uint32_t width = number_at(width_at), height = number_at(height_at);
  return width == 0 || height == 0 ? 0 : std::max(width, height);
}

/// Returns whether a picture's header and end show that it is whole, for decoding a large one twice
/// would be felt. A PNG ends with its mark; a JPEG has its mark nowhere among the pixels, though
/// one that belongs to a small picture may come before them. Others are quick to decode.
bool looks_whole(std::string_view contents) {
  const PictureKind kind = picture_kind_of(contents);
  if (kind == PictureKind::jpeg) {
    constexpr std::size_t before_pixels = std::size_t{1} << 16;
    return read_header(Decoder(tjInitDecompress(), &tjDestroy), contents) &&
           contents.find("\xFF\xD9", before_pixels) != contents.npos;
  }
  if (kind != PictureKind::png) return false;
  constexpr std::size_t end_bytes = 12;
  const std::uint32_t side = longer_side_of_png(contents);
  return side >= 1 && side <= Size::most &&
         contents.substr(contents.size() - end_bytes).find("IEND") != contents.npos;
}

Result<Image> decode_png_texture(std::string_view contents) {
  auto image = decode_png(contents, "texture");
  if (image) return image;
  if (longer_side_of_png(contents) > Size::most) return too_many_pixels();
  return Error{Errc::bad_input, "is a damaged PNG picture; export it once more"};
}

// Of a file that is not decoded here, with its article; empty if it is not known either.
std::string_view foreign_format_of(std::string_view contents) noexcept {
  for (const Signature& signature : signatures)
    if (contents.size() > signature.at &&
        contents.substr(signature.at).starts_with(signature.bytes))
      return signature.format;
  return {};
}

} // namespace

PictureKind picture_kind_of(std::string_view contents) noexcept {
  if (contents.starts_with("\x89PNG\r\n\x1A\n")) return PictureKind::png;
  if (contents.starts_with("\xFF\xD8\xFF")) return PictureKind::jpeg;
  if (is_bmp(contents)) return PictureKind::bmp;
  // TGA has no mark, and one may begin like another format by chance.
  if (foreign_format_of(contents).empty() && is_tga(contents)) return PictureKind::tga;
  return PictureKind::none;
}

Result<Image> decode_picture(std::string_view contents) {
  switch (picture_kind_of(contents)) {
  case PictureKind::png:
    return decode_png_texture(contents);
  case PictureKind::jpeg: {
    auto decoded = decode_jpeg(contents);
    if (!decoded) return decoded.error();
    return std::move(decoded->image);
  }
  case PictureKind::bmp:
    return decode_bmp(contents);
  case PictureKind::tga:
    return decode_tga(contents);
  case PictureKind::none:
    break;
  }
  const std::string format(foreign_format_of(contents));
  if (format.empty())
    return Error{Errc::bad_input, "is no picture; PNG, JPEG, TGA and BMP are read"};
  if (format == "a pointer of Git LFS")
    return Error{Errc::bad_input, "is a pointer of Git LFS; `git lfs pull` fetches the picture"};
  if (format == "an HTML page")
    return Error{Errc::bad_input, "is an HTML page; download the picture itself"};
  return Error{Errc::bad_input, "is " + format + ", which is not read; save it as PNG or JPEG"};
}

std::string fault_of_picture(std::string_view contents) {
  constexpr std::size_t large = std::size_t{4} << 20;
  if (contents.size() > large && looks_whole(contents)) return "";
  if (picture_kind_of(contents) == PictureKind::jpeg) {
    const auto decoded = decode_jpeg(contents);
    if (!decoded) return decoded.error().message;
    return decoded->is_whole ? "" : "is a damaged JPEG picture; what can be read of it is shown";
  }
  const auto image = decode_picture(contents);
  return image ? "" : image.error().message;
}

std::shared_ptr<const std::string>
as_png_or_jpeg(const std::shared_ptr<const std::string>& contents) {
  if (!contents) return nullptr;
  const PictureKind kind = picture_kind_of(*contents);
  if (kind == PictureKind::none) return nullptr;
  if (kind == PictureKind::png || kind == PictureKind::jpeg) return contents;
  const auto image = decode_picture(*contents);
  if (!image) return nullptr;
  auto png = png_of(*image);
  return png ? std::make_shared<const std::string>(*std::move(png)) : nullptr;
}

TextureImage::TextureImage(Image image) {
  levels_.push_back(std::move(image));
  while (levels_.back().size().width > 1 || levels_.back().size().height > 1)
    levels_.push_back(halved(levels_.back()));
}

Vector3f TextureImage::colour_at(const Eigen::Vector2f& uv, float span_pixels) const noexcept {
  std::size_t level = 0;
  for (float span = span_pixels; span > 1.5F && level + 1 < levels_.size(); span /= 2.0F)
    ++level;
  const Image& image = levels_[level];
  const Between x = between(uv.x(), image.size().width);
  const Between y = between(1.0F - uv.y(), image.size().height);
  const auto& linear = linear_bytes();
  Vector3f colour;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const auto of = [&](int column, int row) { return linear[image.at(column, row)[channel]]; };
    const float upper =
        of(x.first, y.first) + x.share * (of(x.second, y.first) - of(x.first, y.first));
    const float lower =
        of(x.first, y.second) + x.share * (of(x.second, y.second) - of(x.first, y.second));
    colour[static_cast<Eigen::Index>(channel)] = upper + y.share * (lower - upper);
  }
  return colour;
}

namespace {

// Warm, while the hands are cool, so that they differ at a glance, also without seeing red from
// green.
const Vector3f clay(0.50F, 0.235F, 0.135F);

Vector3f colour_of(const deform::Material* material, bool has_more) {
  if (material != nullptr && material->colour) return material->colour->head<3>();
  return has_more ? Vector3f(Vector3f::Ones()) : clay; // white is coloured by what is on it
}

using Textures = std::vector<std::shared_ptr<const TextureImage>>;

/// Of each material, its texture, decoded; null if there is none.
Textures textures_of(const deform::Mesh& mesh) {
  Textures decoded(mesh.look.textures.size());
  Textures of_materials(mesh.look.materials.size());
  if (mesh.corner_texcoords.empty()) return of_materials;
  // A small file can be a large picture, and a model can have many.
  std::size_t left = std::size_t{1} << 29; // pixels
  std::vector<bool> tried(decoded.size(), false);
  for (std::size_t at = 0; at < of_materials.size(); ++at) {
    const std::uint32_t number = mesh.look.materials[at].texture;
    if (number == deform::no_index) continue;
    const deform::Texture& texture = mesh.look.textures[number];
    if (!tried[number] && texture.contents && left > 0) {
      tried[number] = true;
      if (auto image = decode_picture(*texture.contents)) {
        left -= std::min(left, image->pixels().size());
        decoded[number] = std::make_shared<const TextureImage>(*std::move(image));
      }
    }
    of_materials[at] = decoded[number];
  }
  return of_materials;
}

// Linear. From light to dark, so that it is read without seeing red from green.
const std::array<Vector3f, 5> ramp{
    Vector3f{0.400F, 0.400F, 0.390F}, Vector3f{0.991F, 0.694F, 0.181F},
    Vector3f{0.982F, 0.266F, 0.045F}, Vector3f{0.768F, 0.010F, 0.012F},
    Vector3f{0.216F, 0.000F, 0.019F}};

/// part: 0 to 1.
Vector3f ramp_at(double part) {
  const double place = part * static_cast<double>(ramp.size() - 1);
  const auto before = std::min(static_cast<std::size_t>(place), ramp.size() - 2);
  const auto share = static_cast<float>(place - static_cast<double>(before));
  return (1.0F - share) * ramp[before] + share * ramp[before + 1];
}

double way_of(const deform::Mesh& rest, const deform::Points& shape, Index vertex) {
  const double way = (shape.col(vertex) - rest.vertices.col(vertex)).norm();
  return std::isfinite(way) ? way : 0.0;
}

} // namespace

Paint::Paint(const deform::Mesh& mesh, std::vector<std::uint32_t>& corners) {
  const deform::Appearance& look = mesh.look;
  const auto& colours = look.vertex_colours;
  if (colours.cols() == mesh.vertices.cols())
    for (Index vertex = 0; vertex < colours.cols(); ++vertex)
      vertex_colours_.emplace_back(colours.col(vertex).head<3>());
  const bool coloured_corners = mesh.look.texcoord_colours.cols() > 0;
  const auto faces = deform::drawn_faces(mesh);
  const Textures textures = textures_of(mesh);
  const bool textured = std::any_of(textures.begin(), textures.end(),
                                    [](const auto& texture) { return texture != nullptr; });
  deform::FaceTriangles triangles(mesh);
  corners.clear();
  for (std::size_t at = 0; at < faces.size(); ++at) {
    const auto texture = at == 0 ? nullptr : textures[at - 1];
    Coat coat{corners.size() / 3, 0,
              colour_of(at == 0 ? nullptr : &look.materials[at - 1],
                        !vertex_colours_.empty() || coloured_corners || texture != nullptr),
              texture};
    for (const std::uint32_t face : faces[at])
      for (const deform::Triangle& triangle : triangles.of(face))
        for (const std::uint32_t of : triangle) {
          corners.push_back(mesh.face_corners[of]);
          if (coloured_corners)
            corner_colours_.emplace_back(
                mesh.look.texcoord_colours.col(mesh.corner_texcoords[of]).head<3>());
          if (textured)
            texcoords_.emplace_back(mesh.texcoords.col(mesh.corner_texcoords[of]).cast<float>());
        }
    coat.count = corners.size() / 3 - coat.first;
    if (coat.count == 0) continue;
    coat_of_.insert(coat_of_.end(), coat.count, static_cast<std::uint32_t>(coats_.size()));
    coats_.push_back(std::move(coat));
  }
}

Vector3f Paint::colour_at(std::size_t triangle, const std::array<std::uint32_t, 3>& vertices,
                          const std::array<float, 3>& shares, float samples) const noexcept {
  const Coat& coat = coats_[coat_of_[triangle]];
  Vector3f colour = coat.colour;
  if (!vertex_colours_.empty() || !corner_colours_.empty()) {
    Vector3f mixed = Vector3f::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      mixed += shares[k] * (corner_colours_.empty() ? vertex_colours_[vertices[k]]
                                                    : corner_colours_[3 * triangle + k]);
    colour = colour.cwiseProduct(mixed);
  }
  if (!coat.texture) return colour;
  const Vector2f* const uv = &texcoords_[3 * triangle];
  const Vector2f place = shares[0] * uv[0] + shares[1] * uv[1] + shares[2] * uv[2];
  const Vector2f along = uv[1] - uv[0];
  const Vector2f across = uv[2] - uv[0];
  const Size size = coat.texture->image().size();
  const float area = 0.5F * std::abs(along.x() * across.y() - along.y() * across.x());
  const float pixels =
      std::sqrt(area * static_cast<float>(size.width) * static_cast<float>(size.height));
  return colour.cwiseProduct(
      coat.texture->colour_at(place, samples > 0.0F ? pixels / samples : 0.0F));
}

double farthest_way(const deform::Mesh& rest, const deform::Points& shape) {
  double farthest = 0.0;
  for (Index vertex = 0; vertex < shape.cols(); ++vertex)
    farthest = std::max(farthest, way_of(rest, shape, vertex));
  return farthest;
}

std::shared_ptr<const Paint> paint_by_distance(const deform::Mesh& rest,
                                               const deform::Points& shape, double farthest) {
  deform::Mesh painted = rest; // whose materials decide which triangles are drawn, in what order
  for (deform::Material& material : painted.look.materials) {
    material.colour = Eigen::Vector4f::Ones();
    material.texture = deform::no_index;
  }
  painted.look.texcoord_colours.resize(4, 0);
  painted.look.vertex_colours.setOnes(4, shape.cols());
  for (Index vertex = 0; vertex < shape.cols(); ++vertex)
    painted.look.vertex_colours.col(vertex).head<3>() =
        ramp_at(std::min(1.0, way_of(rest, shape, vertex) / farthest));
  std::vector<std::uint32_t> corners;
  return std::make_shared<const Paint>(painted, corners);
}

} // namespace nendo::render
