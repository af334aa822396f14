// Whatever words of a good segment are replaced, before and after the header is checked, the layer
// for OpenXR stays in the memory and reads numbers of a hand. Each replaced word is two bytes of
// place and eight of content; the first byte says how many come before the check.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "laws.hpp"
#include "openxr/hand_motion.hpp"
#include "openxr/segment_bytes.hpp"
#include "openxr/segment_view.hpp"

namespace {

using namespace nendo::openxr;
using nendo::test::SegmentBytes;

constexpr std::int64_t now_ns = 50'000'000'000;

void read(const SegmentView& view) {
  for (std::size_t side = 0; side < 2; ++side) {
    PublishedHand hand;
    if (!view.read(side, now_ns, hand)) continue;
    const MovingHand moving = at_time(hand, now_ns);
    for (std::size_t k = 0; k < joint_count; ++k) {
      require(moving.joints[k].position.allFinite());
      require(std::abs(moving.joints[k].orientation.norm() - 1.0) < 1e-6);
      require(hand.radii_m[k] > 0.0F && hand.radii_m[k] < 1.0F);
      if (moving.has_velocity)
        require(moving.linear_m_per_s[k].allFinite() && moving.angular_rad_per_s[k].allFinite());
    }
  }
}

} // namespace

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  // Of the heap, where the address sanitizer sees each byte before and after it.
  std::vector<std::uint64_t> words(SegmentBytes::all_bytes / 8);
  auto* const bytes = reinterpret_cast<char*>(words.data());
  SegmentBytes segment(bytes);
  for (int tick = 10; tick >= 0; --tick)
    segment.write({nendo::test::sample_hand(-0.1F), nendo::test::sample_hand()},
                  now_ns - tick * 11'111'111);
  std::size_t at = 1;
  const auto replace = [&](std::size_t count) {
    for (; count > 0 && at + 10 <= size; --count, at += 10) {
      const std::size_t word = (data[at] + std::size_t{256} * data[at + 1]) % words.size();
      std::memcpy(bytes + word * 8, data + at + 2, 8);
    }
  };
  replace(data[0] % 8);
  const SegmentView view(bytes, SegmentBytes::all_bytes);
  read(view);
  replace(size);
  read(view);
  return 0;
}
