#include <random>

#include <doctest/doctest.h>

#include <nendo/base/files.hpp>

#include "render/image.hpp"
#include "render/lettering.hpp"
#include "support/temporary_folder.hpp"

namespace image_test {

using namespace nendo;
using namespace nendo::render;

namespace {

bool is_inked(const Image& image, int x, int y) {
  return image.at(x, y) != Pixel{255, 255, 255};
}

} // namespace

TEST_SUITE("image") {
  TEST_CASE("a picture comes back from its file as it was") {
    const test::TemporaryFolder folder;
    std::mt19937 random(4);
    for (const Size size : {Size{1, 1}, Size{17, 3}, Size{64, 48}}) {
      Image image(size);
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          for (auto& channel : image.at(x, y))
            channel = static_cast<std::uint8_t>(random());
      const auto path = folder.path() / "p.png";
      REQUIRE(write_png(path, image));
      const auto back = read_png(path);
      REQUIRE(back);
      CHECK(*back == image);
    }
  }

  TEST_CASE("what is no picture is an error that names the file") {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "p.png";
    REQUIRE(write_png(path, Image({40, 30})));
    const auto whole = *read_file(path, 1 << 20, "picture");
    for (const std::string& text : {std::string(), std::string("not a picture"),
                                    whole.substr(0, 20), whole.substr(0, whole.size() / 2)}) {
      REQUIRE(replace_file(path, text));
      const auto read = read_png(path);
      REQUIRE_FALSE(read);
      CHECK(read.error().code == Errc::bad_input);
      CHECK(read.error().message.find("p.png") != std::string::npos);
    }
    CHECK_FALSE(write_png(folder.path() / "no" / "p.png", Image({4, 4})));
  }

  TEST_CASE("sizes are two numbers within limits") {
    CHECK(size_named("640x480") == Size{640, 480});
    for (const char* bad :
         {"", "x", "640", "640x", "x480", "640x480x2", "8x480", "640x99999", "-640x480"})
      CHECK_FALSE(size_named(bad));
  }

  TEST_CASE("pasting beyond an edge keeps what has a place") {
    Image image({4, 4});
    image.paste(Image({3, 3}, {1, 2, 3}), 2, -1);
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x)
        CHECK((image.at(x, y) == Pixel{1, 2, 3}) == (x >= 2 && y < 2));
  }

  TEST_CASE("words are as wide as they say, are on their line, and stay in the picture") {
    const std::string words = "Before, After: 12.5 s (%) gjpqy";
    const double width = width_of_words(words, 20.0);
    Image image({static_cast<int>(width) + 40, 60});
    write_words(image, 20.0, 40.0, 20.0, words, {0, 0, 0});
    int left = image.size().width;
    int right = 0;
    int top = 60;
    int bottom = 0;
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < image.size().width; ++x) {
        if (!is_inked(image, x, y)) continue;
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
    CHECK(left == doctest::Approx(20.0).epsilon(0.2));
    CHECK(right == doctest::Approx(20.0 + width).epsilon(0.02));
    CHECK(top == doctest::Approx(20.0).epsilon(0.2));    // capitals
    CHECK(bottom == doctest::Approx(46.5).epsilon(0.1)); // tails
    write_words(image, -50.0, 5.0, 40.0, "beyond every edge, with \xc3\xa9 and \x01", {9, 9, 9});
    write_words(image, 1e6, 1e6, 40.0, "far", {9, 9, 9});
  }

  TEST_CASE("letters and digits all differ") {
    const std::string all = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789";
    std::vector<Image> drawn;
    for (const char letter : all) {
      Image image({40, 60});
      write_words(image, 8.0, 40.0, 30.0, std::string(1, letter), {0, 0, 0});
      CHECK_FALSE(image == Image({40, 60}));
      for (std::size_t other = 0; other < drawn.size(); ++other) {
        const bool same = (letter == 'l' && all[other] == 'I'); // both a stroke
        CAPTURE(letter);
        CAPTURE(all[other]);
        CHECK((drawn[other] == image) == same);
      }
      drawn.push_back(std::move(image));
    }
  }
}

} // namespace image_test
