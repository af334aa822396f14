// Hostile segments: whatever is in the memory, and however the writer changes it meanwhile, the
// reader stays in it. The memory ends at a page that cannot be read.

#include <cstring>
#include <random>
#include <vector>

#include <doctest/doctest.h>
#include <sys/mman.h>

#include "openxr/segment_bytes.hpp"
#include "openxr/segment_view.hpp"

namespace openxr_segment_view_test {

using namespace nendo::openxr;
using namespace nendo::test;

namespace {

/// Bytes whose end is the end of readable memory.
class GuardedBytes {
public:
  explicit GuardedBytes(std::size_t bytes) : bytes_((bytes + 7) / 8 * 8) {
    const std::size_t pages = (bytes_ + page - 1) / page * page;
    void* const all =
        ::mmap(nullptr, pages + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    REQUIRE(all != MAP_FAILED);
    all_ = static_cast<char*>(all);
    mapped_ = pages + page;
    REQUIRE(::mprotect(all_ + pages, page, PROT_NONE) == 0);
    begin_ = all_ + pages - bytes_;
  }
  ~GuardedBytes() { ::munmap(all_, mapped_); }
  GuardedBytes(const GuardedBytes&) = delete;
  GuardedBytes& operator=(const GuardedBytes&) = delete;
  char* begin() const { return begin_; }
  std::size_t size() const { return bytes_; }

private:
  static constexpr std::size_t page = 4096;
  std::size_t bytes_;
  std::size_t mapped_ = 0;
  char* all_ = nullptr;
  char* begin_ = nullptr;
};

constexpr std::int64_t now_ns = 50'000'000'000;

void fill(SegmentBytes& segment) {
  for (int tick = 12; tick >= 0; --tick)
    segment.write({sample_hand(-0.1F), sample_hand()}, now_ns - tick * 11'111'111);
}

/// Reads both hands. Returns whether all read numbers are those of hands.
bool is_sane(const SegmentView& view, std::int64_t now) {
  for (std::size_t side = 0; side < 2; ++side) {
    PublishedHand hand;
    if (!view.read(side, now, hand)) continue;
    for (std::size_t k = 0; k < joint_count; ++k)
      if (!hand.newest[k].position.allFinite() ||
          std::abs(hand.newest[k].orientation.norm() - 1.0) > 1e-6 || !(hand.radii_m[k] > 0.0F) ||
          (hand.has_earlier && !hand.earlier[k].position.allFinite()))
        return false;
    if (hand.has_earlier && hand.earlier_ns >= hand.newest_ns) return false;
  }
  return true;
}

} // namespace

TEST_SUITE("segment_view") {
  TEST_CASE("a good segment is read to its last byte, and a shorter one refused") {
    const GuardedBytes bytes(SegmentBytes::all_bytes);
    SegmentBytes segment(bytes.begin());
    fill(segment);
    PublishedHand hand;
    const SegmentView view(bytes.begin(), bytes.size());
    REQUIRE(view.is_usable());
    CHECK(view.read(1, now_ns, hand));
    CHECK(hand.has_earlier);
    CHECK(hand.newest[0].position.x() == doctest::Approx(0.1));
    for (const std::size_t length : {std::size_t{0}, std::size_t{8}, std::size_t{191},
                                     std::size_t{192}, bytes.size() / 2, bytes.size() - 8}) {
      const GuardedBytes cut(length);
      std::memcpy(cut.begin(), bytes.begin(), length);
      CHECK_FALSE(SegmentView(cut.begin(), length).is_usable());
    }
  }

  TEST_CASE("a late writer has no hands, by its rate but at least half a second") {
    const GuardedBytes bytes(SegmentBytes::all_bytes);
    SegmentBytes segment(bytes.begin());
    fill(segment);
    const SegmentView view(bytes.begin(), bytes.size());
    PublishedHand hand;
    CHECK(view.read(1, now_ns + 500'000'000, hand));
    CHECK_FALSE(view.read(1, now_ns + 600'000'000, hand));
    segment.put(SegmentBytes::setup_at + 48, 1.0); // Hz
    CHECK(view.read(1, now_ns + 3'400'000'000, hand));
    CHECK_FALSE(view.read(1, now_ns + 3'600'000'000, hand));
    CHECK_FALSE(view.read(1, std::numeric_limits<std::int64_t>::max(), hand));
    CHECK_FALSE(view.read(1, std::numeric_limits<std::int64_t>::min(), hand));
  }

  TEST_CASE("a writer before 1.2 has neither radii nor states") {
    const GuardedBytes bytes(SegmentBytes::all_bytes);
    SegmentBytes segment(bytes.begin());
    segment.put(14, std::uint16_t{1});
    segment.put(44, std::uint32_t{0});
    segment.put(120, std::uint64_t{0});
    segment.put(SegmentBytes::setup_at + 68, std::uint32_t{0});
    fill(segment);
    const SegmentView view(bytes.begin(), bytes.size());
    PublishedHand hand;
    REQUIRE(view.read(0, now_ns, hand));
    for (const float radius_m : hand.radii_m)
      CHECK(radius_m == 0.01F);
  }

  TEST_CASE("wrong offsets and numbers, before and after the header is checked, are harmless") {
    std::mt19937_64 random(11);
    int usable = 0;
    for (int turn = 0; turn < 5'000; ++turn) {
      const GuardedBytes bytes(SegmentBytes::all_bytes);
      SegmentBytes segment(bytes.begin());
      fill(segment);
      const auto spoil = [&](std::size_t places) {
        for (; places > 0; --places) {
          const std::size_t header_or_any = random() % 2 == 0 ? 320 : bytes.size();
          const std::size_t at = random() % (header_or_any / 8) * 8;
          std::uint64_t word = random() >> random() % 64;
          if (random() % 3 == 0) word = bytes.size() - random() % 2048 / 8 * 8;
          std::memcpy(bytes.begin() + at, &word, 8);
        }
      };
      if (turn % 2 == 0) spoil(1 + random() % 3);
      const SegmentView view(bytes.begin(), bytes.size());
      usable += view.is_usable() ? 1 : 0;
      CHECK(is_sane(view, now_ns));
      spoil(1 + random() % 8);
      std::memcpy(bytes.begin(), "NENDOPUB", 8);
      segment.set_state(1);
      CHECK(is_sane(view, now_ns));
      segment.put(136, random() % 16); // the newest
      CHECK(is_sane(view, now_ns));
    }
    CHECK(usable > 2'500);
  }
}

} // namespace openxr_segment_view_test
