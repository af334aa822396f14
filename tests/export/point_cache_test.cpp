#include "export/shape_files.hpp"

#include <cstring>

#include <doctest/doctest.h>

#include "support/recorded_motion.hpp"

namespace point_cache_test {

using namespace nendo;
using namespace nendo::exporting;
using nendo::test::Motion;
using nendo::test::RecordedMotion;

namespace {

/// Numbers of 32 bits out of a file, in either byte order.
struct Words {
  std::string bytes;
  bool big_endian = false;

  std::uint32_t word(std::size_t at) const {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t place = at + (big_endian ? k : 3 - k);
      value = value << 8U | static_cast<unsigned char>(bytes.at(place));
    }
    return value;
  }
  double number(std::size_t at) const {
    const std::uint32_t bits = word(at);
    float value = 0.0F;
    std::memcpy(&value, &bits, 4);
    return static_cast<double>(value);
  }
};

OpenFrames frames_of(const RecordedMotion& motion) {
  return [&motion]() -> Result<std::unique_ptr<takes::FrameSource>> { return motion.frames(); };
}

Exported export_it(const RecordedMotion& motion, PointCache format, const Choice& choice) {
  auto done = export_point_caches(frames_of(motion), choice, format, motion.path("cache"));
  REQUIRE(done);
  return *done;
}

void check_points(const RecordedMotion& motion, const Words& words, std::size_t begin,
                  std::size_t first, std::size_t step, std::size_t count) {
  const auto points = static_cast<std::size_t>(motion.shapes[0].cols());
  REQUIRE(words.bytes.size() == begin + 12 * points * count);
  double worst = 0.0;
  for (std::size_t frame = 0; frame < count; ++frame)
    for (std::size_t at = 0; at < 3 * points; ++at) {
      const double wanted =
          motion.shapes[first + step * frame].reshaped()[static_cast<Eigen::Index>(at)];
      worst =
          std::max(worst, std::abs(words.number(begin + 4 * (3 * points * frame + at)) - wanted));
    }
  CHECK(worst < 1e-7);
}

} // namespace

TEST_SUITE("point_cache") {
  TEST_CASE("a PC2 file has its head and every vertex of every frame, little-endian") {
    const RecordedMotion motion(Motion{.ticks = 31});
    const auto done = export_it(motion, PointCache::pc2, {.rate_hz = 50.0});
    CHECK(done.frames == 16);
    const Words words{test::file_bytes(motion.path("cache"))};
    CHECK(done.bytes == words.bytes.size());
    CHECK(words.bytes.substr(0, 12) == std::string("POINTCACHE2\0", 12));
    CHECK(words.word(12) == 1);
    CHECK(words.word(16) == static_cast<std::uint32_t>(motion.shapes[0].cols()));
    CHECK(words.number(20) == 0.0);
    CHECK(words.number(24) == 1.0);
    CHECK(words.word(28) == 16);
    check_points(motion, words, 32, 0, 2, 16);
  }

  TEST_CASE("an MDD file has its head with a time a frame, big-endian") {
    const RecordedMotion motion(Motion{.ticks = 20});
    export_it(motion, PointCache::mdd, {.from_s = 0.055, .to_s = 0.1, .rate_hz = 100.0});
    const Words words{test::file_bytes(motion.path("cache")), true};
    REQUIRE(words.word(0) == 5);
    CHECK(words.word(4) == static_cast<std::uint32_t>(motion.shapes[0].cols()));
    for (std::size_t frame = 0; frame < 5; ++frame)
      CHECK(words.number(8 + 4 * frame) == doctest::Approx(0.01 * static_cast<double>(frame)));
    check_points(motion, words, 8 + 4 * 5, 5, 1, 5);
  }

  TEST_CASE("where the model becomes finer another file begins, and the report says when") {
    const RecordedMotion motion(Motion{.subdivide_at_tick = 24});
    for (const PointCache format : {PointCache::pc2, PointCache::mdd}) {
      const bool is_mdd = format == PointCache::mdd;
      const auto done = export_it(motion, format, {.rate_hz = 100.0});
      REQUIRE(done.files == std::vector<std::string>{motion.path("cache"), motion.path("cache-2")});
      CHECK(done.frames == 60);
      REQUIRE(done.begin_s.size() == 2);
      CHECK(done.begin_s[1] == doctest::Approx(0.26));
      std::size_t first = 0;
      for (const auto& [file, frames] : {std::pair{done.files[0], 25}, {done.files[1], 35}}) {
        const Words words{test::file_bytes(file), is_mdd};
        CHECK(words.word(is_mdd ? 0 : 28) == static_cast<std::uint32_t>(frames));
        const auto points = static_cast<std::size_t>(motion.shapes[first].cols());
        CHECK(words.word(is_mdd ? 4 : 16) == points);
        const std::size_t head = is_mdd ? 8 + 4 * static_cast<std::size_t>(frames) : 32;
        REQUIRE(words.bytes.size() == head + 12 * points * static_cast<std::size_t>(frames));
        double worst = 0.0;
        for (std::size_t frame = 0; frame < static_cast<std::size_t>(frames); ++frame, ++first)
          for (std::size_t at = 0; at < 3 * points; ++at)
            worst = std::max(
                worst, std::abs(words.number(head + 4 * (3 * points * frame + at)) -
                                motion.shapes[first].reshaped()[static_cast<Eigen::Index>(at)]));
        CHECK(worst < 1e-7);
      }
    }
  }

  TEST_CASE("a file that cannot be written is reported, and nothing is left there") {
    const RecordedMotion motion(Motion{.ticks = 3});
    const auto done = export_point_caches(frames_of(motion), {.rate_hz = 100.0}, PointCache::pc2,
                                          "/proc/missing/a.pc2");
    REQUIRE_FALSE(done);
    CHECK(done.error().code == Errc::failed);
    const auto device =
        export_point_caches(frames_of(motion), {.rate_hz = 100.0}, PointCache::pc2, "/dev/full");
    REQUIRE_FALSE(device);
    CHECK(device.error().message.find("regular file") != std::string::npos);
  }
}

} // namespace point_cache_test
