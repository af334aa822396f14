// TGA and BMP, written here byte by byte from their descriptions (Truevision 1991; Microsoft).

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "render/texture_image.hpp"

namespace nendo::render {
namespace {

std::string bytes(std::initializer_list<int> numbers) {
  std::string text;
  for (const int number : numbers)
    text += static_cast<char>(number);
  return text;
}

std::string two(int number) {
  return bytes({number & 0xFF, number >> 8});
}

std::string four(int number) {
  return two(number & 0xFFFF) + two(number >> 16);
}

std::string tga_header(int type, int width, int height, int bits, int descriptor,
                       int palette_size = 0) {
  return bytes({0, palette_size > 0 ? 1 : 0, type}) + two(0) + two(palette_size) +
         bytes({palette_size > 0 ? 24 : 0}) + two(0) + two(0) + two(width) + two(height) +
         bytes({bits, descriptor});
}

// Three by two pixels: red, green, blue; black, white, grey.
const std::vector<Pixel> wanted{{255, 0, 0}, {0, 255, 0},     {0, 0, 255},
                                {0, 0, 0},   {255, 255, 255}, {90, 91, 92}};
const std::string upper = bytes({0, 0, 255, 0, 255, 0, 255, 0, 0});
const std::string lower = bytes({0, 0, 0, 255, 255, 255, 92, 91, 90});
constexpr int from_top = 0x20;

std::string bmp_of(int header_size, int width, int height, int bits, const std::string& palette,
                   const std::string& pixels, int compression = 0) {
  const int offset = 14 + header_size + static_cast<int>(palette.size());
  std::string file = "BM" + four(offset + static_cast<int>(pixels.size())) + four(0) +
                     four(offset) + four(header_size);
  if (header_size == 12)
    file += two(width) + two(height) + two(1) + two(bits);
  else
    file += four(width) + four(height) + two(1) + two(bits) + four(compression) + four(0) +
            four(0) + four(0) + four(0) + four(0);
  return file + palette + pixels;
}

std::string padded(std::string row) {
  row.resize((row.size() + 3) / 4 * 4, '\0');
  return row;
}

struct Sample {
  const char* name;
  std::string file;
};

std::vector<Sample> samples() {
  std::string wide; // with an opacity, which is left out
  for (const std::string& row : {upper, lower})
    for (std::size_t at = 0; at < row.size(); at += 3)
      wide += row.substr(at, 3) + '\x40';
  const std::string palette = upper + lower;
  std::string wide_palette;
  for (std::size_t at = 0; at < palette.size(); at += 3)
    wide_palette += palette.substr(at, 3) + '\0';
  return {
      {"TGA from the top", tga_header(2, 3, 2, 24, from_top) + upper + lower},
      {"TGA from the bottom", tga_header(2, 3, 2, 24, 0) + lower + upper},
      {"TGA with opacity", tga_header(2, 3, 2, 32, from_top | 8) + wide},
      {"TGA with run lengths", tga_header(10, 3, 2, 24, from_top) + bytes({2}) + upper +
                                   bytes({0x80}) + lower.substr(0, 3) + bytes({1}) +
                                   lower.substr(3)},
      {"TGA with a palette",
       tga_header(1, 3, 2, 8, from_top, 6) + palette + bytes({0, 1, 2, 3, 4, 5})},
      {"TGA from the right", tga_header(2, 3, 2, 24, from_top | 0x10) + upper.substr(6) +
                                 upper.substr(3, 3) + upper.substr(0, 3) + lower.substr(6) +
                                 lower.substr(3, 3) + lower.substr(0, 3)},
      {"TGA with a name before its pixels",
       bytes({4}) + tga_header(2, 3, 2, 24, from_top).substr(1) + "name" + upper + lower},
      {"BMP", bmp_of(40, 3, 2, 24, "", padded(lower) + padded(upper))},
      {"BMP from the top", bmp_of(40, 3, -2, 24, "", padded(upper) + padded(lower))},
      {"BMP of 32 bits", bmp_of(40, 3, -2, 32, "", wide)},
      {"BMP of OS/2", bmp_of(12, 3, 2, 24, "", padded(lower) + padded(upper))},
      {"BMP with a palette",
       bmp_of(40, 3, 2, 8, wide_palette, padded(bytes({3, 4, 5})) + padded(bytes({0, 1, 2})))},
      {"BMP of 4 bits", bmp_of(40, 3, 2, 4, wide_palette,
                               padded(bytes({0x34, 0x50})) + padded(bytes({0x01, 0x20})))},
  };
}

} // namespace

TEST_SUITE("tga_bmp") {
  TEST_CASE("TGA and BMP of each kind are decoded") {
    for (const Sample& sample : samples()) {
      CAPTURE(sample.name);
      const auto image = decode_picture(sample.file);
      REQUIRE_MESSAGE(image, image.error().message);
      REQUIRE(image->size() == Size{3, 2});
      CHECK(image->pixels() == wanted);
      CHECK(fault_of_picture(sample.file).empty());
    }
  }

  TEST_CASE("grey TGA are grey") {
    const auto image = decode_picture(tga_header(3, 2, 1, 8, from_top) + bytes({7, 200}));
    REQUIRE(image);
    CHECK(image->pixels() == std::vector<Pixel>{{7, 7, 7}, {200, 200, 200}});
  }

  TEST_CASE("a file that is cut off is refused, and one that is spoilt has its size") {
    for (const Sample& sample : samples()) {
      CAPTURE(sample.name);
      for (std::size_t at = 0; at < sample.file.size(); ++at)
        for (const int flip : {0x01, 0x55, 0x80, 0xFF}) {
          std::string spoilt = sample.file;
          spoilt[at] = static_cast<char>(spoilt[at] ^ flip);
          if (const auto image = decode_picture(spoilt)) {
            CHECK(image->size().width <= Size::most);
            CHECK(image->pixels().size() == static_cast<std::size_t>(image->size().width) *
                                                static_cast<std::size_t>(image->size().height));
          }
        }
      const auto cut = decode_picture(sample.file.substr(0, sample.file.size() / 2));
      CHECK_FALSE(cut);
    }
    const std::string pixel = tga_header(2, 3, 2, 24, from_top) + upper + lower;
    CHECK(fault_of_picture(pixel.substr(0, pixel.size() - 1)) == "is cut off; export it once more");
    CHECK(fault_of_picture(tga_header(2, 9000, 2, 24, 0) + upper) ==
          "has more than 8192 pixels along a side; make it smaller");
    // A few bytes promise a quarter of a gigabyte of pixels.
    CHECK_FALSE(decode_picture(tga_header(10, 8192, 8192, 24, 0) + bytes({0xFF, 0, 0, 0})));
    CHECK(fault_of_picture(bmp_of(40, 3, 2, 8, "", "xxxxxxxxx", 1))
              .starts_with("is a BMP with run lengths"));
  }

  TEST_CASE("a palette that is short is black beyond its end, on each machine") {
    const std::string palette = bytes({0, 0, 255, 0});
    const auto image = decode_picture(bmp_of(40, 2, 1, 8, palette, padded(bytes({0, 200}))));
    REQUIRE(image);
    CHECK(image->pixels() == std::vector<Pixel>{{255, 0, 0}, {0, 0, 0}});
  }

  TEST_CASE("what is not decoded is named by what it is") {
    using namespace std::string_literals;
    const auto fault = [](const std::string& file) { return fault_of_picture(file); };
    CHECK(fault("RIFF\x10\0\0\0WEBPVP8 "s) ==
          "is a WebP picture, which is not read; save it as PNG or JPEG");
    CHECK(fault("\xABKTX 20\xBB\r\n\x1A\n"s).starts_with("is a KTX2 texture"));
    CHECK(fault("DDS |\0\0\0"s).starts_with("is a DDS texture"));
    CHECK(fault("II*\0\x08\0\0\0"s).starts_with("is a TIFF picture"));
    CHECK(fault("MM\0*\0\0\0\x08"s).starts_with("is a TIFF picture"));
    CHECK(fault("8BPS\0\x01"s).starts_with("is a Photoshop picture"));
    CHECK(fault("v/1\x01\x02\0\0\0"s).starts_with("is an OpenEXR picture"));
    CHECK(fault("version https://git-lfs.github.com/spec/v1\n")
              .starts_with("is a pointer of Git LFS"));
    CHECK(fault("<!DOCTYPE html><html>").starts_with("is an HTML page"));
    CHECK(fault("some text") == "is no picture; PNG, JPEG, TGA and BMP are read");
    CHECK(fault("").starts_with("is no picture"));
    CHECK(fault("\x89PNG\r\n\x1A\nrest") == "is a damaged PNG picture; export it once more");
    CHECK(fault("\xFF\xD8\xFF rest") == "is a damaged JPEG picture; export it once more");
  }

  TEST_CASE("a large picture that is cut off, or too large, is found") {
    Image image({1400, 1400});
    std::uint32_t random = 1;
    for (int y = 0; y < 1400; ++y)
      for (int x = 0; x < 1400; ++x)
        for (std::uint8_t& channel : image.at(x, y))
          channel = static_cast<std::uint8_t>((random = random * 1664525 + 1013904223) >> 24);
    const auto png = png_of(image);
    REQUIRE(png);
    REQUIRE(png->size() > std::size_t{4} << 20);
    CHECK(fault_of_picture(*png) == "");
    CHECK(fault_of_picture(png->substr(0, png->size() - 500)) ==
          "is a damaged PNG picture; export it once more");
    std::string wide = *png;
    wide[18] = '\x40'; // 16,384 and more
    CHECK(fault_of_picture(wide) != "");
  }

  TEST_CASE("browsers and glTF get a PNG of the same pixels") {
    for (const Sample& sample : samples()) {
      CAPTURE(sample.name);
      const auto contents = std::make_shared<const std::string>(sample.file);
      const auto png = as_png_or_jpeg(contents);
      REQUIRE(png);
      CHECK(picture_kind_of(*png) == PictureKind::png);
      const auto image = decode_picture(*png);
      REQUIRE(image);
      CHECK(image->pixels() == wanted);
      CHECK(as_png_or_jpeg(png) == png); // and a PNG stays what it is
    }
    CHECK_FALSE(as_png_or_jpeg(nullptr));
    CHECK_FALSE(as_png_or_jpeg(std::make_shared<const std::string>("some text")));
  }
}

} // namespace nendo::render
