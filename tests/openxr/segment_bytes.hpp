#pragma once
// The bytes of a segment, by the offsets of FORMAT.md, with hands that a test chooses. It does not
// use nendo_publish.h, which the layer reads with.

#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>

namespace nendo::test {

inline std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

/// Position in metres, and orientation x y z w.
using WrittenJoint = std::array<float, 7>;

struct WrittenHand {
  bool is_present = true;
  bool is_silent = false;
  bool is_lost = false;
  std::array<WrittenJoint, 26> joints{};
};

/// A hand whose joints are all at different places and turned differently.
inline WrittenHand sample_hand(float x = 0.1F) {
  WrittenHand hand;
  for (std::size_t k = 0; k < 26; ++k) {
    const auto n = static_cast<float>(k);
    const float half = 0.02F * n;
    hand.joints[k] = {
        x + 0.003F * n, 0.05F - 0.002F * n, -0.01F * n, half * 0.6F, -half * 0.8F, 0.0F, 1.0F};
    float norm = 0.0F;
    for (std::size_t c = 3; c < 7; ++c)
      norm += hand.joints[k][c] * hand.joints[k][c];
    for (std::size_t c = 3; c < 7; ++c)
      hand.joints[k][c] /= std::sqrt(norm);
  }
  return hand;
}

/// The radius of a joint that the writer publishes.
inline float sample_radius(std::size_t side, std::size_t joint) {
  return 0.005F + 0.001F * static_cast<float>(joint) + 0.0005F * static_cast<float>(side);
}

/// The bytes of a segment without vertices and triangles, with eight slots.
class SegmentBytes {
public:
  static constexpr std::size_t slots = 8;
  static constexpr std::size_t setup_at = 192, radii_at = 320, records_at = 576;
  static constexpr std::size_t record_bytes = 1664, states_bytes = 576, shape_bytes = 64;
  static constexpr std::size_t shapes_at = records_at + slots * record_bytes;
  static constexpr std::size_t states_at = shapes_at + slots * shape_bytes;
  static constexpr std::size_t all_bytes = states_at + slots * states_bytes;

  explicit SegmentBytes(char* to, double rate_hz = 90.0) : to_(to), rate_hz_(rate_hz) {
    std::memcpy(to_, "NENDOPUB", 8);
    put(8, std::uint32_t{0x01020304});
    put(12, std::uint16_t{1});
    put(14, std::uint16_t{2});
    put(16, std::uint64_t{all_bytes});
    put(36, static_cast<std::uint32_t>(slots));
    put(40, static_cast<std::uint32_t>(slots));
    put(44, static_cast<std::uint32_t>(states_bytes));
    put(48, std::uint64_t{setup_at});
    put(56, std::uint64_t{records_at}); // triangles and rest shape are empty
    put(64, std::uint64_t{records_at});
    put(72, std::uint64_t{records_at});
    put(80, std::uint64_t{record_bytes});
    put(88, std::uint64_t{shapes_at});
    put(96, std::uint64_t{shape_bytes});
    put(120, std::uint64_t{states_at});
    set_generation(1);
    set_state(1);
  }

  template <class T>
  void put(std::size_t at, const T& value) {
    std::memcpy(to_ + at, &value, sizeof value);
  }
  void set_state(std::uint32_t state) { put(128, state); }
  void set_generation(std::uint64_t generation) {
    stage(setup_at, 2 * generation + 1);
    put(setup_at + 8, generation);
    put(setup_at + 48, rate_hz_);
    put(setup_at + 68, static_cast<std::uint32_t>(radii_at));
    for (std::size_t side = 0; side < 2; ++side)
      for (std::size_t k = 0; k < 26; ++k)
        put(radii_at + (26 * side + k) * 4, sample_radius(side, k));
    stage(setup_at, 2 * generation + 2);
    generation_ = generation;
  }
  /// Writes the next record, of a tick that woke at `woke_ns`.
  void write(const std::array<WrittenHand, 2>& hands, std::int64_t woke_ns) {
    const std::uint64_t number = ++number_;
    const std::size_t record = records_at + number % slots * record_bytes;
    const std::size_t states = states_at + number % slots * states_bytes;
    stage(record, 2 * number + 1);
    stage(states, 2 * number + 1);
    put(record + 8, number);
    put(record + 16, generation_);
    put(record + 72, woke_ns);
    put(states + 8, number);
    for (std::size_t side = 0; side < 2; ++side) {
      const WrittenHand& hand = hands[side];
      const std::size_t at = record + 128 + side * 744;
      put(at, std::uint32_t{hand.is_present ? 1U : 0U} | (hand.is_silent ? 2U : 0U));
      put(at + 16, hand.joints);
      put(states + 32 + side * 264, std::uint32_t{4U} | (hand.is_lost ? 8U : 0U));
    }
    stage(states, 2 * number + 2);
    stage(record, 2 * number + 2);
    put(144, woke_ns);
    stage(136, number);
  }
  std::uint64_t number() const { return number_; }

private:
  /// A word by which a reader judges others: in order.
  void stage(std::size_t at, std::uint64_t value) {
    std::atomic_thread_fence(std::memory_order_seq_cst);
    __atomic_store_n(reinterpret_cast<std::uint64_t*>(to_ + at), value, __ATOMIC_SEQ_CST);
    std::atomic_thread_fence(std::memory_order_seq_cst);
  }

  char* to_;
  double rate_hz_;
  std::uint64_t number_ = 0;
  std::uint64_t generation_ = 1;
};

} // namespace nendo::test
